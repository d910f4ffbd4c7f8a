"""Where an effect acts, and what leaving it out would change."""

from dataclasses import dataclass
from enum import StrEnum


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
    reason
        In words.
    """

    own_deg: float
    redraws: bool
    reason: str
