"""One controllable element: finger chambers on one manifold, an inlet from the supply, an outlet."""

import math
from dataclasses import dataclass, field

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.checks import require_finite
from softhand_sim.pneumatics.chamber import Chamber
from softhand_sim.pneumatics.valve import Valve

TUBE_BORE_M = 3e-3
"""Bore of the air tubes [m] (the paper's "air tubes with 3 mm diameter", read as the inner one)."""

SHARED_TUBE_M = 0.5
"""Length of the tube from an element's valves to its manifold [m]. Choice: control board beside the wrist."""

FINGER_TUBE_M = 0.5
"""Length of each finger's own tube from the manifold [m]. Choice: forearm to palm."""

# For accuracy, not stability: parts of at most 4 % of the emptying time constant keep the first-order error
# under 2 %. The default element takes a 20 ms step in one part.
_LARGEST_PART = 0.04
_MOST_PARTS = 10
_TOLERANCE = 1e-12
_MAX_ITERATIONS = 100


def tube_volume_m3(fingers: int) -> float:
    """Return the gas volume [m3] of an element's tubes: one shared, and one for each of its fingers."""
    return math.pi / 4.0 * TUBE_BORE_M**2 * (SHARED_TUBE_M + fingers * FINGER_TUBE_M)


@dataclass(frozen=True, kw_only=True)
class Element:
    """Gas balance of one element: all its chambers and tubes share one pressure.

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

    Raises
    ------
    ValueError
        If the dead volume is negative, or the supply is below ambient.
    """

    inlet: Valve = field(default_factory=Valve)
    outlet: Valve = field(default_factory=Valve)
    dead_volume_m3: float = tube_volume_m3(1)
    compliance_m3_per_pa: float = 0.0
    supply_pa_abs: float = 250e3
    ambient_pa_abs: float = AMBIENT_PA_ABS
    gas: Chamber = field(default_factory=Chamber)
    _rt: float = field(init=False, repr=False, compare=False)
    _fastest: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_finite("dead_volume_m3", self.dead_volume_m3, at_least=0.0)
        require_finite("compliance_m3_per_pa", self.compliance_m3_per_pa, at_least=0.0)
        require_finite("ambient_pa_abs", self.ambient_pa_abs, above=0.0)
        require_finite("supply_pa_abs", self.supply_pa_abs, at_least=self.ambient_pa_abs)
        object.__setattr__(self, "_rt", self.gas.rt_j_per_kg)
        fastest = max(v.choked_coefficient_kg_per_s_pa for v in (self.inlet, self.outlet))
        object.__setattr__(self, "_fastest", fastest)

    def pressure_pa_abs(self, mass_kg: float, volume_m3: float) -> float:
        """Return the manifold's pressure [Pa abs]; ``volume_m3`` is the sum over the element's chambers.

        Root of ``p (V0 + C (p - p_ambient)) = m R T``, written so that no digits cancel.
        """
        stiff, content = self._stiff_volume_m3(volume_m3), mass_kg * self._rt
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
        capacity = (volume_m3 + self.dead_volume_m3) / self._rt
        parts = min(max(math.ceil(dt * self._fastest / (capacity * _LARGEST_PART)), 1), _MOST_PARTS)
        for _ in range(parts):
            p = self._solve(mass_kg, volume_m3, inlet_open, outlet_open, dt / parts)
            mass_kg = self.mass_kg(p, volume_m3)
        return mass_kg

    def _stiff_volume_m3(self, volume_m3: float) -> float:
        """Return the volume that would be left at no pressure at all: V(p) is this and C p."""
        return volume_m3 + self.dead_volume_m3 - self.compliance_m3_per_pa * self.ambient_pa_abs

    def _solve(self, mass: float, volume_m3: float, inlet_open: bool, outlet_open: bool, dt: float) -> float:
        """Return the pressure [Pa abs] at a step's end: Newton, falling back on bisection of the bracket."""
        supply, ambient = self.supply_pa_abs, self.ambient_pa_abs
        capacity, growth = self._stiff_volume_m3(volume_m3) / self._rt, self.compliance_m3_per_pa / self._rt
        p = low = high = self.pressure_pa_abs(mass, volume_m3)
        if inlet_open:
            low, high = min(low, supply), max(high, supply)
        if outlet_open:
            low, high = min(low, ambient), max(high, ambient)
        for _ in range(_MAX_ITERATIONS):
            residual, slope = (capacity + growth * p) * p - mass, capacity + 2.0 * growth * p
            if inlet_open:
                flow, flow_slope = self.inlet.inflow_and_slope(supply, p)
                residual -= dt * flow
                slope -= dt * flow_slope
            if outlet_open:
                flow, flow_slope = self.outlet.inflow_and_slope(ambient, p)
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
