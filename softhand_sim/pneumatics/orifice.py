"""ISO 6358 mass flow through an orifice (an open valve, a leak): choked, unchoked, and in either direction."""

import math
from dataclasses import dataclass, field

from softhand_sim.air import REFERENCE_DENSITY_KG_PER_M3, ROOM_TEMPERATURE_K
from softhand_sim.checks import require_finite, require_in

LARGEST_CONDUCTANCE = 1e-2
"""Choice: a hole of a metre [m3/(s Pa)]; with 1e300 the rounding of a step's flow is more than all the gas."""


@dataclass(frozen=True, kw_only=True)
class Orifice:
    """An orifice after ISO 6358: a valve that is open, or a leak.

    With upstream pressure ``p1``, downstream ``p2``, ratio ``r = p2 / p1`` (absolute pressures), the mass
    flow is

    - ``r <= b``: ``C rho0 sqrt(T0/T) p1`` (choked);
    - ``b < r < r_lam``: that times ``sqrt(1 - ((r - b) / (1 - b))**2)`` (unchoked, ISO 6358-1:2013);
    - ``r >= r_lam``: linear in ``p1 - p2``, continuous at ``r_lam``. The ellipse has an infinite slope at
      ``r = 1``, where a real valve's flow is laminar; this is the usual replacement in simulation (for
      instance Simscape's ISO 6358 orifice, which recommends a laminar ratio from 0.995 to 0.999).

    Attributes
    ----------
    sonic_conductance_m3_per_s_pa
        ``C`` [m3/(s Pa)]. Choice: no flow figure of the CY05820D valve is published. It sets two
        observables, with the default supply and tubes: the time to fill a finger from ambient to 75 kPa gauge, 0.76 s
        (1.84 s for three fingers on one manifold), and what one tick of 20 ms moves a finger by, 1.9 kPa at most.
        The paper's hand holds "marginally below" the set pressure for long times with a law that reads at 50 Hz, so a
        tick's pulse has to be small beside the held pressure; twice the conductance halves the time, moves 3.9 kPa a
        tick and holds up to 2.4 kPa away.
    critical_pressure_ratio
        ``b`` [-]. Choice: 0.3, in the middle of the 0.2 to 0.5 that makers state for small solenoid valves.
    laminar_pressure_ratio
        ``r_lam`` [-]. Choice: 0.999, that is within 0.1 kPa of equilibrium, under the sensor's resolution.
    temperature_k
        Temperature of the gas upstream [K].

    Raises
    ------
    ValueError
        If ``C`` is not in (0, 0.01], the temperature is not positive, or not ``0 <= b < r_lam < 1``.
    """

    sonic_conductance_m3_per_s_pa: float = 5e-11
    critical_pressure_ratio: float = 0.3
    laminar_pressure_ratio: float = 0.999
    temperature_k: float = ROOM_TEMPERATURE_K
    choked_coefficient_kg_per_s_pa: float = field(init=False, repr=False, compare=False)
    laminar_coefficient_kg_per_s_pa: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        b, r_lam = self.critical_pressure_ratio, self.laminar_pressure_ratio
        require_finite("sonic_conductance_m3_per_s_pa", self.sonic_conductance_m3_per_s_pa, above=0.0)
        require_in("sonic_conductance_m3_per_s_pa", self.sonic_conductance_m3_per_s_pa, 0.0, LARGEST_CONDUCTANCE)
        require_finite("temperature_k", self.temperature_k, above=0.0)
        require_in("laminar_pressure_ratio", r_lam, 0.9, 0.9999)
        require_in("critical_pressure_ratio", b, 0.0, 0.8)
        choked = (
            self.sonic_conductance_m3_per_s_pa
            * REFERENCE_DENSITY_KG_PER_M3
            * math.sqrt(ROOM_TEMPERATURE_K / self.temperature_k)
        )
        at_laminar = choked * math.sqrt(1.0 - ((r_lam - b) / (1.0 - b)) ** 2)
        object.__setattr__(self, "choked_coefficient_kg_per_s_pa", choked)
        object.__setattr__(self, "laminar_coefficient_kg_per_s_pa", at_laminar / (1.0 - r_lam))

    def mass_flow_kg_per_s(self, from_pa_abs: float, to_pa_abs: float) -> float:
        """Return the flow [kg/s] from one side to the other; negative when it runs back."""
        return self.inflow_and_slope(from_pa_abs, to_pa_abs)[0]

    def inflow_and_slope(self, reservoir_pa_abs: float, chamber_pa_abs: float) -> tuple[float, float]:
        """Return the flow into a chamber [kg/s] and its derivative by the chamber's pressure [kg/(s Pa)].

        The flow falls monotonically with the chamber's pressure (the derivative is never positive), which
        is what makes the implicit step of an element solvable by bracketing.
        """
        k = self.choked_coefficient_kg_per_s_pa
        b = self.critical_pressure_ratio
        if chamber_pa_abs <= reservoir_pa_abs:
            ratio = chamber_pa_abs / reservoir_pa_abs
            if ratio <= b:
                return k * reservoir_pa_abs, 0.0
            if ratio < self.laminar_pressure_ratio:
                s = (ratio - b) / (1.0 - b)
                root = math.sqrt(1.0 - s * s)
                return k * reservoir_pa_abs * root, -k * s / ((1.0 - b) * root)
        else:
            ratio = reservoir_pa_abs / chamber_pa_abs
            if ratio <= b:
                return -k * chamber_pa_abs, -k
            if ratio < self.laminar_pressure_ratio:
                s = (ratio - b) / (1.0 - b)
                root = math.sqrt(1.0 - s * s)
                return -k * chamber_pa_abs * root, -k * (root + ratio * s / ((1.0 - b) * root))
        linear = self.laminar_coefficient_kg_per_s_pa
        return linear * (reservoir_pa_abs - chamber_pa_abs), -linear
