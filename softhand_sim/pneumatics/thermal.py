"""Heat of compression: gas that warms when it is compressed and cools at the wall."""

import math
from dataclasses import dataclass

from softhand_sim.air import HEAT_CAPACITY_RATIO
from softhand_sim.checks import require_finite, require_in


@dataclass(frozen=True, kw_only=True)
class Polytropic:
    """Polytropic gas: ``p V^n`` is constant in a shut vessel that changes fast.

    With gas flowing in at the temperature ``T_in`` and out at the vessel's own ``T``,
    ``d(p V)/dt = n R (T_in q_in - T q_out) - (n - 1) p dV/dt - (p V - m R T_0) / tau``,
    which for ``n = 1.4`` is the energy balance of an ideal gas and for ``n = 1`` the isothermal law. The last term
    is the heat that the wall, at room temperature ``T_0``, takes up.

    Attributes
    ----------
    exponent
        ``n`` [-], above 1 (isothermal: leave the whole thing out) up to 1.4 (adiabatic).
    wall_time_constant_s
        ``tau`` [s]; None for no heat to the wall. Choice: 0.05 s, in the middle of the 0.02 to 0.13 s that conduction
        takes across bores of 3 to 8 mm (``d**2 / (23 a)``, thermal diffusivity of air a = 2.1e-5 m2/s).

    Raises
    ------
    ValueError
        If a parameter is out of its range.
    """

    exponent: float = HEAT_CAPACITY_RATIO
    wall_time_constant_s: float | None = 0.05

    def __post_init__(self) -> None:
        require_in("exponent", self.exponent, 1.0 + 1e-6, HEAT_CAPACITY_RATIO)
        if self.wall_time_constant_s is not None:
            require_finite("wall_time_constant_s", self.wall_time_constant_s, above=0.0)

    def pressure_pa_abs(self, invariant: float, stiff_m3: float, compliance_m3_per_pa: float) -> float:
        """Return the root of ``p^(1/n) (stiff + compliance p) = invariant`` [Pa abs]."""
        p = math.pow(invariant / stiff_m3, self.exponent)
        if compliance_m3_per_pa == 0.0:
            return p
        # Newton on the logarithm: the function is increasing and convex in log p, so it converges from any start
        for _ in range(50):
            volume = stiff_m3 + compliance_m3_per_pa * p
            error = math.log(p) / self.exponent + math.log(volume / invariant)
            step = error / (1.0 / self.exponent + compliance_m3_per_pa * p / volume)
            p *= math.exp(-step)
            if abs(step) <= 1e-14:
                break
        return p

    def invariant(self, pressure_pa_abs: float, stiff_m3: float, compliance_m3_per_pa: float) -> float:
        """Return ``p^(1/n) V(p)``, which a change of volume without flow leaves alone."""
        volume = stiff_m3 + compliance_m3_per_pa * pressure_pa_abs
        return math.pow(pressure_pa_abs, 1.0 / self.exponent) * volume

    def kept_share(self, dt: float) -> float:
        """Return the share of the excess heat that is left after ``dt`` [s]."""
        return 1.0 if self.wall_time_constant_s is None else math.exp(-dt / self.wall_time_constant_s)
