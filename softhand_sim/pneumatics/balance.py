"""The implicit gas balance of one vessel: one pressure, any number of links that feed or empty it."""

from collections.abc import Sequence
from typing import Protocol

_TOLERANCE = 1e-12
_MAX_ITERATIONS = 100


class Link(Protocol):
    """A way for gas into a vessel: an orifice, a tube, a branch of the network."""

    def inflow_and_slope(self, reservoir_pa_abs: float, chamber_pa_abs: float) -> tuple[float, float]:
        """Return the flow into the vessel [kg/s] and its derivative, never positive, by the vessel's pressure."""
        ...

    def mass_flow_kg_per_s(self, from_pa_abs: float, to_pa_abs: float) -> float:
        """Return the mass flow [kg/s] into the vessel, whose pressure is the second argument."""
        ...


Links = Sequence[tuple[Link, float]]
"""Links with the pressure [Pa abs] on their far side."""


def solve_pressure(
    content: float,
    capacity: float,
    growth: float,
    links: Links,
    dt: float,
    bracket: tuple[float, float, float],
) -> float:
    """Return the pressure ``p`` [Pa abs] with ``(capacity + growth p) p = content + dt sum q(p)``.

    The left side rises with ``p`` and every flow falls, so there is one root: Newton's method, falling back on
    bisection of the bracket.

    Parameters
    ----------
    content
        Gas in the vessel before the step [kg].
    capacity, growth
        Gas per pressure [kg/Pa] and by how much a pascal raises it [kg/Pa2].
    links
        What feeds or empties the vessel.
    dt
        Step [s].
    bracket
        First guess, and the bounds between which the root lies [Pa abs].
    """
    p, low, high = bracket
    for _ in range(_MAX_ITERATIONS):
        residual, slope = (capacity + growth * p) * p - content, capacity + 2.0 * growth * p
        for link, reservoir in links:
            flow, flow_slope = link.inflow_and_slope(reservoir, p)
            residual -= dt * flow
            slope -= dt * flow_slope
        if residual > 0.0:
            high = p
        elif residual < 0.0:
            low = p
        else:
            return p
        newton = p - residual / slope
        if abs(newton - p) <= _TOLERANCE * p:
            return min(max(newton, low), high)
        p = newton if low < newton < high else 0.5 * (low + high)
    return p
