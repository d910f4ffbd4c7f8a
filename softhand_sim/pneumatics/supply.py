"""Compressed air supply of finite capacity: a receiver behind a regulator that droops."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from softhand_sim.checks import require_finite

# mass is kept to rounding whatever the tolerance; so tight that flows reckoned from the pressure agree over a minute
_TOLERANCE = 1e-12
_MAX_ITERATIONS = 100


@dataclass(frozen=True, kw_only=True)
class Supply:
    """Receiver (isothermal) that all inlets draw from, refilled through a regulator.

    The regulator's flow rises in proportion to how far the receiver lies under the set pressure, up to what the
    compressor gives; it lets nothing back.

    Attributes
    ----------
    volume_m3
        Volume of the receiver and of what lies between it and the valves [m3]. Choice: 0.2 l, a small regulator
        block with its tubes.
    largest_flow_kg_per_s
        Compressor's flow [kg/s]. Choice: 2e-4, ten litres of free air a minute, a small bench compressor; the three
        inlets together take up to 0.44e-4.
    droop_pa
        How far the pressure must fall for the regulator to open fully [Pa]. Choice: 10 kPa; with all three inlets open
        the receiver then settles 2 kPa under the set pressure.

    Raises
    ------
    ValueError
        If a parameter is not positive.
    """

    volume_m3: float = 2e-4
    largest_flow_kg_per_s: float = 2e-4
    droop_pa: float = 10e3

    def __post_init__(self) -> None:
        for name in ("volume_m3", "largest_flow_kg_per_s", "droop_pa"):
            require_finite(name, getattr(self, name), above=0.0)

    def refill_kg_per_s(self, set_pa_abs: float, pressure_pa_abs: float) -> float:
        """Return the regulator's flow [kg/s] into a receiver at ``pressure_pa_abs``, for a set pressure [Pa abs]."""
        opening = (set_pa_abs - pressure_pa_abs) / self.droop_pa
        return self.largest_flow_kg_per_s * min(max(opening, 0.0), 1.0)


def solve_receiver(
    supply: Supply,
    *,
    mass_kg: float,
    rt_j_per_kg: float,
    set_pa_abs: float,
    others_pa_abs: Sequence[float],
    draw: Callable[[float], float],
    dt: float,
) -> float:
    """Return the mass [kg] in the receiver after ``dt`` [s]; ``draw`` is last called at the final pressure.

    The balance ``p V / (R T) + draw(p) - dt refill(p) = m`` rises with ``p``, so it has one root, and that lies between
    the receiver's and set pressure and those of all vessels and reservoirs: secant steps, with bisection of that
    bracket where they leave it.

    Parameters
    ----------
    supply
        Receiver and regulator.
    mass_kg
        Gas in the receiver before the step [kg].
    rt_j_per_kg
        ``R T`` [J/kg].
    set_pa_abs
        Set pressure of the regulator [Pa abs].
    others_pa_abs
        Pressures of everything that the receiver may be connected to.
    draw
        Mass [kg] that the open inlets take over the step when the receiver ends at a pressure [Pa abs].
    dt
        Step [s].
    """
    capacity = supply.volume_m3 / rt_j_per_kg
    start = mass_kg / capacity
    low, high = min(start, *others_pa_abs), max(start, set_pa_abs, *others_pa_abs)
    p, before, residual_before = start, start, 0.0
    for iteration in range(_MAX_ITERATIONS):
        gained = dt * supply.refill_kg_per_s(set_pa_abs, p) - draw(p)
        residual = capacity * p - mass_kg - gained
        low, high = (low, min(high, p)) if residual > 0.0 else (max(low, p), high)
        slope = capacity if iteration == 0 else (residual - residual_before) / (p - before)
        following = p - residual / slope if slope > 0.0 else 0.5 * (low + high)
        if residual == 0.0 or abs(following - p) <= _TOLERANCE * p:
            return mass_kg + gained
        before, residual_before = p, residual
        p = following if low < following < high else 0.5 * (low + high)
    return mass_kg + gained
