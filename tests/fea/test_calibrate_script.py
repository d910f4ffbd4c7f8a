from dataclasses import replace

import numpy as np
import pytest
from tests_fea_helpers import finger_result

from fea import calibration
from fea.calibration import search_sector
from fea.density import DENSITIES
from scripts.calibrate import main


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--materials", "set9", "set3"], "sets has no 'set9'"),
        (["--dimension", "flexure_thickness_m=0.001"], "flexure_thickness_m = 0.001 m must be at least 0.002"),
        (["--dimension", "flexure_thickness_m=3.3"], "flexure_thickness_m = 3.3 m must lie in"),
    ],
)
def test_bad_input_is_one_line_and_a_status(capsys, tmp_path, arguments, message):
    out = tmp_path / "finger.json"
    assert main([*arguments, "--out", str(out)]) != 0
    error = capsys.readouterr().err.strip()
    assert message in error
    assert len(error.splitlines()) == 1
    assert not out.exists()


def test_search_finds_the_sector_and_steps_back_from_lost_equilibrium():
    asked = []

    def error(sector: float) -> float | None:
        asked.append(sector)
        return None if sector < 60.0 else 12.0 - 2.0 * (sector - 58.0) + 0.02 * (sector - 60.0) ** 2

    found = search_sector(error, 57.0)
    assert abs(error(found)) < 0.1
    assert asked[0] == 57.0
    assert len(asked) <= 8
    assert found == round(found, 1)


def test_search_that_finds_nothing_lists_what_it_tried():
    with pytest.raises(ValueError, match=r"sector_half_angle_rad: no half angle .* 60\.0 \(\+40\.0 degrees\)"):
        search_sector(lambda _: 40.0, 60.0)
    with pytest.raises(ValueError, match=r"50\.0 \(equilibrium lost before\)"):
        search_sector(lambda _: None, 50.0)


def test_sector_is_chosen_on_the_complete_finger_and_the_actuator_runs_once(monkeypatch, geometry, materials):
    calls = []

    def finger(model, candidate, path, *, progress):  # noqa: ARG001 - the analysis' signature
        pressures = list(path.pressures_pa_gauge)
        calls.append(pressures)
        angle = np.deg2rad(95.0 - 2.4 * (np.rad2deg(candidate.sector_half_angle_rad) - 66.0)) / 3.0
        pressure = np.array([0.0, *pressures])
        return finger_result(pressure, np.outer(pressure > 0.0, np.full(3, angle)), np.ones_like(pressure))

    monkeypatch.setattr(calibration, "run_actuator", lambda *_: calls.append("actuator") or ("i", 0.007))
    monkeypatch.setattr(calibration, "_finger_model", lambda *_: None)
    monkeypatch.setattr(calibration, "analyse_finger", finger)
    monkeypatch.setattr(calibration, "complete", lambda *given: given)
    chosen, *_, actuator, mass, _ = calibration.choose_sector(geometry, materials, DENSITIES["coarse"])
    assert np.rad2deg(chosen.sector_half_angle_rad) == pytest.approx(66.0)
    assert replace(chosen, sector_half_angle_rad=geometry.sector_half_angle_rad) == geometry
    assert (actuator, mass) == ("i", 0.007)
    assert calls[0] == "actuator"
    assert set(map(tuple, calls[1:])) == {(75e3,)}
