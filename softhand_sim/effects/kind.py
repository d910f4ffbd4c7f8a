"""Where an effect acts, and what leaving it out would change."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.relaxation import MaxwellBranch


class ActsOn(StrEnum):
    """The place where an effect enters.

    MODEL: once, when the scene is compiled.
    COMMAND: between the controller's command and the valves, or between the pressure and the controller.
    FLOW: the gas balance; terms that share a vessel are summed there, never chained.
    TORQUE: the fingers' forces, each step.
    """

    MODEL = "model"
    COMMAND = "command"
    FLOW = "flow"
    TORQUE = "torque"


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What leaving one effect out would change.

    Attributes
    ----------
    own_deg
        Largest change of a tip angle that is the effect's own [deg]; infinite if it cannot be told.
    redraws
        Whether leaving it out also makes the controller stop at another place in its band, as any small change does.
    saves
        Whether leaving it out saves time; it stays otherwise, unless it is forced to go.
    reason
        In words.
    """

    own_deg: float
    redraws: bool
    reason: str
    saves: bool = True


class Closing(Protocol):
    """What an effect may ask of a scene: the finger, the hand alone with all its contacts, and the set pressures.

    ``set_pa_gauge`` has one pressure an element [Pa gauge], (3,); ``relaxation`` is what the walls would have.
    """

    @property
    def calibration(self) -> FingerCalibration:
        """The finger."""
        ...

    @property
    def hand(self) -> mujoco.MjModel:
        """The hand alone, compiled."""
        ...

    @property
    def set_pa_gauge(self) -> npt.NDArray[np.float64]:
        """Set pressures of the closing."""
        ...

    @property
    def relaxation(self) -> tuple[MaxwellBranch, ...]:
        """Branches of the walls' relaxation."""
        ...

    def angle_change_deg(self, pressure_pa: float) -> float:
        """Return how far a free tip falls short when pressures do."""
        ...
