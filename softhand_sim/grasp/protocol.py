"""What a trial does: approach and close, then phases; where the object lies; what counts as held. All plain values."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.checks import require_in
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.stage import Phase
from softhand_sim.grasp.verdict import Thresholds


@dataclass(frozen=True, kw_only=True)
class Offsets:
    """Where the object lies beside the place and turn that the hand expects.

    Attributes
    ----------
    position_m, yaw_rad: largest displacement along x and along y, and largest turn about the vertical; drawn evenly.
    stated_m: displacements x, y taken one after the other by the trial's seed, before what is drawn is added.
    """

    position_m: float = 0.0
    yaw_rad: float = 0.0
    stated_m: tuple[tuple[float, float], ...] = ((0.0, 0.0),)

    def __post_init__(self) -> None:
        require_in("position_m", self.position_m, 0.0, 0.1)
        require_in("yaw_rad", self.yaw_rad, 0.0, np.pi)
        if not self.stated_m:
            raise ValueError("stated_m is empty, needs at least one pair x, y")
        for pair in self.stated_m:
            if len(pair) != 2:
                raise ValueError(f"stated_m: {pair} must be a pair x, y")
            for value in pair:
                require_in("stated_m", value, -0.1, 0.1)

    def draw(self, rng: np.random.Generator, seed: int) -> tuple[float, float, float]:
        """Draw the object's displacement x, y (m) and turn about the vertical (rad) of the trial of a seed."""
        x, y = rng.uniform(-self.position_m, self.position_m, size=2)
        yaw = float(rng.uniform(-self.yaw_rad, self.yaw_rad))
        stated_x, stated_y = self.stated_m[seed % len(self.stated_m)]
        return float(x) + stated_x, float(y) + stated_y, yaw


@dataclass(frozen=True, kw_only=True)
class GraspProtocol:
    """A trial's plan; the shipped ones are files in `assets/protocols`, see `softhand_sim.grasp.protocol_file`.

    Attributes
    ----------
    name, source: `source` says where the values come from.
    phases: what happens after the fingers have closed, in order.
    approach_m: distance from the grasp pose at which the hand starts.
    close_s: time given to the valves to fill the fingers.
    settle_s: rest after each move, so that slip is measured from a standing hand.
    offsets: of the object from where the hand expects it.
    thresholds: between outcomes.
    mass_kg, friction: of every object, where the protocol prescribes them.
    closing_pressure_pa_gauge: of every finger; without it, that of the grasp's set angles.
    """

    name: str
    source: str
    phases: tuple[Phase, ...]
    approach_m: float
    close_s: float
    settle_s: float
    offsets: Offsets = field(default_factory=Offsets)
    thresholds: Thresholds = field(default_factory=Thresholds)
    mass_kg: float | None = None
    friction: float | None = None
    closing_pressure_pa_gauge: float | None = None

    def __post_init__(self) -> None:
        if not self.source.strip():
            raise ValueError("source is empty: say where the values come from")
        for name in ("approach_m", "close_s"):
            if not 0.0 < getattr(self, name) < 100.0:
                raise ValueError(f"{name}: {getattr(self, name)} must lie in (0, 100)")
        require_in("settle_s", self.settle_s, 0.0, 10.0)
        if self.closing_pressure_pa_gauge is not None:
            require_in("closing_pressure_pa_gauge", self.closing_pressure_pa_gauge, 0.0, 1e6)
        if not any(isinstance(phase, Lift) for phase in self.phases):
            raise ValueError("phase: at least one must be a lift, the verdict rests on it")

    @property
    def lift_m(self) -> float:
        """Height (m) that all lifts together gain."""
        return sum(phase.height_m for phase in self.phases if isinstance(phase, Lift))

    def closing_pressures_pa_gauge(
        self, calibration: FingerCalibration, set_angle_deg: Sequence[float]
    ) -> npt.NDArray[np.float64]:
        """Return the set pressure (Pa gauge) of each element for the set angles (degrees) of a grasp, both (3,)."""
        if self.closing_pressure_pa_gauge is not None:
            return np.full(len(set_angle_deg), self.closing_pressure_pa_gauge)
        return np.array([calibration.closing_pressure(angle) for angle in set_angle_deg])

    def draw_offset(self, rng: np.random.Generator, seed: int = 0) -> tuple[float, float, float]:
        """Draw the object's displacement x, y (m) and turn about the vertical (rad) of the trial of a seed."""
        return self.offsets.draw(rng, seed)
