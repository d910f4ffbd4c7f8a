"""What a pressure controller has to offer."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol


class ValveCommand(NamedTuple):
    """Positions of one element's two valves until the next control tick."""

    inlet_open: bool = False
    outlet_open: bool = False


ControllerState = tuple[float, ...]
"""A controller's memory: a fixed number of floats, so that any controller can be saved and restored."""


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
