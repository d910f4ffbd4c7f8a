import pytest

from scripts.calibrate import main


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--materials", "set9", "set3"], "sets has no 'set9'"),
        (["--flexure", "1.0"], "flexure_thickness_m = 0.001 m must be at least 0.002"),
        (["--flexure", "3300"], "flexure_thickness_m = 3.3 m must lie in"),
    ],
)
def test_bad_input_is_one_line_and_a_status(capsys, tmp_path, arguments, message):
    out = tmp_path / "finger.json"
    assert main([*arguments, "--out", str(out)]) != 0
    error = capsys.readouterr().err.strip()
    assert message in error
    assert len(error.splitlines()) == 1
    assert not out.exists()
