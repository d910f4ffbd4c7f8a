"""``scripts/uncertainty.py`` with a stand-in for the analyses: solve, put together, bands, grasps, refusals."""

import json

import numpy as np
import pytest
from PIL import Image

from assets import asset_path
from fea.actuator import ActuatorResult
from fea.checkpoint import content_hash
from fea.exoskeleton import ExoskeletonResult
from fea.geometry import FingerGeometry
from fea.newton import Status
from fea.store import Solved
from scripts import _ensemble
from scripts.uncertainty import main

SHIPPED = json.loads((asset_path("calibration") / "finger.json").read_text())


class StandIn:
    """The shipped finger, its joints stiffer with the tube's wall; silicone of the tensile test is refused."""

    def __init__(self):
        self.solved = []

    def __call__(self, design, density, *, choose=False, progress=lambda: None):  # noqa: ARG002 - the signature
        self.solved.append((design.materials.silicone.parameter_set, design.geometry.tube_wall_m))
        if design.materials.silicone.parameter_set == "tensile":
            raise ValueError("finger.pressure_pa_gauge: 5 usable converged states: a calibration needs at least 8")
        made = json.loads(json.dumps({k: v for k, v in SHIPPED.items() if k != "content_sha256"}))
        factor = 1.1 if density.name == "coarse" else 1.0
        factor *= design.geometry.tube_wall_m / FingerGeometry().tube_wall_m
        made["geometry"] = design.geometry.as_dict()
        made["provenance"] |= {"density": density.name, "mesh": density.name}
        for joint in made["joints"]:
            for name in ("stiffness_n_m_per_rad", "stiffness_n_m_per_rad2", "stiffness_n_m_per_rad3"):
                joint[name] *= factor
        return Solved(artifact=made | {"content_sha256": content_hash(made)}, report={})


@pytest.fixture
def stand_in():
    return StandIn()


@pytest.fixture
def ensemble(tmp_path, stand_in):
    out = tmp_path / "ensemble"
    assert main(["solve", "--out", str(out), "--store", str(tmp_path / "store")], stand_in) == 0
    return out


def test_an_ensemble_is_solved_once_and_refusals_are_kept(ensemble, stand_in, tmp_path, capsys):
    manifest = json.loads((ensemble / "ensemble.json").read_text())
    assert manifest["nominal_sha256"] == SHIPPED["content_sha256"]
    kinds = {source["name"]: source["kind"] for source in manifest["sources"]}
    assert kinds == {
        **dict.fromkeys(("tube_wall", "flexure_wall", "actuator_wall", "mesh"), "tolerance"),
        **dict.fromkeys(("silicone_data", "material_pair"), "scenarios"),
    }
    # nominal, five walls, two of silicone, eight pairs
    assert len(stand_in.solved) == 16
    again = ["solve", "--out", str(ensemble), "--store", str(tmp_path / "store"), "--json", str(tmp_path / "m.json")]
    assert main(again, stand_in) == 0
    assert len(stand_in.solved) == 16
    assert json.loads((tmp_path / "m.json").read_text()) == manifest
    told = capsys.readouterr().out
    assert "silicone_data: silicone-tensile has no calibration: finger.pressure_pa_gauge: 5 usable" in told
    assert "tube_wall: tube-wall-minus has no calibration; its side mirrors the other one: tube_wall_m = 0.0019" in told
    # the member is carried over from the coarse mesh: 5 % thicker, 5 % stiffer than the shipped finger
    thick = json.loads((ensemble / "tube-wall-plus.json").read_text())
    for joint, nominal in zip(thick["joints"], SHIPPED["joints"], strict=True):
        ratio = joint["stiffness_n_m_per_rad"] / nominal["stiffness_n_m_per_rad"]
        assert ratio == pytest.approx(1.05, rel=0.01)


def as_result(kind, table, names):
    values = {name: np.array(table[key]) for name, key in names.items()}
    return kind(**values, status=Status.CONVERGED, iterations=0, dofs=table["dofs"], elements=table["elements"])


