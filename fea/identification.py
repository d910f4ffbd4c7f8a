"""Identification of the surrogate: thrust and tendon from analysis (i), the joints from the complete finger, (iii).

The arm comes from the volume of (iii), the sliding friction from its way back, and the joints' torques are those that
the thrust of (i) less the friction has at the angles of (iii): tau_j = r(theta_j) (p A - N - F). The flexure alone,
(ii), is the part of them that is known beyond the angles of (iii) as well. No loaded or blocked state is used.
"""

from dataclasses import dataclass, replace
from math import pi, sqrt, tan

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares, lsq_linear

from fea.actuator import ActuatorResult
from fea.arrays import F64
from fea.exoskeleton import ExoskeletonResult
from fea.finger import FingerResult
from fea.surrogate import Arm, Chamber, Cubic, Sliding, Surrogate

USED_LENGTHENING_M = 17e-3
"""Choice: the range the finger uses up to 80 kPa and beyond; thrust and tendon are fitted there."""
USED_ANGLE_RAD = 0.9
"""Choice: joint angles of the flexure's fit; a joint turns 0.6 rad at 80 kPa, and more where another is blocked."""
ACTUATOR_STATES, EXOSKELETON_LOADS, FINGER_STATES = 4, 3, 8
"""Choice: states that each analysis must have reached: a cubic has three unknowns, and of the finger's states the fit
sees every second one only."""
LEAST_SLOPE_PER_RAD = 0.5 * tan(0.75)
"""Choice: least slope of the arm for its length: the points of its line (:class:`fea.surrogate.Arm`) meet at an angle
of 1.5 rad then, beyond where the engine stops the joints (1.4 rad)."""
GAP_BULGING = 1.07
"""Choice: bulging of the wall in the finger, where it also bulges into the joints' gaps, for that of the actuator
alone. Volume without work: the larger it is, the smaller the arm. Of 1.05, 1.07 and 1.1 it follows the default finger
best under tip loads of 0.02 to 0.2 N at 45 kPa (within 5 %; 1 within 9 %)."""
_TYPICAL_SLIDING = np.array([0.015, 60.0])
_SOFTEST = 0.1
"""Choice: least share of the largest stiffness that weighs an error."""
EXTRAPOLATION = 1.05
"""Choice: how far the tendon's law may be used beyond the lengthening that analysis (i) reached."""


@dataclass(frozen=True, kw_only=True)
class Flexure:
    """A joint of the exoskeleton alone, (ii): torque law [N m of rad] and lengthening of the tube's axis per angle."""

    law: Cubic
    offset_m: float


@dataclass(frozen=True, kw_only=True, eq=False)
class States:
    """Loaded states of one branch of the complete finger, in the order they were reached, [n] and [n, 3]."""

    pressure_pa_gauge: F64
    joint_angle_rad: F64
    volume_m3: F64
    unloaded_volume_m3: float

    def only(self, rows: np.ndarray) -> "States":
        """Return some of the rows."""
        return States(
            pressure_pa_gauge=self.pressure_pa_gauge[rows],
            joint_angle_rad=self.joint_angle_rad[rows],
            volume_m3=self.volume_m3[rows],
            unloaded_volume_m3=self.unloaded_volume_m3,
        )


@dataclass(frozen=True, kw_only=True)
class Fit:
    """A surrogate, the flexure's share of its joints, and the errors of the fits.

    ``rmse`` holds root-mean-square errors, and the largest ones where a name ends in ``_max``. Those of the finger's
    angles and volume are over the loading states that the fit did not see.
    """

    surrogate: Surrogate
    flexure: Flexure
    rmse: dict[str, float]


