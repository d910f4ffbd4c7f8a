"""Identification from made-up analyses, of which every law is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from tests_fea_helpers import finger_like

from fea.actuator import ActuatorResult
from fea.exoskeleton import ExoskeletonResult
from fea.identification import (
    FINGER_STATES,
    GAP_BULGING,
    LEAST_SLOPE_PER_RAD,
    States,
    finger_lengthening,
    fit_arm,
    fit_monotone,
    fitted_rows,
    reduce_finger,
)
from fea.newton import Status
from fea.surrogate import Arm, Chamber, Cubic, Sliding, Surrogate

CHAMBER = Chamber(volume_m3=2.45e-6, area_m2=5.6e-5, area_slope_m=4e-4, bulging_m3_per_pa=5e-12)
TENDON = Cubic(a=245.0, b=-3700.0, c=5e4)
FLEXURE = Cubic(a=0.019, b=-0.002, c=1e-4)
# the actuator's share softens; the first joint's is held by the clamp
SHARES = (Cubic(a=0.014, b=-0.012, c=0.0040), Cubic(a=0.012, b=-0.009, c=0.0024), Cubic(a=0.012, b=-0.008, c=0.0020))
KNOWN = Surrogate(
    arm=Arm(offset_m=5.6e-3, offset_slope_m_per_rad=3.8e-3),
    joints=tuple(FLEXURE + share for share in SHARES),  # type: ignore[arg-type]
    tendon=TENDON,
    chamber=CHAMBER,
    # so stiff that the slip has turned at the first state of the way back
    sliding=Sliding(coefficient_per_rad=0.015, stiffness_n_per_m=5e3),
)
PRESSURES = [2e3, 5e3, 10e3, 20e3, 30e3, 40e3, 50e3, 60e3, 70e3, 80e3]


def bulging(lengthening_m: float) -> float:
    """Volume per pressure between the rings of the actuator alone."""
    return 4.2e-12 + 7.5e-11 * lengthening_m


def bulging_in_finger(lengthening_m: float) -> float:
    return GAP_BULGING * bulging(lengthening_m)


@pytest.fixture(scope="module")
def actuator() -> ActuatorResult:
    """The free actuator: thrust and tendon in balance."""
    pressure = np.linspace(0.0, 45e3, 10)
    d = np.array([brentq(lambda x, p=p: p * CHAMBER.area(x) - TENDON(x), -1e-9, 0.03) for p in pressure])
    volume = np.array([CHAMBER.volume(x, 0.0) + p * bulging(x) for x, p in zip(d, pressure, strict=True)])
    return ActuatorResult(
        pressure_pa_gauge=pressure,
        elongation=d / 87e-3,
        lengthening_m=d,
        volume_m3=volume,
        radial_growth_m=np.zeros_like(d),
        max_stretch=np.ones_like(d),
        thrust_area_m2=np.array([CHAMBER.area(x) for x in d]),
        status=Status.CONVERGED,
        iterations=0,
        dofs=1,
        elements=1,
    )


@pytest.fixture(scope="module")
def exoskeleton() -> ExoskeletonResult:
    angle = np.linspace(0.1, 0.8, 6)[:, None] * np.array([1.0, 0.5, 0.1])
    return ExoskeletonResult(
        load_n=np.linspace(0.0, 0.5, 6),
        tip_deflection_m=np.linspace(0.0, 0.08, 6),
        angle_rad=angle,
        moment_n_m=np.vectorize(FLEXURE)(angle),
        lengthening_m=5.8e-3 * angle,
        status=Status.CONVERGED,
        iterations=0,
        dofs=1,
        elements=1,
    )


@pytest.fixture(scope="module")
def finger():
    return finger_like(KNOWN, PRESSURES, bulging_in_finger)


def test_known_surrogate_is_recovered_from_three_analyses(actuator, exoskeleton, finger):
    fit = reduce_finger(actuator, exoskeleton, finger)
    found = fit.surrogate
    assert found.arm.offset_m == pytest.approx(KNOWN.arm.offset_m, rel=1e-5)
    assert found.arm.offset_slope_m_per_rad == pytest.approx(KNOWN.arm.offset_slope_m_per_rad, rel=1e-4)
    assert found.sliding.coefficient_per_rad == pytest.approx(KNOWN.sliding.coefficient_per_rad, rel=2e-3)
    assert fit.flexure.offset_m == pytest.approx(5.8e-3)
    assert found.chamber.area_m2 == pytest.approx(CHAMBER.area_m2)
    for law, known in zip((*found.joints, found.tendon), (*KNOWN.joints, TENDON), strict=True):
        assert (law.a, law.b, law.c) == pytest.approx((known.a, known.b, known.c), rel=1e-3)
    assert fit.rmse["finger_joint_angle_rad_max"] < 1e-5
    # what bulges between the rings grows a little with the lengthening; the law keeps the mean over analysis (i)
    one = found.chamber.bulging_m3_per_pa
    pressure, delta = actuator.pressure_pa_gauge[1:], actuator.lengthening_m[1:]
    assert one == pytest.approx(GAP_BULGING * np.average([bulging(d) for d in delta], weights=pressure**2), rel=1e-6)
    unseen = PRESSURES[-2::-2]
    missing = [p * (bulging_in_finger(found.lengthening_m(found.angles(p))) - one) for p in unseen]
    assert fit.rmse["finger_volume_m3"] == pytest.approx(float(np.sqrt(np.mean(np.square(missing)))), rel=1e-3)


def test_lengthening_is_told_from_bulging_by_the_volume(actuator, finger):
    up = np.arange(1, len(PRESSURES) + 1)
    states = States(
        pressure_pa_gauge=finger.pressure_pa_gauge[up],
        joint_angle_rad=finger.joint_angle_rad[up],
        volume_m3=finger.volume_m3[up],
        unloaded_volume_m3=finger.volume_m3[0],
    )
    expected = [KNOWN.lengthening_m(q) for q in states.joint_angle_rad]
    np.testing.assert_allclose(finger_lengthening(actuator, CHAMBER, states), expected, rtol=1e-9)


def test_unseen_states_do_not_move_the_fit(actuator, exoskeleton, finger):
    """The errors are over states that the fit cannot have learnt: spoiled, they leave every law as it was."""
    seen = fitted_rows(finger)
    assert seen[len(PRESSURES)]
    spoiled = np.where(seen[:, None], finger.joint_angle_rad, 1.05 * finger.joint_angle_rad)
    before = reduce_finger(actuator, exoskeleton, finger)
    after = reduce_finger(actuator, exoskeleton, replace(finger, joint_angle_rad=spoiled))
    assert after.surrogate == before.surrogate
    assert after.rmse["finger_tip_angle_rad_max"] > 0.03 > before.rmse["finger_tip_angle_rad_max"]


def test_without_a_way_back_there_is_no_friction(actuator, exoskeleton):
    free = replace(KNOWN, sliding=Sliding(coefficient_per_rad=0.0, stiffness_n_per_m=0.0))
    found = reduce_finger(actuator, exoskeleton, finger_like(free, PRESSURES, bulging_in_finger)).surrogate
    assert found.sliding == free.sliding
    np.testing.assert_allclose(found.angles(75e3), free.angles(75e3), atol=1e-5)


def test_points_of_the_arm_s_line_stay_apart():
    """An arm that does not grow, as no line through two such points has it: the nearest that the engine can have."""
    angle = np.linspace(0.05, 0.6, 8)[:, None] * np.ones(3)
    arm = fit_arm(angle, 6e-3 * angle.sum(axis=1))
    assert arm.offset_slope_m_per_rad == pytest.approx(LEAST_SLOPE_PER_RAD * arm.offset_m)
    h = 1e-6
    for q in (0.0, 0.4, 1.3):
        slope = (arm.lengthening_m(np.array(q + h)) - arm.lengthening_m(np.array(q - h))) / (2 * h)
        assert float(arm(np.array(q))) == pytest.approx(float(slope), rel=1e-8)


def test_torque_never_falls_and_beyond_the_data_the_flexure_remains(actuator, exoskeleton, finger):
    """A finger that gives way at the end: its last angles ask for a torque that falls."""
    angle = finger.joint_angle_rad.copy()
    top = len(PRESSURES)
    angle[top - 2 : top + 1] += np.array([0.05, 0.15, 0.3])[:, None]
    lost = replace(finger, joint_angle_rad=angle, tip_angle_rad=angle.sum(axis=1))
    fit = reduce_finger(actuator, exoskeleton, lost)
    assert fit.rmse["finger_joint_angle_rad_max"] > 0.01
    for law in fit.surrogate.joints:
        for q in np.linspace(-0.35, 1.4, 36):
            assert law.slope(q) >= fit.flexure.law.slope(q) - 1e-9


def test_fit_recovers_a_monotone_cubic_and_never_leaves_the_monotone_ones():
    x = np.linspace(0.1, 1.0, 12)
    law = Cubic(a=2.0, b=-1.5, c=0.5)
    fitted = fit_monotone(x, np.array([law(v) for v in x]))
    assert [fitted.a, fitted.b, fitted.c] == pytest.approx([2.0, -1.5, 0.5], rel=1e-4)
    hump = fit_monotone(x, np.sin(3.0 * x))
    assert min(hump.slope(v) for v in np.linspace(-2.0, 2.0, 401)) > -1e-9
    with pytest.raises(ValueError, match="b\\^2 <= 3 a c"):
        Cubic(a=1.0, b=2.0, c=1.0)


def test_analyses_that_ended_early_are_refused_by_name(actuator, exoskeleton, finger):
    short = finger_like(KNOWN, PRESSURES[: FINGER_STATES - 1], bulging_in_finger)
    with pytest.raises(ValueError, match=r"finger\.pressure_pa_gauge: 7 usable .* at least 8"):
        reduce_finger(actuator, exoskeleton, short)
    with pytest.raises(ValueError, match=r"exoskeleton\.load_n: 2 usable"):
        reduce_finger(actuator, replace(exoskeleton, load_n=exoskeleton.load_n[:2]), finger)
    fields = ("pressure_pa_gauge", "lengthening_m", "volume_m3", "thrust_area_m2")
    few = replace(actuator, **{k: getattr(actuator, k)[:4] for k in fields})
    with pytest.raises(ValueError, match=r"actuator\.pressure_pa_gauge: 3 usable"):
        reduce_finger(few, exoskeleton, finger)
    # enough states, but the finger stretches the actuator further than they do
    near = replace(actuator, **{k: getattr(actuator, k)[:7] for k in fields})
    with pytest.raises(ValueError, match=r"actuator\.lengthening_m ends at .* needs higher pressures"):
        reduce_finger(near, exoskeleton, finger)


def test_volume_that_cannot_be_a_finger_s_is_refused_by_name(actuator, exoskeleton, finger):
    flat = replace(finger, volume_m3=np.full_like(finger.volume_m3, finger.volume_m3[0]))
    with pytest.raises(ValueError, match=r"finger\.volume_m3\[1\] = 2\.45e-06 at 2000 Pa"):
        reduce_finger(actuator, exoskeleton, flat)
