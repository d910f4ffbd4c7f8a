"""Reduction of analyses (i) and (ii) to three hinges and one tendon, and the surrogate's own equilibrium.

Finger:   p A(delta) r_i = N(delta) r_i + tau_i(theta_i),   delta = sum r_i theta_i,   V(delta) with V' = A.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from scipy.optimize import brentq, least_squares

from fea.actuator import ActuatorResult
from fea.arrays import F64
from fea.exoskeleton import ExoskeletonResult
from fea.geometry import FingerGeometry

USED_LENGTHENING_M = 17e-3
"""Choice: the range the finger uses up to 80 kPa and beyond; the fit is made there."""
USED_ANGLE_RAD = 0.9
"""Choice: joint angles of the fit; a joint turns 0.6 rad at 80 kPa."""


@dataclass(frozen=True, kw_only=True)
class Cubic:
    """Monotone cubic a x + b x^2 + c x^3 through the origin (a, c >= 0 and b^2 <= 3 a c)."""

    a: float
    b: float
    c: float

    def __post_init__(self) -> None:
        if self.a < 0.0 or self.c < 0.0 or self.b**2 > 3.0 * self.a * self.c * (1.0 + 1e-9):
            raise ValueError(f"a, b, c = {self.a:g}, {self.b:g}, {self.c:g}: must have a, c >= 0 and b^2 <= 3 a c")

    def __call__(self, x: float) -> float:
        """Return the value at x."""
        return x * (self.a + x * (self.b + x * self.c))

    def slope(self, x: float) -> float:
        """Return the derivative at x."""
        return self.a + x * (2.0 * self.b + x * 3.0 * self.c)


@dataclass(frozen=True, kw_only=True)
class Chamber:
    """V(delta) = V0 + A delta + B delta^2 / 2, so the thrust is p (A + B delta)."""

    volume_m3: float
    area_m2: float
    area_slope_m: float

    def area(self, lengthening_m: float) -> float:
        """Return dV/d(delta) [m^2]."""
        return self.area_m2 + self.area_slope_m * lengthening_m

    def volume(self, lengthening_m: float) -> float:
        """Return V [m^3]."""
        return self.volume_m3 + self.area_m2 * lengthening_m + 0.5 * self.area_slope_m * lengthening_m**2


@dataclass(frozen=True, kw_only=True)
class Surrogate:
    """The reduced finger: one offset and one torque law for the three identical joints, tendon spring, chamber.

    ``flexure`` is the exoskeleton's share of the torque law; ``bending_n_m_per_rad`` the actuator's, added linearly.
    """

    offset_m: tuple[float, float, float]
    flexure: Cubic
    bending_n_m_per_rad: float
    tendon: Cubic
    chamber: Chamber

    @property
    def joint(self) -> Cubic:
        """Torque law of a joint: flexure plus bending of the actuator [N m of rad]."""
        return Cubic(a=self.flexure.a + self.bending_n_m_per_rad, b=self.flexure.b, c=self.flexure.c)

    def angles(self, pressure_pa_gauge: float) -> F64:
        """Return the joint angles [3] in equilibrium without gravity.

        Every torque is the net thrust T = p A(delta) - N(delta) times the joint's offset, so the angles follow from T,
        and T from one scalar equation.
        """
        if pressure_pa_gauge <= 0.0:
            return np.zeros(3)
        highest = pressure_pa_gauge * self.chamber.area(2.0 * USED_LENGTHENING_M)

        def from_thrust(thrust: float) -> F64:
            return np.array([self._angle(thrust * r) for r in self.offset_m])

        def excess(thrust: float) -> float:
            delta = float(np.dot(self.offset_m, from_thrust(thrust)))
            return pressure_pa_gauge * self.chamber.area(delta) - self.tendon(delta) - thrust

        return from_thrust(float(brentq(excess, 0.0, highest, xtol=1e-12, rtol=1e-12)))

    def tip_angle_deg(self, pressure_pa_gauge: float) -> float:
        """Return the sum of the joint angles in degrees."""
        return float(np.rad2deg(self.angles(pressure_pa_gauge).sum()))

    def _angle(self, torque: float) -> float:
        law = self.joint
        return float(brentq(lambda q: law(q) - torque, 0.0, 4.0, xtol=1e-14, rtol=1e-13))


@dataclass(frozen=True, kw_only=True)
class Fit:
    """A surrogate with the root-mean-square errors of its fits."""

    surrogate: Surrogate
    rmse: dict[str, float]


def reduce_finger(geometry: FingerGeometry, actuator: ActuatorResult, exoskeleton: ExoskeletonResult) -> Fit:
    """Fit the surrogate to both analyses.

    Raises
    ------
    ValueError
        If too few load steps converged to fit anything.
    """
    used = (actuator.lengthening_m <= USED_LENGTHENING_M) & (actuator.pressure_pa_gauge > 0.0)
    if used.sum() < 4 or len(exoskeleton.load_n) < 3:
        raise ValueError(
            f"actuator states {int(used.sum())} (needs 4) or exoskeleton loads {len(exoskeleton.load_n)} (needs 3): "
            "too few converged steps for a calibration"
        )
    delta, pressure = actuator.lengthening_m[used], actuator.pressure_pa_gauge[used]
    chamber = fit_chamber(delta, actuator.thrust_area_m2[used], float(actuator.volume_m3[0]))
    force = pressure * np.array([chamber.area(d) for d in delta])
    tendon = fit_monotone(delta, force)
    # the distal joint carries almost no moment under this load: proximal and middle identify the common law
    angle, moment = exoskeleton.angle_rad[:, :2].ravel(), exoskeleton.moment_n_m[:, :2].ravel()
    lengthening = exoskeleton.lengthening_m[:, :2].ravel()
    near = angle <= USED_ANGLE_RAD
    flexure = fit_monotone(angle[near], moment[near])
    offset = float(angle[near] @ lengthening[near] / (angle[near] @ angle[near]))
    surrogate = Surrogate(
        offset_m=(offset, offset, offset),
        flexure=flexure,
        bending_n_m_per_rad=actuator_bending_stiffness(geometry, tendon),
        tendon=tendon,
        chamber=chamber,
    )
    rmse = {
        "thrust_area_m2": _rms(actuator.thrust_area_m2[used] - force / pressure),
        "chamber_volume_m3": _rms(actuator.volume_m3[used] - np.array([chamber.volume(d) for d in delta])),
        "tendon_force_n": _rms(force - np.array([tendon(d) for d in delta])),
        "flexure_torque_n_m": _rms(moment[near] - np.array([flexure(q) for q in angle[near]])),
        "joint_lengthening_m": _rms(lengthening[near] - offset * angle[near]),
    }
    return Fit(surrogate=surrogate, rmse=rmse)


def actuator_bending_stiffness(geometry: FingerGeometry, tendon: Cubic) -> float:
    """Bending stiffness of the actuator over one joint gap [N m/rad]: a reduction choice, not an analysis of its own.

    Beam theory: EI = EA (r_i^2 + r_o^2) / 4 for a ring section, with EA = L dN/d(delta) averaged over the range that
    the finger uses. Choice: the bend runs out half an outer radius into each tube mouth, which holds soft silicone with
    clearance, so the hinge is a gap plus one outer radius long. The complete-finger study to compare with had
    7.2 N mm at 0.59 rad in the middle joint.
    """
    middle = 0.5 * USED_LENGTHENING_M
    axial = geometry.chamber_length_m * tendon(middle) / middle
    radii = geometry.actuator_inner_radius_m**2 + geometry.actuator_outer_radius_m**2
    return axial * radii / 4.0 / (geometry.gap_length_m + geometry.actuator_outer_radius_m)


def fit_chamber(lengthening_m: F64, area_m2: F64, volume_m3: float) -> Chamber:
    """Fit A + B delta to the thrust area of the finite elements; V0 is that of the mesh."""
    design = np.stack([np.ones_like(lengthening_m), lengthening_m], axis=1)
    (area, slope), *_ = np.linalg.lstsq(design, area_m2, rcond=None)
    return Chamber(volume_m3=volume_m3, area_m2=float(area), area_slope_m=float(slope))


def fit_monotone(x: F64, y: F64) -> Cubic:
    """Least-squares cubic through the origin with a slope that is nowhere negative.

    a = s^2, c = t^2, b = sqrt(3) s t sin(phi) satisfies b^2 <= 3 a c for any s, t, phi.
    """
    scale_x, scale_y = float(np.abs(x).max()), float(np.abs(y).max())

    def coefficients(q: F64) -> F64:
        return np.array([q[0] ** 2, sqrt(3.0) * q[0] * q[1] * np.sin(q[2]), q[1] ** 2])

    def error(q: F64) -> F64:
        a, b, c = coefficients(q)
        u = x / scale_x
        return np.asarray(u * (a + u * (b + u * c)) - y / scale_y)

    starts = [np.array([1.0, 0.3, phi]) for phi in (-0.5 * pi + 0.2, 0.0, 0.5 * pi - 0.2)]
    best = min((least_squares(error, q, xtol=1e-14, ftol=1e-14, gtol=1e-14) for q in starts), key=lambda r: r.cost)
    a, b, c = coefficients(best.x) * scale_y
    return Cubic(a=float(a / scale_x), b=float(b / scale_x**2), c=float(c / scale_x**3))


def _rms(error: F64) -> float:
    return float(np.sqrt(np.mean(error**2)))
