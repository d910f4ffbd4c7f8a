import json
from dataclasses import replace

import numpy as np
import pytest
from tests_fea_helpers import finger_result

from assets import asset_path
from fea import calibration
from fea.calibration import search_sector
from fea.density import DENSITIES
from fea.geometry import FingerGeometry
from fea.store import Solved
from scripts.calibrate import main
from softhand_sim.calibration import load_calibration
from softhand_sim.hand.export import hand_xml, scene_xml


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


class StandIn:
    """In place of the analyses: the shipped calibration with the asked thickness as its geometry, and a count."""

    def __init__(self):
        self.seen = []

    def __call__(self, design, density, *, choose=False, progress=lambda: None):
        self.seen.append((design, density.name, choose))
        progress()
        shipped = json.loads((asset_path("calibration") / "finger.json").read_text())
        shipped.pop("content_sha256", None)
        report = {
            "tip_angle_deg_at_75_kpa": 95.0,
            "sector_half_angle_rad": design.geometry.sector_half_angle_rad,
            "finger_status": "converged",
            "finger_pressure_pa_gauge": [0.0, 80e3],
        }
        return Solved(artifact=shipped | {"geometry": design.geometry.as_dict()}, report=report)


@pytest.fixture
def calibrate(tmp_path):
    stand_in = StandIn()

    def run(*arguments):
        return main([*arguments, "--store", str(tmp_path / "store")], stand_in)

    run.seen = stand_in.seen
    return run


def test_a_finger_s_file_goes_to_calibration_and_hand(calibrate, tmp_path, capsys):
    (tmp_path / "mine.toml").write_text('[geometry]\ntube_wall_m = 2.5e-3\n[materials]\ntpu = "ninjaflex/set2"\n')
    out, hand, figures = tmp_path / "out" / "finger.json", tmp_path / "hand", tmp_path / "figures.json"
    asked = ["--finger", str(tmp_path / "mine.toml"), "--density", "coarse", "--out", str(out), "--hand", str(hand)]
    assert calibrate(*asked, "--json", str(figures)) == 0
    ((design, density, choose),) = calibrate.seen
    assert design.geometry == replace(FingerGeometry(), tube_wall_m=2.5e-3)
    assert design.materials.tpu.parameter_set == "set2"
    assert (density, choose) == ("coarse", False)
    written = load_calibration(out)
    assert written.geometry["tube_wall_m"] == 2.5e-3
    assert (hand / "hand.xml").read_text() == hand_xml(written)
    assert (hand / "scene.xml").read_text() == scene_xml(written)
    assert json.loads(figures.read_text())["from_store"] is False
    assert "95.0 degrees at 75 kPa" in capsys.readouterr().out
    # the same finger again, and a changed one
    out.unlink()
    assert calibrate(*asked, "--json", str(figures)) == 0
    assert len(calibrate.seen) == 1
    assert load_calibration(out).geometry == written.geometry
    assert json.loads(figures.read_text())["from_store"] is True
    assert "from the store" in capsys.readouterr().out
    for more in (
        ["--dimension", "gap_length_m=0.0051"],
        ["--choose-sector"],
        ["--density", "calibration"],
        ["--force"],
    ):
        before = len(calibrate.seen)
        assert calibrate(*asked, *more) == 0
        assert len(calibrate.seen) == before + 1, more


def test_a_finger_that_the_runtime_refuses_replaces_no_file(tmp_path, capsys):
    def falling(design, density, **more):
        solved = StandIn()(design, density, **more)
        curve = {**solved.artifact["curve"]}
        curve["pressure_pa_gauge"] = curve["pressure_pa_gauge"][::-1]
        return Solved(artifact={**solved.artifact, "curve": curve}, report=solved.report)

    out = tmp_path / "finger.json"
    out.write_text("kept")
    assert main(["--out", str(out), "--store", str(tmp_path / "store")], falling) == 2
    assert (
        capsys.readouterr().err.splitlines()[-1].startswith("error: refused by the runtime: curve.pressure_pa_gauge[1]")
    )
    assert out.read_text() == "kept"


@pytest.mark.parametrize(
    ("toml", "more", "message"),
    [
        ("[geometry]\ntube_wall_mm = 2.0", [], "geometry.tube_wall_mm: unknown field (did you mean tube_wall_m?)"),
        ("[geometry]\ntube_wall_m = 2.0", [], "tube_wall_m = 2 m must lie in (0, 0.3) m"),
        ("", ["--materials", "set2", "set3"], "--materials, --finger: give one of them"),
    ],
)
def test_a_finger_s_file_is_refused_before_any_analysis(calibrate, tmp_path, capsys, toml, more, message):
    (tmp_path / "mine.toml").write_text(toml)
    out = tmp_path / "finger.json"
    assert calibrate("--finger", str(tmp_path / "mine.toml"), "--out", str(out), *more) == 2
    assert message in capsys.readouterr().err
    assert calibrate.seen == []
    assert not out.exists()


def test_a_finger_of_one_s_own_does_not_replace_the_shipped_calibration(calibrate, tmp_path, capsys):
    (tmp_path / "mine.toml").write_text("")
    assert calibrate("--finger", str(tmp_path / "mine.toml")) == 2
    assert "--out: needed with --finger" in capsys.readouterr().err


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
