import json

import pytest

from scripts import finger_limit


def test_short_inflation_has_no_limit_point(tmp_path, capsys):
    file = tmp_path / "limit.json"
    few = ["--dimension", "ring_count=4", "--mesh", "coarse", "--friction", "0"]
    assert finger_limit.main([*few, "--to", "1.02", "--steps", "2", "--json", str(file)]) == 0
    found = json.loads(file.read_text(encoding="utf-8"))
    assert found["status"] == "converged"
    assert found["limit_pressure_pa_gauge"] is None
    volume, pressure, slope = (found[k] for k in ("volume_m3", "pressure_pa_gauge", "slope_pa_per_m3"))
    assert volume[1] / volume[0] == pytest.approx(1.02 / 1.01)
    assert 0.0 < pressure[0] < pressure[1]
    assert (pressure[1] - pressure[0]) / (volume[1] - volume[0]) == pytest.approx(0.5 * sum(slope), rel=0.2)
    assert "no limit point; converged" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--to", "0.9"], "--to 0.9: must be above 1"),
        (["--materials", "set9", "set3"], "set9"),
        (["--friction", "3"], "friction = 3.0 must be from 0 to 2"),
        (["--dimension", "tube_wall_m=0.001"], "tube_wall_m"),
    ],
)
def test_bad_input_is_refused_in_one_line(argv, message, capsys):
    assert finger_limit.main(argv) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.count("\n") == 1
