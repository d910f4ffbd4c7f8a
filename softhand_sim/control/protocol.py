"""What a pressure controller has to offer."""

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from softhand_sim.elements import ELEMENTS


class ValveCommand(NamedTuple):
    """Positions of one element's two valves until the next control tick."""

    inlet_open: bool = False
    outlet_open: bool = False


ControllerState = tuple[float, ...]
"""A controller's memory: a fixed number of finite floats, so that any controller can be saved and restored."""


class Controller(Protocol):
    """A law from sensor readings and set pressures to valve positions, evaluated once a control tick."""

    def reset(self) -> ControllerState:
        """Return the memory before the first tick; its length never changes afterwards."""
        ...

    def command(
        self, readings_pa_abs: Sequence[float], set_pa_gauge: Sequence[float], state: ControllerState
    ) -> tuple[tuple[ValveCommand, ...], ControllerState]:
        """Return the valve positions and the new memory.

        Parameters
        ----------
        readings_pa_abs
            Sensor readings [Pa abs], one per element, (3,).
        set_pa_gauge
            Set pressures [Pa gauge], one per element, (3,).
        state
            The memory that the last tick (or ``reset``) returned.
        """
        ...


Answer = tuple[tuple[ValveCommand, ...], ControllerState]


def checked_answer(controller: str, answer: Answer, memory: int) -> Answer:
    """Return a controller's answer if it is what the protocol promises.

    Parameters
    ----------
    controller
        Name for the message.
    answer
        What ``command`` returned.
    memory
        Length of the controller's memory.

    Raises
    ------
    ValueError
        If a valve position is not True or False (NaN would count as open), their number is wrong, or the memory
        has changed its length or holds a NaN or an infinity.
    """
    commands, state = answer
    if len(commands) != len(ELEMENTS):
        raise ValueError(f"{controller}: commands for {len(commands)} elements, must be {len(ELEMENTS)}")
    for element, command in zip(ELEMENTS, commands, strict=True):
        for name, value in zip(ValveCommand._fields, command, strict=True):
            # a NumPy bool is one too
            if value is not True and value is not False and not isinstance(value, np.bool_):
                raise ValueError(f"{controller}: {name} of {element} = {value!r}, must be True or False")
    if len(state) != memory or not all(map(math.isfinite, state)):
        raise ValueError(f"{controller}: memory = {state!r}, must be {memory} finite numbers")
    return commands, state