def test_analysis_three_may_come_from_a_table_of_runs(tmp_path, stand_in, monkeypatch):
    table, actuator, shell = (SHIPPED["fea"][part] for part in ("finger", "actuator", "exoskeleton"))
    up = {"pressure_pa_gauge": "pressure_pa_gauge", "elongation": "elongation_ratio", "lengthening_m": "lengthening_m"}
    up |= {"volume_m3": "chamber_volume_m3", "radial_growth_m": "radial_growth_m"}
    up |= {"max_stretch": "max_principal_stretch", "thrust_area_m2": "thrust_area_m2"}
    down = {"load_n": "load_n", "tip_deflection_m": "tip_deflection_m", "angle_rad": "joint_angle_rad"}
    down |= {"moment_n_m": "joint_moment_n_m", "lengthening_m": "axis_lengthening_m"}
    monkeypatch.setattr(_ensemble, "run_actuator", lambda *_: (as_result(ActuatorResult, actuator, up), 7e-3))
    monkeypatch.setattr(_ensemble, "run_exoskeleton", lambda *_: (as_result(ExoskeletonResult, shell, down), 6e-3))
    case = {"geometry": FingerGeometry().as_dict(), "mesh": "calibration", "formulation": "P2", "volumetric": None}
    case |= {"mesh_cells": SHIPPED["provenance"]["mesh"]["finger"], "unload": True, "friction": 0.3}
    run = {
        "case": case | {"silicone_set": "set2", "tpu_set": "set3"},
        "status": "converged",
        "pressure_pa_gauge": table["pressure_pa_gauge"],
        "joint_rotation_rad": table["joint_angle_rad"],
        "volume_m3": table["chamber_volume_m3"],
        "contact_force_n": table["contact_force_n"],
        "tip_displacement_m": [0.0] * len(table["branch"]),
        "newton_iterations": 1,
        "dofs": 1,
        "code_sha256": "",
    }
    (tmp_path / "runs.json").write_text(json.dumps({"runs": [run]}))
    argv = ["solve", "--only", "nominal-coarse,pair-set2-set3,pair-set2-set2", "--density", "calibration"]
    argv += ["--runs", str(tmp_path / "runs.json"), "--out", str(tmp_path / "out"), "--store", str(tmp_path / "store")]
    assert main(argv, stand_in) == 0
    # nominal and the pair that the table lacks
    assert [silicone for silicone, _ in stand_in.solved] == ["set3", "set2"]
    made = json.loads((tmp_path / "out" / "solved" / "pair-set2-set3.json").read_text())
    assert made["provenance"]["finger_run"]["pressure_pa_gauge"] == table["pressure_pa_gauge"]
    # all states were there, so it is the shipped finger again
    assert made["curve"]["tip_angle_deg"] == pytest.approx(SHIPPED["curve"]["tip_angle_deg"], abs=1e-3)
    assert made["finger"]["mass_kg"] == pytest.approx(13e-3)


def test_bands_of_the_shipped_ensemble_follow_physics(tmp_path, capsys):
    figures, picture = tmp_path / "bands.json", tmp_path / "bands.png"
    assert main(["bands", "--pressures", "30,75", "--json", str(figures), "--picture", str(picture)]) == 0
    data = json.loads(figures.read_text())
    members, bands = data["members"], data["bands"]
    nominal = members["nominal"]
    walls = [name for name in members if "-wall-" in name]
    assert {"tube-wall-plus", "actuator-wall-minus"} <= set(walls)
    for name in walls:
        # a thicker wall bends less
        change = members[name]["tip_angle_deg_at_75_kpa"] - nominal["tip_angle_deg_at_75_kpa"]
        assert change < 0.0 if name.endswith("plus") else change > 0.0
    stiffness = [f"{joint}_stiffness_n_m_per_rad" for joint in ("proximal", "middle", "distal")]
    assert all(members["tube-wall-plus"][name] > nominal[name] for name in stiffness)
    for own in bands.values():
        for band in own.values():
            assert band["low"] <= band["nominal"] <= band["high"]
    angle = {name: own["tip_angle_deg_at_75_kpa"] for name, own in bands.items()}
    # analysis (iii) of the stiffest pair: 28.0 degrees; the mesh: 95.28 against 95.52
    assert angle["material_pair"]["low"] == pytest.approx(28.0, abs=0.5)
    assert angle["mesh"]["high"] - angle["mesh"]["low"] == pytest.approx(2 * 0.24, abs=0.1)
    widths = {name: band["high"] - band["low"] for name, band in angle.items()}
    singles = [width for name, width in widths.items() if name == "mesh" or name.endswith("_wall")]
    assert max(singles) * 0.9 < widths["tolerances"] < sum(singles)
    assert "| material_pair | " in capsys.readouterr().out
    assert (np.asarray(Image.open(picture).convert("L")) < 128).mean() > 0.005


