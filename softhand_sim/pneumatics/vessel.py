"""One vessel of an element's network during one step, and the heat that flows with the gas."""

import math
from collections.abc import Iterable

from softhand_sim.pneumatics.balance import Link
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.thermal import Polytropic


def positive_root(a: float, b: float, c: float) -> float:
    """Return the positive root of ``a x^2 + b x = c`` for ``a >= 0``, ``c > 0``, so that no digits cancel."""
    return 2.0 * c / (b + math.sqrt(b * b + 4.0 * a * c))


class Vessel:
    """One vessel during one step: its balance as `solve_pressure` wants it."""

    __slots__ = ("capacity", "compliance", "content", "growth", "mass", "pressure", "rt", "stiff", "thermal", "warmth")

    def __init__(self, element: Element, mass_kg: float, invariant: float | None, shape: tuple[float, float]) -> None:
        """Take the gas before the step, and ``stiff + compliance p`` [m3], [m3/Pa], the volume at its end."""
        rt, thermal = element.gas.rt_j_per_kg, element.thermal
        self.mass, self.rt, self.thermal = mass_kg, rt, thermal
        self.stiff, self.compliance = shape
        if thermal is None or invariant is None:
            self.pressure = positive_root(self.compliance, self.stiff, mass_kg * rt)
            self.capacity, self.growth, self.content = self.stiff / rt, self.compliance / rt, mass_kg
            self.warmth = 1.0
        else:
            # d(pV) + (n - 1) p dV = n R T dm, with dV = C dp at a given shape, over n R T_0
            p, n = thermal.pressure_pa_abs(invariant, self.stiff, self.compliance), thermal.exponent
            self.pressure = p
            self.capacity, self.growth = self.stiff / (n * rt), 0.5 * (n + 1.0) * self.compliance / (n * rt)
            self.content = (self.capacity + self.growth * p) * p
            self.warmth = p * (self.stiff + self.compliance * p) / (mass_kg * rt)

    def through(self, orifice: Orifice) -> Link:
        """Return the link of an orifice to a reservoir at room temperature."""
        return orifice if self.thermal is None else Warmed(orifice, 1.0, self.warmth, 0.5)

    def settled(self, pressure_pa_abs: float, mass_kg: float, dt: float) -> tuple[float, float | None, float]:
        """Return mass [kg], invariant and pressure [Pa abs] at the step's end, after the wall took its heat."""
        if self.thermal is None:
            return mass_kg, None, positive_root(self.compliance, self.stiff, mass_kg * self.rt)
        return _cooled(self, self.thermal, pressure_pa_abs, mass_kg, dt)


def require_gas(masses_kg: Iterable[float], dt: float) -> None:
    """Raise a ValueError if any mass after a step of ``dt`` [s] is not positive.

    Gas that leaves has the temperature of the step's start: where many times a vessel's content flows through in a part
    of a step, as with both valves of a thousand times the usual size open, more may leave than came.
    """
    if not all(mass > 0.0 for mass in masses_kg):
        raise ValueError(
            f"dt = {dt!r}: many times an element's gas flows through it; must be shorter, or valves smaller"
        )


def _cooled(
    vessel: Vessel, thermal: Polytropic, pressure_pa_abs: float, mass_kg: float, dt: float
) -> tuple[float, float, float]:
    require_gas((mass_kg,), dt)
    cold = mass_kg * vessel.rt
    excess = pressure_pa_abs * (vessel.stiff + vessel.compliance * pressure_pa_abs) - cold
    p = positive_root(vessel.compliance, vessel.stiff, cold + excess * thermal.kept_share(dt))
    return mass_kg, thermal.invariant(p, vessel.stiff, vessel.compliance), p


class Warmed:
    """A link whose gas has the temperature of where it comes from: weighs flow by heat."""

    __slots__ = ("_inside", "_link", "_outside", "_thinning")

    def __init__(self, link: Link, outside: float, inside: float, thinning: float) -> None:
        """Take temperatures over ``T_0`` and the power of them by which the mass flow falls."""
        self._link, self._outside, self._inside, self._thinning = link, outside, inside, thinning

    def inflow_and_slope(self, reservoir_pa_abs: float, chamber_pa_abs: float) -> tuple[float, float]:
        """Return heat flow and slope, in terms of gas at ``T_0`` [kg/s], [kg/(s Pa)]."""
        flow, slope = self._link.inflow_and_slope(reservoir_pa_abs, chamber_pa_abs)
        weight = (self._outside if flow > 0.0 else self._inside) ** (1.0 - self._thinning)
        return weight * flow, weight * slope

    def mass_flow_kg_per_s(self, from_pa_abs: float, to_pa_abs: float) -> float:
        """Return the mass flow [kg/s] into the vessel."""
        flow = self._link.mass_flow_kg_per_s(from_pa_abs, to_pa_abs)
        return flow / float((self._outside if flow > 0.0 else self._inside) ** self._thinning)