def reduce_finger(actuator: ActuatorResult, exoskeleton: ExoskeletonResult, finger: FingerResult) -> Fit:
    """Fit the surrogate to the three analyses.

    Raises
    ------
    ValueError
        If an analysis ended too early to fit anything; the message names the field that is too short.
    """
    used = (actuator.lengthening_m <= USED_LENGTHENING_M) & (actuator.pressure_pa_gauge > 0.0)
    _check_states(int(used.sum()), exoskeleton, finger)
    delta, pressure = actuator.lengthening_m[used], actuator.pressure_pa_gauge[used]
    chamber = fit_chamber(actuator, used)
    force = pressure * np.array([chamber.area(d) for d in delta])
    tendon = fit_monotone(delta, force)
    flexure, rmse = fit_flexure(exoskeleton)
    rmse |= {
        "thrust_area_m2": _rms(actuator.thrust_area_m2[used] - force / pressure),
        "chamber_volume_m3": _rms(
            actuator.volume_m3[used] - np.array([chamber.volume(d, p) for d, p in zip(delta, pressure, strict=True)])
        ),
        "tendon_force_n": _rms(force - np.array([tendon(d) for d in delta])),
    }
    up = _rows(finger, "loading")
    lengthening = finger_lengthening(actuator, chamber, up)
    reached = EXTRAPOLATION * float(delta.max())
    if lengthening.max() > reached:
        raise ValueError(
            f"actuator.lengthening_m ends at {1e3 * delta.max():.3g} mm: the finger needs "
            f"{1e3 * lengthening.max():.3g} mm; analysis (i) needs higher pressures"
        )
    down = _rows(finger, "unloading")
    chamber = replace(chamber, bulging_m3_per_pa=GAP_BULGING * chamber.bulging_m3_per_pa)
    seen = fitted_states(len(up.pressure_pa_gauge))
    back = fitted_states(len(down.pressure_pa_gauge))
    arm = fit_arm(up.joint_angle_rad[seen], lengthening[seen])
    sliding, sliding_error = fit_sliding(up.only(seen), down.only(back), arm, chamber)
    bare = Surrogate(arm=arm, joints=(flexure.law,) * 3, tendon=tendon, chamber=chamber, sliding=sliding)
    surrogate = replace(bare, joints=fit_joints(up.only(seen), bare))
    rmse["finger_lengthening_m"] = _rms(lengthening - arm.lengthening_m(up.joint_angle_rad).sum(axis=1))
    rmse["finger_sliding_n"] = sliding_error
    return Fit(surrogate=surrogate, flexure=flexure, rmse=rmse | finger_errors(surrogate, up.only(~seen)))


def fitted_states(count: int) -> np.ndarray:
    """Return which states of a branch the fit may see [count]: every second one, from the last."""
    return np.asarray(np.arange(count)[::-1] % 2 == 0)


def fitted_rows(finger: FingerResult) -> np.ndarray:
    """Return which rows of analysis (iii) the fit sees [n]."""
    seen = np.zeros(len(finger.branch), dtype=bool)
    for branch in ("loading", "unloading"):
        rows = np.flatnonzero(_on_branch(finger, branch))
        seen[rows[fitted_states(len(rows))]] = True
    return seen


def fit_arm(angle_rad: F64, lengthening_m: F64) -> Arm:
    """Fit the arm that the joints have in common to the lengthening [n] at joint angles [n, 3].

    The slope is bounded from below, so that the two points of the arm's line stay apart.
    """
    half = 0.5 * angle_rad
    straight, grown = 2.0 * np.sin(half).sum(axis=1), 4.0 * (1.0 - np.cos(half)).sum(axis=1)
    # slope = LEAST_SLOPE offset + more, more >= 0
    design = np.stack([straight + LEAST_SLOPE_PER_RAD * grown, grown], axis=1)
    offset, more = lsq_linear(design, lengthening_m, bounds=(0.0, np.inf), method="bvls").x
    return Arm(offset_m=float(offset), offset_slope_m_per_rad=float(LEAST_SLOPE_PER_RAD * offset + more))


def fit_sliding(up: States, down: States, arm: Arm, chamber: Chamber) -> tuple[Sliding, float]:
    """Fit the friction to the way back; return it with the force's root-mean-square error [N].

    Where the finger stands at the same angle on both ways, everything but friction is the same, so the difference of
    the two pressures is that of the friction forces. Without a way back there is none.
    """
    if len(down.pressure_pa_gauge) == 0:
        return Sliding(coefficient_per_rad=0.0, stiffness_n_per_m=0.0), 0.0
    bend, back = up.joint_angle_rad.sum(axis=1), down.joint_angle_rad.sum(axis=1)
    same = CubicSpline(np.append(0.0, bend), np.append(0.0, up.pressure_pa_gauge))(back)
    delta = arm.lengthening_m(down.joint_angle_rad).sum(axis=1)
    turned = float(arm.lengthening_m(up.joint_angle_rad[-1]).sum()) - delta
    area = np.array([chamber.area(d) for d in delta])
    last = up.pressure_pa_gauge[-1] * chamber.area(float(delta[0] + turned[0])) * bend[-1]

    def error(x: F64) -> F64:
        coefficient, stiffness = x * _TYPICAL_SLIDING
        # of the force that friction has on the way back, as the pressures show it, and as the law has it
        shown = area * (down.pressure_pa_gauge - same * (1.0 - coefficient * back))
        least = -coefficient * back * down.pressure_pa_gauge * area
        return np.asarray(shown - np.maximum(least, coefficient * last - stiffness * turned))

    found = least_squares(error, [1.0, 1.0], bounds=([0.0, 0.1], [np.inf, 100.0]))
    coefficient, stiffness = found.x * _TYPICAL_SLIDING
    return Sliding(coefficient_per_rad=float(coefficient), stiffness_n_per_m=float(stiffness)), _rms(found.fun)


