"""Where an effect acts."""

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
