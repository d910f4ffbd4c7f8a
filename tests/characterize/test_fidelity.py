"""The simulated finger against finite elements and against what the paper states, as `characterize.py all` has it."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from assets import asset_path
from softhand_sim.calibration import load_calibration, load_evidence
from softhand_sim.characterize import STUDIES, Bench, pressure_angle
from softhand_sim.characterize.hysteresis import loop_area
from softhand_sim.characterize.pictures import draw
from softhand_sim.characterize.pressure_sweep import PRESSURES_PA_GAUGE, pressure_angle_report
from softhand_sim.elements import FINGERS

CALIBRATIONS = sorted(p for p in asset_path("calibration").glob("*.json") if "evidence" not in p.name)
MEMBERS = sorted(p for p in asset_path("calibration", "ensemble").rglob("*.json") if p.name != "ensemble.json")


@pytest.fixture(scope="module", params=CALIBRATIONS, ids=lambda path: path.stem)
def shipped(request):
    return load_calibration(request.param)


@pytest.fixture(scope="module")
def evidence():
    return load_evidence()


@pytest.fixture(scope="module")
def reports(calibration, evidence):
    return {name: study(calibration, evidence) for name, study in STUDIES.items()}


@pytest.mark.parametrize("name", list(STUDIES))
def test_every_check_of_the_shipped_finger_holds(reports, name):
    assert reports[name].checks
    failed = [str(check) for check in reports[name].checks if not check.holds]
    assert not failed


def test_every_shipped_calibration_has_its_angles_in_every_finger(shipped):
    """At each pressure, each joint of each finger; and the paper's 95 degrees at 75 kPa."""
    rest = pressure_angle(shipped, PRESSURES_PA_GAUGE)
    curve = shipped.curve
    for joint in range(3):
        own = np.interp(rest.pressure_pa_gauge, curve.pressure_pa_gauge, curve.joint_angle_deg[:, joint])
        assert np.abs(rest.joint_angle_deg[:, :, joint] - own[:, None]).max() < 0.1
    assert (np.diff(rest.tip_angle_deg, axis=0) > 1.0).all()
    stated = pressure_angle(shipped, [75e3]).tip_angle_deg[0]
    assert stated == pytest.approx(np.full(len(FINGERS), 95.0), abs=1.5)


@pytest.mark.parametrize("path", MEMBERS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_every_finger_of_the_ensemble_has_its_angles(path):
    """Against its own finite elements, all fingers; 95 degrees are the nominal finger's alone."""
    member = load_calibration(path)
    reached = member.curve.pressure_pa_gauge[-1]
    report = pressure_angle_report(member, pressures_pa_gauge=[0.5 * reached, reached], stated=False)
    assert len(report.checks) == 4
    assert not [str(check) for check in report.checks if not check.holds]
    assert report.figures["tip_angle_spread_between_fingers_deg"] < 0.1


def test_unseen_pressures_are_those_that_are_reported(reports, calibration):
    seen = {
        p for p, used in zip(calibration.analysis.pressure_pa_gauge, calibration.analysis.fitted, strict=True) if used
    }
    reported = reports["pressure-angle"].figures["unseen_pressure_pa_gauge"]
    assert len(reported) == 8
    assert 75e3 in reported
    assert not seen & set(reported)


def test_weight_bends_the_finger_the_way_it_pulls(reports):
    """Palm down the weight opens a bent finger, palm up it closes it; the hand on its side is between the two."""
    angles = reports["pressure-angle"].figures["tip_angle_deg_at_75_kpa_with_gravity"]
    level = np.mean([angles[name] for name in angles if "side" in name], axis=0)
    assert (np.array(angles["palm down"]) < level - 1.0).all()
    assert (np.array(angles["palm up"]) > level + 1.0).all()
    assert level == pytest.approx(angles["no gravity"], abs=0.3)


def test_a_wrong_finger_fails_its_checks(calibration, evidence):
    """Joints a tenth too stiff must not pass as the finite elements' finger."""
    stiff = replace(
        calibration,
        joints=tuple(replace(j, stiffness_n_m_per_rad=1.1 * j.stiffness_n_m_per_rad) for j in calibration.joints),
    )
    failed = {check.name for check in pressure_angle_report(stiff).checks if not check.holds}
    assert {"tip angle, RMS", "tip angle, largest error"} <= failed
    loose = replace(calibration, sliding=replace(calibration.sliding, coefficient_per_rad=0.01))
    assert not STUDIES["hysteresis"](loose, evidence).holds


def test_evidence_of_another_finger_is_refused(calibration, evidence):
    other = replace(calibration, geometry=dict(calibration.geometry) | {"tube_wall_m": 0.0021})
    for name in ("tip-force", "tip-load", "hysteresis"):
        with pytest.raises(ValueError, match=r"geometry\.tube_wall_m = 0\.0021"):
            STUDIES[name](other, evidence)
    made = calibration.notes["provenance"]
    materials = copy.deepcopy(made["materials"])
    materials["NinjaFlex TPU"] |= {"set": "set2", "parameters": {}}
    for change, named in (
        ({"density": "coarse"}, "provenance.density = 'coarse'"),
        ({"materials": materials}, "'set2'"),
    ):
        other = replace(calibration, notes={**calibration.notes, "provenance": {**made, **change}})
        with pytest.raises(ValueError, match=named):
            evidence.require_same_finger(other)


def test_wall_pushes_back_with_what_the_finger_pushes(calibration):
    """Virtual work: a wall a little further away takes from the gas what it takes in force."""
    pressure, distance, h = 60e3, 30e-3, 0.5e-3
    free = replace(calibration, sliding=replace(calibration.sliding, coefficient_per_rad=0.0))

    def at(d):
        return Bench(free, wall_distance_m=d).go_to(pressure)

    near, here, far = at(distance - h), at(distance), at(distance + h)
    joints, tendon = calibration.joints, calibration.tendon

    def potential(reading):
        q, d = reading.joint_angle_rad, reading.elongation_m
        springs = sum(
            x**2 * (k / 2 + x * (m / 3 + x * n / 4))
            for x, (k, m, n) in zip(q, [joint.polynomial for joint in joints], strict=True)
        )
        a, b, c = tendon.polynomial
        wall = d**2 * (a / 2 + d * (b / 3 + d * c / 4))
        return springs + wall - pressure * calibration.chamber.volume_m3_at(d)

    force = -(potential(far) - potential(near)) / (2 * h)
    assert here.wall_force_n == pytest.approx(force, rel=0.01)


def test_pressures_that_are_not_calibrated_are_refused(calibration):
    for pressure in (80_001.0, -1.0):
        with pytest.raises(ValueError, match=f"pressure_pa_gauge = {pressure}"):
            Bench(calibration).go_to(pressure)


def test_area_of_a_known_loop():
    pressure = np.array([0.0, 1.0, 2.0, 1.0, 0.0])
    assert loop_area(pressure, np.array([0.0, 1.0, 2.0, 2.0, 0.0])) == pytest.approx(1.0)
    assert loop_area(pressure, np.array([0.0, 1.0, 2.0, 1.0, 0.0])) == 0.0


def test_pictures_say_whose_each_curve_is(reports, tmp_path):
    for name, report in reports.items():
        if report.panels:
            draw(report, tmp_path / f"{name}.png")
            assert (tmp_path / f"{name}.png").stat().st_size > 10_000
