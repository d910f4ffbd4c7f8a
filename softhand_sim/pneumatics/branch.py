"""A finger's chamber behind a tube that resists, as one link of its manifold."""

from softhand_sim.pneumatics.balance import Link, solve_pressure
from softhand_sim.pneumatics.tube import Tube
from softhand_sim.pneumatics.vessel import Vessel, Warmed, positive_root


class Branch:
    """A finger's chamber behind its tube, as a link of the manifold; its own pressure follows the manifold's."""

    __slots__ = ("_dt", "_high", "_hub_warmth", "_leak", "_low", "_tube", "_tube_link", "leaf", "pressure")

    def __init__(self, leaf: Vessel, tube: Tube, hub: Vessel, leak: tuple[Link, float] | None, dt: float) -> None:
        self.leaf, self._tube, self._leak, self._dt = leaf, tube, leak, dt
        self.pressure = leaf.pressure
        self._hub_warmth = hub.warmth
        plain = leaf.thermal is None
        self._tube_link: Link = tube if plain else Warmed(tube, hub.warmth, leaf.warmth, 0.0)
        self._low = leaf.pressure if leak is None else min(leaf.pressure, leak[1])
        self._high = leaf.pressure if leak is None else max(leaf.pressure, leak[1])

    @property
    def range_pa_abs(self) -> tuple[float, float]:
        """Lowest and highest pressure that the chamber could reach without the manifold [Pa abs]."""
        return self._low, self._high

    def mass_flow_kg_per_s(self, _from_pa_abs: float, to_pa_abs: float) -> float:
        """Return the mass flow [kg/s] from the chamber into a manifold at ``to_pa_abs``."""
        return self._tube.mass_flow_kg_per_s(self.solve(to_pa_abs), to_pa_abs)

    def inflow_and_slope(self, _reservoir_pa_abs: float, chamber_pa_abs: float) -> tuple[float, float]:
        """Return the flow into the manifold at ``chamber_pa_abs`` and its derivative, the chamber following."""
        leaf, hub_p, p, dt = self.leaf, chamber_pa_abs, self.solve(chamber_pa_abs), self._dt
        flow, slope = self._tube.flow_and_slope(hub_p * hub_p - p * p)
        if leaf.thermal is not None:
            warmth = self._hub_warmth if flow > 0.0 else leaf.warmth
            flow, slope = warmth * flow, warmth * slope
        stiffness = leaf.capacity + 2.0 * leaf.growth * p + 2.0 * dt * p * slope
        if self._leak is not None:
            stiffness -= dt * self._leak[0].inflow_and_slope(self._leak[1], p)[1]
        return -flow, -2.0 * hub_p * slope * (1.0 - 2.0 * dt * p * slope / stiffness)

    def end(self, outflow_kg_per_s: float) -> tuple[float, float | None, float]:
        """Return mass [kg], invariant and pressure [Pa abs] at the step's end, after `outflow_kg_per_s` to the hub."""
        inflow = -outflow_kg_per_s
        if self._leak is not None:
            inflow += self._leak[0].mass_flow_kg_per_s(self._leak[1], self.pressure)
        return self.leaf.settled(self.pressure, self.leaf.mass + self._dt * inflow, self._dt)

    def solve(self, hub_pa_abs: float) -> float:
        """Return the chamber's pressure [Pa abs] at the step's end for a pressure of the manifold."""
        leaf, dt = self.leaf, self._dt
        if self._leak is None and leaf.thermal is None:
            pull = dt * self._tube.laminar_kg_per_s_pa2
            p = positive_root(leaf.growth + pull, leaf.capacity, leaf.content + pull * hub_pa_abs * hub_pa_abs)
            if abs(hub_pa_abs * hub_pa_abs - p * p) <= self._tube.crossing_pa2:
                self.pressure = p
                return p
        links = [(self._tube_link, hub_pa_abs)]
        if self._leak is not None:
            links.append(self._leak)
        low, high = min(self._low, hub_pa_abs), max(self._high, hub_pa_abs)
        guess = min(max(self.pressure, low), high)
        self.pressure = solve_pressure(leaf.content, leaf.capacity, leaf.growth, links, dt, (guess, low, high))
        return self.pressure
