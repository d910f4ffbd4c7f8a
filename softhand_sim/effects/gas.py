"""Gas dynamics: pressure is made by valves that fill and vent chambers, instead of being the set value at once."""

from dataclasses import dataclass, field

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects.kind import ActsOn
from softhand_sim.elements import FINGERS_OF_ELEMENT
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.pneumatics.tube import Tubing

ACTS_ON = ActsOn.FLOW


@dataclass(frozen=True, kw_only=True)
class GasDynamics:
    """Valves, tubes and supply of every element; see `Element` for ranges and sources.

    Attributes
    ----------
    inlet, outlet
        Open valves.
    tubing
        Tubes, whose volume fills with the chambers.
    supply_pa_abs, ambient_pa_abs
        Regulated supply and ambient [Pa abs].
    """

    inlet: Orifice = field(default_factory=Orifice)
    outlet: Orifice = field(default_factory=Orifice)
    tubing: Tubing = field(default_factory=Tubing)
    supply_pa_abs: float = 250e3
    ambient_pa_abs: float = AMBIENT_PA_ABS

    def __post_init__(self) -> None:
        self._element(1, 0.0, resists=False, heat=None)  # checks the ranges

    def elements(
        self, calibration: FingerCalibration, *, resists: bool, heat: Polytropic | None
    ) -> tuple[Element, ...]:
        """Return the gas balance of each element, with tubes that resist or not, and heat of compression or not."""
        bulging = calibration.chamber.bulging_m3_per_pa
        return tuple(self._element(n, n * bulging, resists=resists, heat=heat) for n in map(len, FINGERS_OF_ELEMENT))

    def _element(self, fingers: int, compliance: float, *, resists: bool, heat: Polytropic | None) -> Element:
        return Element(
            inlet=self.inlet,
            outlet=self.outlet,
            dead_volume_m3=self.tubing.volume_m3(fingers),
            compliance_m3_per_pa=compliance,
            supply_pa_abs=self.supply_pa_abs,
            ambient_pa_abs=self.ambient_pa_abs,
            tubing=self.tubing if resists else None,
            thermal=heat,
        )
