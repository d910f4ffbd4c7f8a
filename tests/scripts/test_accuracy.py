"""Scripts of accuracy against time: finite-element rungs that go on, tables, the choice on new scenes."""

import json

import numpy as np
import pytest

from scripts import _accuracy_finger, _accuracy_growth, _accuracy_honour, _accuracy_page, accuracy_fea, accuracy_vs_time
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import FINEST, Fidelity, load_front
from softhand_sim.fidelity.front import Front, Measured, SceneErrors


def test_a_finite_element_rung_goes_on_and_lends_its_steps_to_the_blocked_one(tmp_path, monkeypatch):
    monkeypatch.setattr(accuracy_fea, "PRESSURES_PA_GAUGE", (200.0, 400.0))
    monkeypatch.setattr(accuracy_fea, "_compile", lambda _: None)
    out, work = tmp_path / "runs.json", tmp_path / "work"
    command = ["--rungs", "coarse-P1", "--out", str(out), "--work", str(work)]
    assert accuracy_fea.main(command) == 0
    free, blocked = accuracy_fea.read_runs(out)
    # so little pressure does not bring the tip to the wall: the same states, and no force
    assert blocked["tip_position_m"] == free["tip_position_m"]
    assert blocked["tip_force_n"] == [0.0, 0.0, 0.0]
    assert blocked["processor_s"] == free["processor_s"] > 0.0
    out.unlink()
    assert accuracy_fea.main([*command, "--tests", "free"]) == 0
    assert accuracy_fea.read_runs(out) == [free]


def test_the_reference_s_error_is_that_of_the_next_mesh(calibration, tmp_path, monkeypatch):
    """Made-up runs: each rung a degree and a tenth of a newton short of the next."""
    monkeypatch.setattr(_accuracy_finger, "LINKS", ())
    runs = []
    for short, mesh in ((2.0, "coarse"), (1.0, "calibration"), (0.0, "reference")):
        run = {"mesh": mesh, "formulation": "P2", "status": "converged", "processor_s": 3.0 - short, "dofs": 1}
        run |= {"tip_angle_deg": [0.0, *(50.0 - short for _ in range(5))], "tip_position_m": [[1e-3 * short, 0.0]] * 6}
        runs += [run | {"test": "free", "tip_force_n": [0.0] * 6}]
        runs += [run | {"test": "blocked", "tip_force_n": [0.0, 0.0, 0.0, 0.0, 1.0 - 0.1 * short, 1.0 - 0.1 * short]}]
    file = tmp_path / "runs.json"
    file.write_text(json.dumps({"schema": accuracy_fea.SCHEMA, "schema_version": 1, "runs": runs}))
    table = _accuracy_finger.table(calibration, file, 1, lambda: None)
    assert table["error_bar"] == pytest.approx({"angle_deg": 1.0, "tip_m": 1e-3, "force_ratio": 0.1})
    rows = {row["name"]: row for row in table["rungs"]}
    assert rows["FEA coarse-P2"]["angle_error_deg"] == pytest.approx(2.0)
    assert rows["FEA coarse-P2"]["force_error_ratio"] == pytest.approx(0.2)
    assert rows["FEA reference-P2"]["angle_error_deg"] == pytest.approx(1.0)
    assert rows["closed form, flat strip"]["processor_s_per_sweep"] < 1e-3


def test_a_page_s_tables_are_replaced_and_nothing_else():
    page = "head\n<!-- one -->\nold\n<!-- end -->\nmiddle\n<!-- two -->\n\n<!-- end -->\n"
    found = _accuracy_page.with_tables(page, {"one": "new", "two": "more"})
    assert found == "head\n<!-- one -->\nnew\n<!-- end -->\nmiddle\n<!-- two -->\nmore\n<!-- end -->\n"
    with pytest.raises(ValueError, match="three"):
        _accuracy_page.with_tables(page, {"three": ""})


def test_the_exponent_is_that_of_the_power_law():
    row = _accuracy_growth._row("", [1, 4, 16], [2e-6 * n**1.5 for n in (1, 4, 16)], "")
    assert row["exponent"] == pytest.approx(1.5)
    assert row["exponent_standard_error"] == pytest.approx(0.0, abs=1e-9)


def test_the_choice_is_tried_on_unseen_scenes(calibration, tmp_path, monkeypatch):
    """A front that promises too much is found out: 8 ms are not within a thousandth of a degree."""
    bare = [scene for scene in _accuracy_honour.draw_scenes(12, 3) if type(scene).__name__ == "BareScene"]
    monkeypatch.setattr(_accuracy_honour, "draw_scenes", lambda count, _seed: tuple(bare[:count]))
    monkeypatch.setattr(_accuracy_honour, "ALWAYS", ("0.5 ms, noslip 10",))
    exact = Measured(name="exact", angle_error_deg=1e-12, slip_error_m=0.0, cost_ratio=9.0)
    boast = Measured(name="boast", angle_error_deg=1e-3, slip_error_m=0.0, cost_ratio=1.0)
    points = (
        Fidelity(timestep_s=FINEST.timestep_s, noslip_iterations=FINEST.noslip_iterations, measured=exact),
        Fidelity(timestep_s=8e-3, measured=boast),
    )
    errors = tuple(SceneErrors(angle_deg=np.full(59, a), slip_m=np.zeros(59)) for a in (1e-12, 1e-3))
    front = Front(points=points, errors=errors)
    tolerances = [Tolerance(angle_deg=a, slip_m=1e-3) for a in (1e-13, 1e-6, 1e-3)]
    kept = tmp_path / "unseen.json"
    refused, honest, boasting = _accuracy_honour.honour(calibration, front, tolerances, 1, 0, kept, lambda: None)
    assert "no measured setting" in refused["refused"]
    assert (honest["picked"]["name"], honest["honoured"]) == ("exact", 1)
    assert (boasting["picked"]["name"], boasting["honoured"]) == ("boast", 0)
    assert boasting["processor_s"] < honest["processor_s"]
    again = _accuracy_honour.honour(calibration, front, tolerances, 1, 0, kept, lambda: None)
    assert again == [refused, honest, boasting]
    assert "| 1e-13 degrees, 1 mm | refused |" in _accuracy_page.honour(again)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [(["scenery"], "scenery: no such part"), (["scene", "--points", "3 ms"], "--points '3 ms'")],
)
def test_unknown_parts_and_points_are_refused(arguments, says, capsys, tmp_path):
    assert accuracy_vs_time.main([*arguments, "--out", str(tmp_path)]) == 2
    assert says in capsys.readouterr().err


def test_scene_points_are_measured_against_the_finest(tmp_path, capsys):
    """One point on one scene through the command line: the file is a front that can be chosen from."""
    del capsys
    out, front = tmp_path / "out", tmp_path / "front.json"
    command = ["scene", "--points", "8 ms", "--front-scenes", "1", "--out", str(out), "--front", str(front)]
    assert accuracy_vs_time.main(command) == 0
    (point,) = json.loads(front.read_text())["points"]
    assert point["against"] == "0.25 ms, noslip 10"
    assert 0.0 < point["angle_error_median_deg"] <= point["angle_error_deg"]
    assert np.isfinite(point["cost_ratio"])
    assert point["scene_angle_error_deg"] == pytest.approx([point["angle_error_deg"]], rel=1e-5)
    with pytest.raises(ValueError, match="no measured setting is known to be within it"):
        load_front(front).for_tolerance(Tolerance(angle_deg=90.0, slip_m=1.0))
    assert (out / "accuracy-scene.png").stat().st_size > 1000
