"""The finger reduced to three hinges and one tendon, and its equilibrium.

Finger:   p A(delta) r_i = N(delta) r_i + tau_i(theta_i),   delta = sum r_i theta_i,   V(delta) with V' = A.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fea.arrays import F64

_DOUBLINGS = 20


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

    def inverse(self, y: float) -> float:
        """Return the x >= 0 at which the cubic is y >= 0."""
        high = 1.0
        while self(high) < y:
            high *= 2.0
        return float(brentq(lambda x: self(x) - y, 0.0, high, xtol=1e-14, rtol=1e-13))


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
class Surrogate:
    """The reduced finger: an offset and a torque law for each joint, tendon spring, chamber.

    Raises
    ------
    ValueError
        If a joint has no stiffness at all.
    """

    offset_m: tuple[float, float, float]
    joints: tuple[Cubic, Cubic, Cubic]
    tendon: Cubic
    chamber: Chamber

    def __post_init__(self) -> None:
        for k, law in enumerate(self.joints):
            if law.a + law.c <= 0.0:
                raise ValueError(f"joints[{k}]: a + c = {law.a + law.c:g} must be > 0, or nothing holds the joint")

    def lengthening_m(self, angle_rad: F64) -> float:
        """Return delta at joint angles [3]."""
        return float(np.dot(self.offset_m, angle_rad))

    def thrust_n(self, pressure_pa_gauge: float, lengthening_m: float) -> float:
        """Return the net thrust p A(delta) - N(delta)."""
        return pressure_pa_gauge * self.chamber.area(lengthening_m) - self.tendon(lengthening_m)

    def angles(self, pressure_pa_gauge: float) -> F64:
        """Return the joint angles [3] in equilibrium without gravity.

        Every torque is the net thrust times the joint's offset, so the angles follow from the thrust, and the thrust
        from one scalar equation.
        """
        if pressure_pa_gauge <= 0.0:
            return np.zeros(3)

        def from_thrust(thrust: float) -> F64:
            return np.array([law.inverse(thrust * r) for r, law in zip(self.offset_m, self.joints, strict=True)])

        def excess(thrust: float) -> float:
            return self.thrust_n(pressure_pa_gauge, self.lengthening_m(from_thrust(thrust))) - thrust

        # the net thrust of a straight finger; the tendon takes part of it as soon as the finger bends
        high = self.thrust_n(pressure_pa_gauge, 0.0)
        for _ in range(_DOUBLINGS):
            if excess(high) <= 0.0:
                return from_thrust(float(brentq(excess, 0.0, high, xtol=1e-12, rtol=1e-12)))
            high *= 2.0
        raise ValueError(
            f"pressure_pa_gauge = {pressure_pa_gauge:g}: no equilibrium; thrust outgrows tendon and joints"
        )

    def tip_angle_deg(self, pressure_pa_gauge: float) -> float:
        """Return the sum of the joint angles in degrees."""
        return float(np.rad2deg(self.angles(pressure_pa_gauge).sum()))