def test_no_spread_is_the_nominal_finger(tmp_path):
    figures = tmp_path / "bands.json"
    assert main(["bands", "--pressures", "75", "--spread", "0", "--json", str(figures)]) == 0
    bands = json.loads(figures.read_text())["bands"]
    for name in ("tube_wall", "mesh", "tolerances"):
        assert all(band["low"] == band["high"] == band["nominal"] for band in bands[name].values())


def test_grasps_from_the_ensemble_to_an_interval(ensemble, tmp_path, capsys):
    figures, picture = tmp_path / "grasps.json", tmp_path / "grasps.png"
    argv = ["grasps", "--ensemble", str(ensemble), "--objects", "golf_ball", "--trials", "1", "--fingers", "2"]
    argv += ["--scenarios", "silicone_data", "--out", str(tmp_path / "out"), "--json", str(figures)]
    assert main([*argv, "--picture", str(picture)]) == 0
    data = json.loads(figures.read_text())
    own = data["objects"]["golf_ball"]
    assert own["tolerances"]["trials"] == 2
    assert own["tolerances"]["low"] <= own["tolerances"]["success_rate"] <= own["tolerances"]["high"]
    assert sum(own["tolerances"]["variance_shares"].values()) == pytest.approx(1.0)
    assert list(own["scenarios"]["silicone_data"]["without_trials"]) == ["silicone-tensile"]
    assert [row["kind"] for row in data["fingers"]] == ["nominal", "drawn", "drawn", "scenario", "scenario"]
    table = capsys.readouterr().out
    assert "| golf_ball | fingers within tolerance |" in table
    assert "silicone-tensile: no trials: finger.pressure_pa_gauge: 5 usable" in table
    assert (np.asarray(Image.open(picture).convert("L")) < 128).mean() > 0.005


@pytest.mark.parametrize(
    ("argv", "told"),
    [
        (["solve", "--only", "roof"], "--only roof: no such member; known: nominal-coarse, tube-wall-minus"),
        (["solve", "--runs", "none.json"], "--runs none.json: no such file"),
        (["assemble"], "nominal-coarse.json: not there; solve it first"),
        (["bands", "--pressures", "75,30"], "--pressures 75,30: must increase"),
        (["bands", "--spread", "3"], "--spread = 3.0: must be a number in [0, 2]"),
        (["grasps", "--objects", "ghost"], "--objects: 'ghost' is not in the catalogue"),
        (["grasps", "--scenarios", "weather"], "--scenarios: 'weather' is not one of"),
        (["grasps", "--ensemble", "/nowhere"], "/nowhere/ensemble.json: no such calibration file"),
        (["dream"], "invalid choice: 'dream'"),
    ],
)
def test_bad_input_is_one_line(argv, told, tmp_path, capsys, stand_in):
    try:
        status = main([*argv, "--out", str(tmp_path / "out"), "--store", str(tmp_path / "store")], stand_in)
    except SystemExit as stop:
        status = stop.code
    assert status == 2
    assert told in capsys.readouterr().err
    assert stand_in.solved == []
