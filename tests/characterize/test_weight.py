"""The finger's weight: what the finite elements and the simulated finger make of it, and what the reader refuses."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

from assets import asset_path
from softhand_sim.calibration import load_weight_evidence
from softhand_sim.characterize.weight import weight


@pytest.fixture(scope="module")
def evidence():
    return load_weight_evidence()


@pytest.fixture(scope="module")
def report(calibration, evidence):
    return weight(calibration, weighed=evidence)


def test_weight_helps_a_straight_finger_that_looks_down_and_opens_a_bent_one(report):
    """In the finite elements and in the engine: palm down the tip falls towards the plumb line, from either side."""
    for row in report.figures["attitudes"]:
        sign = 1.0 if row["name"] == "palm down" else -1.0
        for change in (sign * np.array(row["change_deg"]), sign * np.array(row["fea_change_deg"])):
            assert change[0] > 0.0 > change[-1]
            assert (np.diff(change) < 0.0).all()


def test_attitudes_are_those_of_the_long_fingers(report):
    for row in report.figures["hand_tip_angle_deg_at_75_kpa"].values():
        assert set(row["tip_angle_deg"]) == {"index", "middle", "ring", "little"}


def test_a_finger_of_half_its_mass_fails(calibration, evidence):
    light = replace(calibration, finger=replace(calibration.finger, mass_kg=0.5 * calibration.finger.mass_kg))
    assert not weight(light, weighed=evidence).holds


def test_mass_and_its_centre_are_those_of_the_finite_elements(calibration):
    """Phalanges as uniform rods against the mesh's masses and centres, from joint to joint (kg, m)."""
    finger = calibration.finger
    ends = [*finger.joint_position_m, finger.length_m]
    meshed = ((4.208e-3, 15.27e-3), (3.299e-3, 11.90e-3), (4.259e-3, 15.20e-3))
    for start, end, (mass, centre) in zip(ends[:-1], ends[1:], meshed, strict=True):
        rod = finger.mass_kg * (end - start) / finger.length_m
        assert rod == pytest.approx(mass, rel=0.04)
        assert 0.5 * (end - start) == pytest.approx(centre, rel=0.04)


def test_evidence_of_another_finger_is_refused(calibration, evidence):
    other = replace(calibration, geometry=dict(calibration.geometry) | {"tube_wall_m": 0.0021})
    with pytest.raises(ValueError, match=r"geometry\.tube_wall_m = 0\.0021"):
        weight(other, weighed=evidence)


@pytest.mark.parametrize(
    ("place", "value", "named"),
    [
        (("schema",), "softhand-sim/finger-evidence", "schema = "),
        (("attitudes",), [], r"attitudes = \[\]"),
        (("attitudes", 0, "gravity_m_per_s2"), [0.0, 0.0], r"attitudes\[0\]\.gravity_m_per_s2"),
        (("attitudes", 1, "pressure_pa_gauge", 2), 0.0, r"attitudes\[1\]\.pressure_pa_gauge = .*rising"),
        (("attitudes", 1, "joint_angle_rad"), [[0.0, 0.0, 0.0]], r"joint_angle_rad has shape"),
    ],
)
def test_a_bad_field_is_refused_by_name(tmp_path, place, value, named):
    data = json.loads(asset_path("calibration", "finger_weight_evidence.json").read_text(encoding="utf-8"))
    data = copy.deepcopy(data)
    parent = data
    for key in place[:-1]:
        parent = parent[key]
    parent[place[-1]] = value
    file = tmp_path / "bad.json"
    file.write_text(json.dumps(data))
    with pytest.raises(ValueError, match=named):
        load_weight_evidence(file)
