"""One controllable element: finger chambers on one manifold, an inlet from the supply, an outlet."""

import math
from dataclasses import dataclass, field

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.checks import require_finite, require_in
from softhand_sim.pneumatics.balance import Link, solve_pressure
from softhand_sim.pneumatics.chamber import Chamber
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.pneumatics.tube import Tubing, tube_volume_m3

# For accuracy, not stability: parts of at most 4 % of the emptying time constant keep the first-order error
# under 2 %. The default element takes a 20 ms step in one part.
LARGEST_PART = 0.04
_LARGEST_M3, _LARGEST_M3_PER_PA = 1e3, 1e-2
"""Choices: a hall, and what bulges to one at 100 kPa; far beyond, flow is less than the rounding of the gas there."""
MOST_PARTS = 10


@dataclass(frozen=True, kw_only=True)
class Element:
    """Gas balance of one element. Its chambers and tubes share one pressure, unless the tubes resist.

    The methods are those of an isothermal element of one pressure, without leak; `network` has the rest.

    Attributes
    ----------
    inlet, outlet
        Valves from the supply and to ambient.
    dead_volume_m3
        Volume of tubes and manifold [m3], added to the chambers' volume. Default: the tubes of one finger.
    compliance_m3_per_pa
        What the chambers' walls bulge by a pascal above ambient [m3/Pa], beyond the volume that is given.
    supply_pa_abs
        Regulated supply [Pa abs], taken as a reservoir that doesn't droop. Choice: 250 kPa, the sensor's
        full scale.
    ambient_pa_abs
        Ambient [Pa abs].
    gas
        Temperature and gas constant.
    tubing
        Tubes that resist the flow; their volume is part of ``dead_volume_m3``. None: the gas of the element has
        one pressure.
    thermal
        Heat of compression. None: isothermal.

    Raises
    ------
    ValueError
        If the dead volume is negative or beyond 1000 m3, or does not hold the tubes, or the supply is below ambient.
    """

    inlet: Orifice = field(default_factory=Orifice)
    outlet: Orifice = field(default_factory=Orifice)
    dead_volume_m3: float = tube_volume_m3(1)
    compliance_m3_per_pa: float = 0.0
    supply_pa_abs: float = 250e3
    ambient_pa_abs: float = AMBIENT_PA_ABS
    gas: Chamber = field(default_factory=Chamber)
    tubing: Tubing | None = None
    thermal: Polytropic | None = None
    _rt: float = field(init=False, repr=False, compare=False)
    _fastest: float = field(init=False, repr=False, compare=False)
    _bulged: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_in("dead_volume_m3", self.dead_volume_m3, 0.0, _LARGEST_M3)
        require_in("compliance_m3_per_pa", self.compliance_m3_per_pa, 0.0, _LARGEST_M3_PER_PA)
        require_finite("ambient_pa_abs", self.ambient_pa_abs, above=0.0)
        require_finite("supply_pa_abs", self.supply_pa_abs, at_least=self.ambient_pa_abs)
        if self.tubing is not None and self.dead_volume_m3 < self.tubing.volume_m3(1):
            raise ValueError(
                f"dead_volume_m3 = {self.dead_volume_m3!r}: must hold the tubes' {self.tubing.volume_m3(1):g} m3"
            )
        object.__setattr__(self, "_rt", self.gas.rt_j_per_kg)
        object.__setattr__(self, "_bulged", self.compliance_m3_per_pa * self.ambient_pa_abs)
        fastest = max(v.choked_coefficient_kg_per_s_pa for v in (self.inlet, self.outlet))
        object.__setattr__(self, "_fastest", fastest)

    def pressure_pa_abs(self, mass_kg: float, volume_m3: float) -> float:
        """Return the manifold's pressure [Pa abs]; ``volume_m3`` is the sum over the element's chambers.

        Root of ``p (V0 + C (p - p_ambient)) = m R T``, written so that no digits cancel.
        """
        stiff, content = volume_m3 + self.dead_volume_m3 - self._bulged, mass_kg * self._rt
        return 2.0 * content / (stiff + math.sqrt(stiff**2 + 4.0 * self.compliance_m3_per_pa * content))

    def mass_kg(self, pressure_pa_abs: float, volume_m3: float) -> float:
        """Return the mass of gas [kg] at a pressure; ``volume_m3`` is the sum over the element's chambers."""
        volume = self._stiff_volume_m3(volume_m3) + self.compliance_m3_per_pa * pressure_pa_abs
        return pressure_pa_abs * volume / self._rt

    def step(self, mass_kg: float, volume_m3: float, inlet_open: bool, outlet_open: bool, dt: float) -> float:
        """Return the mass of gas [kg] after ``dt`` [s], with the chambers at ``volume_m3`` [m3] at its end.

        Backward Euler on the pressure, ``p V(p) / (R T) = m + dt q(p)``. The left side rises with ``p`` and
        the flow ``q`` falls, so there is exactly one root, and it lies between the pressure without flow
        and those of the reservoirs that are open: stable, positive and free of overshoot at any ``dt``.
        A step that is long for a small chamber or a large valve is taken in up to ten equal parts. With both
        valves shut the mass is returned untouched.

        Raises
        ------
        ValueError
            If the mass, the volume or ``dt`` is not positive (so also for NaN).
        """
        if not (mass_kg > 0.0 and volume_m3 > 0.0 and dt > 0.0):
            raise ValueError(
                f"mass_kg = {mass_kg!r}, volume_m3 = {volume_m3!r}, dt = {dt!r}: each must be a number > 0"
            )
        if not (inlet_open or outlet_open):
            return mass_kg
        parts = self.parts(volume_m3, dt, self._fastest)
        for _ in range(parts):
            p = self._solve(mass_kg, volume_m3, inlet_open, outlet_open, dt / parts)
            mass_kg = self.mass_kg(p, volume_m3)
        return mass_kg

    def parts(self, volume_m3: float, dt: float, fastest_kg_per_s_pa: float) -> int:
        """Return into how many equal parts a step of ``dt`` [s] is cut for accuracy.

        ``fastest_kg_per_s_pa`` is the largest choked coefficient of the orifices in play.
        """
        capacity = (volume_m3 + self.dead_volume_m3) / self._rt
        return min(max(math.ceil(dt * fastest_kg_per_s_pa / (capacity * LARGEST_PART)), 1), MOST_PARTS)

    def _stiff_volume_m3(self, volume_m3: float) -> float:
        """Return the volume that would be left at no pressure at all: V(p) is this and C p."""
        return volume_m3 + self.dead_volume_m3 - self._bulged

    def _solve(self, mass: float, volume_m3: float, inlet_open: bool, outlet_open: bool, dt: float) -> float:
        """Return the pressure [Pa abs] at a step's end."""
        p = low = high = self.pressure_pa_abs(mass, volume_m3)
        links: list[tuple[Link, float]] = []
        if inlet_open:
            links.append((self.inlet, self.supply_pa_abs))
            low, high = min(low, self.supply_pa_abs), max(high, self.supply_pa_abs)
        if outlet_open:
            links.append((self.outlet, self.ambient_pa_abs))
            low, high = min(low, self.ambient_pa_abs), max(high, self.ambient_pa_abs)
        capacity, growth = self._stiff_volume_m3(volume_m3) / self._rt, self.compliance_m3_per_pa / self._rt
        return solve_pressure(mass, capacity, growth, links, dt, (p, low, high))
