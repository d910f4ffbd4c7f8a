"""Gas of one element with tubes that resist, leaks, or heat of compression: a manifold and its fingers' chambers.

The same implicit balance as `Element`, for a star of vessels: given the manifold's pressure each chamber has one root,
and the manifold's own balance, into which the chambers enter as links, stays monotone. So there is one solution, every
pressure is positive, and at any step it lies between the pressures before the step and those of the open reservoirs.
Masses are updated by the flows at that solution: what leaves one vessel enters another, to rounding.
"""

from collections.abc import Sequence
from typing import NamedTuple

from softhand_sim.pneumatics.balance import Link, solve_pressure
from softhand_sim.pneumatics.branch import Branch
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.tube import Tube
from softhand_sim.pneumatics.vessel import Vessel


class ElementGas(NamedTuple):
    """Gas of one element: manifold, then its fingers' chambers if the tubes resist.

    ``invariant`` is that of `Polytropic`, None in each place if the element is isothermal.
    """

    mass_kg: tuple[float, ...]
    invariant: tuple[float | None, ...]
    pressure_pa_abs: tuple[float, ...]


class Outside(NamedTuple):
    """What an element is connected to over a step: valves, supply pressure [Pa abs], a leak per finger or ()."""

    inlet_open: bool
    outlet_open: bool
    supply_pa_abs: float
    leaks: tuple[Orifice | None, ...]


def vessel_shapes(element: Element, volumes_m3: Sequence[float]) -> list[tuple[float, float]]:
    """Return volume at no pressure [m3] and growth with it [m3/Pa] of each vessel at the chambers' volumes."""
    bulging, ambient = element.compliance_m3_per_pa, element.ambient_pa_abs
    if element.tubing is None:
        return [(sum(volumes_m3) + element.dead_volume_m3 - bulging * ambient, bulging)]
    n, half = len(volumes_m3), element.tubing.half_finger_m3()
    shapes = [(element.dead_volume_m3 - n * half, 0.0)]
    return shapes + [(volume + half - bulging / n * ambient, bulging / n) for volume in volumes_m3]


def vessels(element: Element, gas: ElementGas, volumes_m3: Sequence[float]) -> list[Vessel]:
    """Return the element's vessels at the chambers' volumes [m3], one of each finger."""
    shapes = vessel_shapes(element, volumes_m3)
    return [Vessel(element, *each) for each in zip(gas.mass_kg, gas.invariant, shapes, strict=True)]


def gas_at(element: Element, volumes_m3: Sequence[float], pressure_pa_abs: float) -> ElementGas:
    """Return the gas at room temperature that fills an element at one pressure [Pa abs]."""
    count = 1 if element.tubing is None else 1 + len(volumes_m3)
    blank = ElementGas((1.0,) * count, (None,) * count, ())
    masses: list[float] = []
    invariants: list[float | None] = []
    for v in vessels(element, blank, volumes_m3):
        masses.append(pressure_pa_abs * (v.stiff + v.compliance * pressure_pa_abs) / v.rt)
        warm = element.thermal
        invariants.append(None if warm is None else warm.invariant(pressure_pa_abs, v.stiff, v.compliance))
    return ElementGas(tuple(masses), tuple(invariants), (pressure_pa_abs,) * count)


def advance(
    element: Element, tube: Tube | None, gas: ElementGas, volumes_m3: Sequence[float], outside: Outside, dt: float
) -> tuple[ElementGas, float]:
    """Return the gas after ``dt`` [s] and the mass [kg] that it drew from the supply.

    Parameters
    ----------
    element
        Parameters.
    tube
        Resistance from the manifold to each finger (`Tubing.branch`), None exactly if ``element.tubing`` is.
    gas
        Gas before the step.
    volumes_m3
        Chamber volume of each of the element's fingers at the step's end [m3].
    outside
        Valves, supply and leaks.
    dt
        Step [s].
    """
    hub, *leaves = vessels(element, gas, volumes_m3)
    ambient = element.ambient_pa_abs
    links: list[tuple[Link, float]] = []
    bounds = [hub.pressure]
    if outside.inlet_open:
        links.append((hub.through(element.inlet), outside.supply_pa_abs))
        bounds.append(outside.supply_pa_abs)
    if outside.outlet_open:
        links.append((hub.through(element.outlet), ambient))
        bounds.append(ambient)
    branches: list[Branch] = []
    if tube is None:
        for hole in outside.leaks:
            if hole is not None:
                links.append((hub.through(hole), ambient))
                bounds.append(ambient)
    else:
        holes = outside.leaks or (None,) * len(leaves)
        for leaf, hole in zip(leaves, holes, strict=True):
            leak = None if hole is None else (leaf.through(hole), ambient)
            branches.append(Branch(leaf, tube, hub, leak, dt))
            links.append((branches[-1], 0.0))
            bounds += branches[-1].range_pa_abs
    p = hub.pressure
    if links:
        p = solve_pressure(hub.content, hub.capacity, hub.growth, links, dt, (p, min(bounds), max(bounds)))
    flows = [link.mass_flow_kg_per_s(reservoir, p) for link, reservoir in links]
    ends = [hub.settled(p, hub.mass + dt * sum(flows), dt)]
    for branch, flow in zip(branches, flows[len(flows) - len(branches) :], strict=True):
        ends.append(branch.end(flow))
    masses, invariants, pressures = zip(*ends, strict=True)
    drawn = dt * flows[0] if outside.inlet_open else 0.0
    return ElementGas(masses, invariants, pressures), drawn