def fit_joints(up: States, bare: Surrogate) -> tuple[Cubic, Cubic, Cubic]:
    """Fit the torque laws to the thrust at the angles of the loading finger; ``bare`` has the flexures alone."""
    states = list(zip(up.pressure_pa_gauge, up.joint_angle_rad, strict=True))
    thrust = np.array([bare.thrust_n(p, q) for p, q in states])
    # what the tendon's elongation adds to a joint's stiffness when all three turn alike, less what the pressure takes
    tied = (
        3.0
        * bare.arm.offset_m**2
        * np.array([bare.tendon.slope(bare.lengthening_m(q)) - p * bare.chamber.area_slope_m for p, q in states])
    )
    proximal, middle, distal = (
        fit_joint(q, bare.arm(q) * thrust, tied, law) for q, law in zip(up.joint_angle_rad.T, bare.joints, strict=True)
    )
    return proximal, middle, distal


def finger_lengthening(actuator: ActuatorResult, chamber: Chamber, finger: States) -> F64:
    """Lengthening of the actuator in the complete finger, from its chamber's volume [m], (n,).

    V = V(delta) + p C(delta): the second part is the bulging between the rings, which does no work on the finger. C is
    linear in delta here, ``GAP_BULGING`` times that of analysis (i); the chamber's law keeps one number. What the
    flexure's stretch and the actuator's lift out of the gaps add to the lengthening is in the volume, while the
    sections of the tube do not show it.

    Raises
    ------
    ValueError
        If the volume does not grow by more than the bulging.
    """
    p, d = actuator.pressure_pa_gauge[1:], actuator.lengthening_m[1:]
    swelling = GAP_BULGING * (actuator.volume_m3[1:] - np.array([chamber.volume(x, 0.0) for x in d])) / p
    (slope, straight), *_ = np.linalg.lstsq(np.stack([d, np.ones_like(d)], axis=1), swelling, rcond=None)
    pressure = finger.pressure_pa_gauge
    # B delta^2 / 2 + (A + p C') delta - (dV - p C0) = 0
    growth = finger.volume_m3 - finger.unloaded_volume_m3 - pressure * straight
    linear = chamber.area_m2 + pressure * slope
    root = linear**2 + 2.0 * chamber.area_slope_m * growth
    bad = np.flatnonzero((growth <= 0.0) | (linear <= 0.0) | (root < 0.0))
    if bad.size:
        k = int(bad[0])
        raise ValueError(
            f"finger.volume_m3[{k + 1}] = {finger.volume_m3[k]:.6g} at {finger.pressure_pa_gauge[k]:g} Pa: no "
            "lengthening of the actuator of analysis (i) has this volume"
        )
    return np.asarray(2.0 * growth / (linear + np.sqrt(root)))


def finger_errors(surrogate: Surrogate, finger: States) -> dict[str, float]:
    """Distance of the surrogate's own equilibrium from the loading finger."""
    pressure = finger.pressure_pa_gauge
    angle = np.array([surrogate.angles(p) for p in pressure])
    error = angle - finger.joint_angle_rad
    volume = [surrogate.chamber.volume(surrogate.lengthening_m(q), p) for q, p in zip(angle, pressure, strict=True)]
    missing = finger.volume_m3 - np.array(volume)
    return {
        "finger_joint_angle_rad": _rms(error),
        "finger_joint_angle_rad_max": float(np.abs(error).max()),
        "finger_tip_angle_rad": _rms(error.sum(axis=1)),
        "finger_tip_angle_rad_max": float(np.abs(error.sum(axis=1)).max()),
        "finger_volume_m3": _rms(missing),
        "finger_volume_m3_max": float(np.abs(missing).max()),
    }


def fit_flexure(exoskeleton: ExoskeletonResult) -> tuple[Flexure, dict[str, float]]:
    """Fit the common law of the three identical flexures; return it with the errors of the fit.

    The distal joint carries almost no moment under this load: proximal and middle identify the law.
    """
    angle, moment = exoskeleton.angle_rad[:, :2].ravel(), exoskeleton.moment_n_m[:, :2].ravel()
    near = angle <= USED_ANGLE_RAD
    angle, moment, lengthening = angle[near], moment[near], exoskeleton.lengthening_m[:, :2].ravel()[near]
    law = fit_monotone(angle, moment)
    offset = float(angle @ lengthening / (angle @ angle))
    return Flexure(law=law, offset_m=offset), {
        "flexure_torque_n_m": _rms(moment - np.array([law(q) for q in angle])),
        "flexure_lengthening_m": _rms(lengthening - offset * angle),
    }


