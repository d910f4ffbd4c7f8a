from dataclasses import replace

import numpy as np
import pytest
from tests_fea_helpers import finger_result

from fea import calibration
from fea.calibration import search_thickness
from fea.density import DENSITIES
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


def test_search_finds_the_thickness_and_steps_back_from_lost_equilibrium():
    asked = []

    def error(thickness: float) -> float | None:
        asked.append(thickness)
        return None if thickness < 3.0e-3 else 6.0 - 2.0e3 * (thickness - 0.3e-3) - 2e5 * (thickness - 3e-3) ** 2

    found = search_thickness(error, 2.5e-3)
    assert abs(error(found)) < 0.1
    assert asked[0] == 2.5e-3
    assert len(asked) <= 8
    assert found == round(found, 5)


def test_search_that_finds_nothing_lists_what_it_tried():
    with pytest.raises(ValueError, match=r"flexure_thickness_m: no value .* 3\.00 mm \(\+40\.0 degrees\)"):
        search_thickness(lambda _: 40.0, 3e-3)
    with pytest.raises(ValueError, match=r"2\.00 mm \(equilibrium lost before\)"):
        search_thickness(lambda _: None, 2e-3)


def test_flexure_is_chosen_on_the_complete_finger_and_the_actuator_runs_once(monkeypatch, geometry, materials):
    calls = []

    def finger(model, candidate, pressures, *, progress):  # noqa: ARG001 - the analysis' signature
        calls.append(pressures)
        angle = np.deg2rad(95.0 - 2e4 * (candidate.flexure_thickness_m - 3.5e-3)) / 3.0
        pressure = np.array([0.0, *pressures])
        return finger_result(pressure, np.outer(pressure > 0.0, np.full(3, angle)), np.ones_like(pressure))

    monkeypatch.setattr(calibration, "run_actuator", lambda *_: calls.append("actuator") or ("i", 0.007))
    monkeypatch.setattr(calibration, "_finger_model", lambda *_: None)
    monkeypatch.setattr(calibration, "analyse_finger", finger)
    monkeypatch.setattr(calibration, "complete", lambda *given: given)
    chosen, *_, actuator, mass, _ = calibration.choose_flexure(geometry, materials, DENSITIES["coarse"])
    assert chosen == replace(geometry, flexure_thickness_m=3.5e-3)
    assert (actuator, mass) == ("i", 0.007)
    assert calls[0] == "actuator"
    assert set(map(tuple, calls[1:])) == {(75e3,)}
