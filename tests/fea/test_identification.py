"""Identification from made-up analyses, of which every law is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve
from tests_fea_helpers import finger_like, finger_result

from fea.actuator import ActuatorResult
from fea.exoskeleton import ExoskeletonResult
from fea.identification import FINGER_STATES, finger_lengthening, fit_monotone, reduce_finger
from fea.newton import Status
from fea.surrogate import Chamber, Cubic, Surrogate

CHAMBER = Chamber(volume_m3=2.45e-6, area_m2=5.6e-5, area_slope_m=4e-4, bulging_m3_per_pa=5e-12)
TENDON = Cubic(a=245.0, b=-3700.0, c=5e4)
FLEXURE = Cubic(a=0.019, b=-0.002, c=1e-4)
# the actuator's share softens; the first joint's is held by the clamp
SHARES = (Cubic(a=0.014, b=-0.012, c=0.0040), Cubic(a=0.012, b=-0.009, c=0.0024), Cubic(a=0.012, b=-0.008, c=0.0020))
KNOWN = Surrogate(
    offset_m=(6.3e-3, 6.3e-3, 6.3e-3),
    joints=tuple(FLEXURE + share for share in SHARES),  # type: ignore[arg-type]
    tendon=TENDON,
    chamber=CHAMBER,
)
PRESSURES = [2e3, 5e3, 10e3, 20e3, 30e3, 40e3, 50e3, 60e3, 70e3, 80e3]


def bulging(lengthening_m: float) -> float:
    """Volume per pressure between the rings, as large as analysis (i) has it."""
    return 4.2e-12 + 7.5e-11 * lengthening_m


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
    return finger_like(KNOWN, PRESSURES, bulging)


def test_known_surrogate_is_recovered_from_three_analyses(actuator, exoskeleton, finger):
    fit = reduce_finger(actuator, exoskeleton, finger)
    found = fit.surrogate
    assert found.offset_m == pytest.approx(KNOWN.offset_m, rel=1e-6)
    assert fit.flexure.offset_m == pytest.approx(5.8e-3)
    assert found.chamber.area_m2 == pytest.approx(CHAMBER.area_m2)
    for law, known in zip((*found.joints, found.tendon), (*KNOWN.joints, TENDON), strict=True):
        assert (law.a, law.b, law.c) == pytest.approx((known.a, known.b, known.c), rel=1e-3)
    assert fit.rmse["finger_joint_angle_rad_max"] < 1e-5
    # what bulges between the rings grows a little with the lengthening; the law keeps the mean over analysis (i)
    one = found.chamber.bulging_m3_per_pa
    pressure, delta = actuator.pressure_pa_gauge[1:], actuator.lengthening_m[1:]
    assert one == pytest.approx(np.average([bulging(d) for d in delta], weights=pressure**2), rel=1e-6)
    missing = [p * (bulging(found.lengthening_m(found.angles(p))) - one) for p in PRESSURES]
    assert fit.rmse["finger_volume_m3"] == pytest.approx(float(np.sqrt(np.mean(np.square(missing)))), rel=1e-3)


def test_lengthening_is_told_from_bulging_by_the_volume(actuator, finger):
    expected = [KNOWN.lengthening_m(q) for q in finger.joint_angle_rad[1:]]
    np.testing.assert_allclose(finger_lengthening(actuator, CHAMBER, finger), expected, rtol=1e-9)


def test_torque_laws_absorb_an_arm_that_grows_with_the_angle(actuator, exoskeleton):
    """The actuator lifts: dr = 11 % at 0.6 rad, as the complete finger has it. One constant arm, the same angles."""
    r, growth = 5.95e-3, 0.36
    pressure = np.array([0.0, *PRESSURES])
    angle, volume = np.zeros((len(pressure), 3)), np.full(len(pressure), CHAMBER.volume_m3)

    def lengthening(q: np.ndarray) -> float:
        return float((r * (q + 0.5 * growth * q**2)).sum())

    def imbalance(q: np.ndarray, p: float) -> np.ndarray:
        thrust = KNOWN.thrust_n(p, lengthening(q))
        return np.array([r * (1 + growth * a) * thrust - law(a) for a, law in zip(q, KNOWN.joints, strict=True)])

    for k, p in enumerate(PRESSURES, start=1):
        angle[k] = fsolve(imbalance, KNOWN.angles(p), args=(p,))
        d = lengthening(angle[k])
        volume[k] = CHAMBER.volume(d, 0.0) + p * bulging(d)
    fit = reduce_finger(actuator, exoskeleton, finger_result(pressure, angle, volume))
    assert r < fit.surrogate.offset_m[0] < r * (1 + growth * angle.max())
    assert fit.rmse["finger_lengthening_m"] > 1e-5
    for p, q in zip(pressure[2:], angle[2:], strict=True):
        np.testing.assert_allclose(fit.surrogate.angles(p), q, atol=np.deg2rad(0.5))
        assert fit.surrogate.tip_angle_deg(p) == pytest.approx(np.rad2deg(q.sum()), rel=0.01, abs=0.5)


def test_torque_never_falls_and_beyond_the_data_the_flexure_remains(actuator, exoskeleton, finger):
    """A finger that gives way at the end: its last angles ask for a torque that falls."""
    angle = finger.joint_angle_rad.copy()
    angle[-3:] += np.array([0.05, 0.15, 0.3])[:, None]
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
    short = finger_like(KNOWN, PRESSURES[: FINGER_STATES - 1], bulging)
    with pytest.raises(ValueError, match=r"finger\.pressure_pa_gauge: 5 usable .* at least 6"):
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