def fit_joint(angle_rad: F64, torque_n_m: F64, tied_n_m_per_rad: F64, flexure: Cubic) -> Cubic:
    """Flexure plus a monotone law of its own for the rest, the actuator's bending, which softens as it lifts.

    Beyond the angles of (iii) the slope is therefore never below that of the flexure alone. Errors are weighed by the
    angle that they are worth, torque over stiffness (the joint's own and ``tied_n_m_per_rad``, [n], what the tendon
    adds): a finger near its largest pressure is soft.
    """
    rest = torque_n_m - np.array([flexure(q) for q in angle_rad])
    first = flexure + fit_monotone(angle_rad, rest)
    stiffness = np.array([first.slope(q) for q in angle_rad]) + tied_n_m_per_rad
    return flexure + fit_monotone(angle_rad, rest, 1.0 / np.maximum(stiffness, _SOFTEST * stiffness.max()))


def fit_chamber(actuator: ActuatorResult, used: np.ndarray) -> Chamber:
    """Fit A + B delta to the thrust area, and then C p to what the volume lacks; V0 is that of the mesh.

    Least squares over the states ``used`` [n].
    """
    delta, pressure = actuator.lengthening_m[used], actuator.pressure_pa_gauge[used]
    design = np.stack([np.ones_like(delta), delta], axis=1)
    (area, slope), *_ = np.linalg.lstsq(design, actuator.thrust_area_m2[used], rcond=None)
    stiff = Chamber(
        volume_m3=float(actuator.volume_m3[0]), area_m2=float(area), area_slope_m=float(slope), bulging_m3_per_pa=0.0
    )
    lacking = actuator.volume_m3[used] - np.array([stiff.volume(d, 0.0) for d in delta])
    return replace(stiff, bulging_m3_per_pa=max(0.0, float(pressure @ lacking / (pressure @ pressure))))


def fit_monotone(x: F64, y: F64, weight: F64 | None = None) -> Cubic:
    """Least-squares cubic through the origin with a slope that is nowhere negative; ``weight`` multiplies the errors.

    a = s^2, c = t^2, b = sqrt(3) s t sin(phi) satisfies b^2 <= 3 a c for any s, t, phi.
    """
    scale_x, scale_y = float(np.abs(x).max()), float(np.abs(y).max())
    share = np.ones_like(x) if weight is None else weight / weight.max()

    def coefficients(q: F64) -> F64:
        return np.array([q[0] ** 2, sqrt(3.0) * q[0] * q[1] * np.sin(q[2]), q[1] ** 2])

    def error(q: F64) -> F64:
        a, b, c = coefficients(q)
        u = x / scale_x
        return np.asarray(share * (u * (a + u * (b + u * c)) - y / scale_y))

    starts = [np.array([1.0, 0.3, phi]) for phi in (-0.5 * pi + 0.2, 0.0, 0.5 * pi - 0.2)]
    best = min((least_squares(error, q, xtol=1e-14, ftol=1e-14, gtol=1e-14) for q in starts), key=lambda r: r.cost)
    a, b, c = coefficients(best.x) * scale_y
    return Cubic(a=float(a / scale_x), b=float(b / scale_x**2), c=float(c / scale_x**3))


def _check_states(actuator_states: int, exoskeleton: ExoskeletonResult, finger: FingerResult) -> None:
    """Refuse analyses that ended too early."""
    finger_states = len(_rows(finger, "loading").pressure_pa_gauge)
    for field, found, needed in (
        ("actuator.pressure_pa_gauge", actuator_states, ACTUATOR_STATES),
        ("exoskeleton.load_n", len(exoskeleton.load_n), EXOSKELETON_LOADS),
        ("finger.pressure_pa_gauge", finger_states, FINGER_STATES),
    ):
        if found < needed:
            raise ValueError(f"{field}: {found} usable converged states: a calibration needs at least {needed}")


def _on_branch(finger: FingerResult, branch: str) -> np.ndarray:
    return np.asarray((np.array(finger.branch) == branch) & (finger.pressure_pa_gauge > 0.0))


def _rows(finger: FingerResult, branch: str) -> States:
    rows = _on_branch(finger, branch)
    return States(
        pressure_pa_gauge=finger.pressure_pa_gauge[rows],
        joint_angle_rad=finger.joint_angle_rad[rows],
        volume_m3=finger.volume_m3[rows],
        unloaded_volume_m3=float(finger.volume_m3[0]),
    )


def _rms(error: F64) -> float:
    return float(np.sqrt(np.mean(error**2)))
