"""The finger reduced to three hinges and one tendon, and its equilibrium.

Finger:   r(theta_i) (p A(delta) - N(delta) - F) = tau_i(theta_i),   V(delta) with V' = A,   |F| <= c p A sum |theta_i|,
          delta = sum of the integrals of r from 0 to theta_i,   r = r0 cos(theta / 2) + 2 r1 sin(theta / 2).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fea.arrays import F64

_DOUBLINGS = 20
WIDEST_RAD = 0.5 * np.pi
"""Choice: no joint is looked for beyond a right angle; its gap has closed long before."""
_LOADING, _UNLOADING = 1.0, -1.0


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

    def __add__(self, other: "Cubic") -> "Cubic":
        """Return the sum, monotone like its parts."""
        return Cubic(a=self.a + other.a, b=self.b + other.b, c=self.c + other.c)

    def slope(self, x: float) -> float:
        """Return the derivative at x."""
        return self.a + x * (2.0 * self.b + x * 3.0 * self.c)


@dataclass(frozen=True, kw_only=True)
class Arm:
    """Arm of the thrust about a joint: ``offset_m`` when straight, and its slope there [m/rad].

    The arm is that of a line through two points, one fixed to either side of the joint, each ``offset_m`` to the back
    of the hinge and twice the slope past it: the line moves away from the hinge as the joint bends, as the actuator
    does that lifts out of the gap. The engine has such a line (a spatial tendon through two sites).
    """

    offset_m: float
    offset_slope_m_per_rad: float

    def __call__(self, angle_rad: F64) -> F64:
        """Return the arm [m] at angles of any shape."""
        half = 0.5 * np.asarray(angle_rad)
        return np.asarray(self.offset_m * np.cos(half) + 2.0 * self.offset_slope_m_per_rad * np.sin(half))

    def lengthening_m(self, angle_rad: F64) -> F64:
        """Return the integral of the arm from 0 to each angle [m]."""
        half = 0.5 * np.asarray(angle_rad)
        grown = 4.0 * self.offset_slope_m_per_rad * (1.0 - np.cos(half))
        return np.asarray(2.0 * self.offset_m * np.sin(half) + grown)


@dataclass(frozen=True, kw_only=True)
class Chamber:
    """V(delta, p) = V0 + A delta + B delta^2 / 2 + C p, so the thrust is p (A + B delta).

    C is the bulging of the wall between the rings. It takes gas and stores its work, C p^2 / 2, but as it does not
    depend on delta it does none on the finger.
    """

    volume_m3: float
    area_m2: float
    area_slope_m: float
    bulging_m3_per_pa: float

    def area(self, lengthening_m: float) -> float:
        """Return dV/d(delta) [m^2]."""
        return self.area_m2 + self.area_slope_m * lengthening_m

    def volume(self, lengthening_m: float, pressure_pa_gauge: float) -> float:
        """Return V [m^3]."""
        stretched = self.area_m2 * lengthening_m + 0.5 * self.area_slope_m * lengthening_m**2
        return self.volume_m3 + stretched + self.bulging_m3_per_pa * pressure_pa_gauge


@dataclass(frozen=True, kw_only=True)
class Sliding:
    """Friction of the actuator in the exoskeleton, against its lengthening.

    At most ``coefficient_per_rad`` of the thrust p A for each radian of bending, as a rope's on a pulley; below that it
    is a spring of ``stiffness_n_per_m``, since the slip turns over gradually along the actuator.
    """

    coefficient_per_rad: float
    stiffness_n_per_m: float


@dataclass(frozen=True, kw_only=True)
class Surrogate:
    """The reduced finger: arm, a torque law for each joint, tendon spring, chamber, sliding friction.

    Raises
    ------
    ValueError
        If a joint has no stiffness at all.
    """

    arm: Arm
    joints: tuple[Cubic, Cubic, Cubic]
    tendon: Cubic
    chamber: Chamber
    sliding: Sliding

    def __post_init__(self) -> None:
        for k, law in enumerate(self.joints):
            if law.a + law.c <= 0.0:
                raise ValueError(f"joints[{k}]: a + c = {law.a + law.c:g} must be > 0, or nothing holds the joint")

    def lengthening_m(self, angle_rad: F64) -> float:
        """Return delta at joint angles [3]."""
        return float(self.arm.lengthening_m(angle_rad).sum())

    def thrust_n(self, pressure_pa_gauge: float, angle_rad: F64, *, sliding: float = _LOADING) -> float:
        """Return the net thrust p A - N - F; ``sliding`` is 1 while it lengthens, -1 while it shortens, 0 without F."""
        lengthening = self.lengthening_m(angle_rad)
        lost = sliding * self.sliding.coefficient_per_rad * float(np.abs(angle_rad).sum())
        return pressure_pa_gauge * self.chamber.area(lengthening) * (1.0 - lost) - self.tendon(lengthening)

    def angles(self, pressure_pa_gauge: float, *, sliding: float = _LOADING) -> F64:
        """Return the joint angles [3] in equilibrium without gravity, while loading by default.

        Every torque is the net thrust times the arm, so the angles follow from the thrust, and the thrust from one
        scalar equation.

        Raises
        ------
        ValueError
            If there is no equilibrium below a right angle.
        """
        if pressure_pa_gauge <= 0.0:
            return np.zeros(3)

        def from_thrust(thrust: float) -> F64:
            return np.array([_balance(law, self.arm, thrust) for law in self.joints])

        def excess(thrust: float) -> float:
            return self.thrust_n(pressure_pa_gauge, from_thrust(thrust), sliding=sliding) - thrust

        # the net thrust of a straight finger; the tendon takes part of it as soon as the finger bends
        high = self.thrust_n(pressure_pa_gauge, np.zeros(3))
        for _ in range(_DOUBLINGS):
            if excess(high) <= 0.0:
                angle = from_thrust(float(brentq(excess, 0.0, high, xtol=1e-13, rtol=1e-13)))
                if angle.max() < WIDEST_RAD:
                    return angle
                break
            high *= 2.0
        raise ValueError(
            f"pressure_pa_gauge = {pressure_pa_gauge:g}: no equilibrium; thrust outgrows tendon and joints"
        )

    def tip_angle_deg(self, pressure_pa_gauge: float, *, sliding: float = _LOADING) -> float:
        """Return the sum of the joint angles in degrees, while loading by default."""
        return float(np.rad2deg(self.angles(pressure_pa_gauge, sliding=sliding).sum()))

    def unloading_angles(self, pressure_pa_gauge: float) -> F64:
        """Return the joint angles [3] on the way back, after the slip has turned everywhere."""
        return self.angles(pressure_pa_gauge, sliding=_UNLOADING)


def _balance(law: Cubic, arm: Arm, thrust_n: float) -> float:
    """Return the angle at which a joint's torque is the thrust's, a right angle where it never is."""

    def missing(q: float) -> float:
        return law(q) - thrust_n * float(arm(np.array(q)))

    if missing(WIDEST_RAD) <= 0.0:
        return float(WIDEST_RAD)
    return float(brentq(missing, 0.0, WIDEST_RAD, xtol=1e-14, rtol=1e-13))
