"""Relief at the proximal joint: the actuator's elongation that the exoskeleton cannot take pushes it out there."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import ChamberCalibration, TendonCalibration
from softhand_sim.checks import require_finite

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ProximalRelief:
    """A slide in series with the actuator that gives way above a thrust; the bulge b >= 0 lengthens the actuator by b.

        T(d + b, p) = p A(d + b) - N(d + b),    c db/dt = T - thrust_n - stiffness_n_per_m b   or   b = 0

    with the elongation d that the joints allow, and the dashpot c that gives the slide ``time_s``. At rest the thrust
    on the joints is at most ``thrust_n + stiffness_n_per_m b``; what pushes the actuator out is stored in its wall and
    in the gas, so a closed cycle that is slow enough loses nothing.

    Attributes
    ----------
    thrust_n
        Net thrust at which the actuator begins to come out. The default is that of the shipped finger when its tip is
        blocked at the stated plateau (:func:`softhand_sim.characterize.relief.relief_at_plateau`).
    stiffness_n_per_m
        Rise of that thrust with the bulge. Choice: none; the paper says that the force levels off, and no more.
    time_s
        Time of the slide while the actuator gives way. Choice: ten of the engine's steps; the gas, which has its volume
        from the step before, then sees it grow slowly.
    """

    thrust_n: float = 3.09
    stiffness_n_per_m: float = 0.0
    time_s: float = 0.02

    def __post_init__(self) -> None:
        require_finite("thrust_n", self.thrust_n, above=0.0)
        require_finite("stiffness_n_per_m", self.stiffness_n_per_m, at_least=0.0)
        require_finite("time_s", self.time_s, above=0.0)


@dataclass(frozen=True, kw_only=True)
class Relief:
    """The relief of fingers with one actuator's laws; the bulges are the state."""

    law: ProximalRelief
    chamber: ChamberCalibration
    tendon: TendonCalibration

    def thrust_n(self, elongation_m: Vector, pressure_pa_gauge: Vector) -> Vector:
        """Return the net thrust p A - N of actuators of an elongation, the bulge included [N], (n,)."""
        a, b, c = self.tendon.polynomial
        d = elongation_m
        area = self.chamber.area_m2 + self.chamber.area_slope_m * d
        return np.asarray(pressure_pa_gauge * area - d * (a + d * (b + d * c)))

    def step(
        self, bulge_m: Vector, elongation_m: Vector, pressure_pa_gauge: Vector, dt: float
    ) -> tuple[Vector, Vector]:
        """Return the bulges after a time step [m] and the force along the joints' elongation that they cost [N], (n,).

        Linearly implicit in the bulge: stable at any step.
        """
        before = self.thrust_n(elongation_m, pressure_pa_gauge)
        highest = float(before.max())
        if highest <= self.law.thrust_n and not bulge_m.any():
            return bulge_m, np.zeros_like(before)
        long, spring = elongation_m + bulge_m, self.law.stiffness_n_per_m
        excess = self.thrust_n(long, pressure_pa_gauge) - self.law.thrust_n - spring * bulge_m
        softening = np.maximum(self._stiffness(long, pressure_pa_gauge), 0.0) + spring
        slow = self.law.time_s * (self.tendon.stiffness_n_per_m + spring)
        bulge = np.maximum(0.0, bulge_m + dt * excess / (slow + dt * softening))
        return bulge, self.thrust_n(elongation_m + bulge, pressure_pa_gauge) - before

    def _stiffness(self, elongation_m: Vector, pressure_pa_gauge: Vector) -> Vector:
        """Return by how much the thrust falls with the elongation [N/m]."""
        a, b, c = self.tendon.polynomial
        return np.asarray(
            a + elongation_m * (2.0 * b + 3.0 * c * elongation_m) - pressure_pa_gauge * self.chamber.area_slope_m
        )
