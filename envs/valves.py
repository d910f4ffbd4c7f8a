"""Bare valves: a controller that passes valve positions on, for policies that switch the valves themselves."""

from collections.abc import Sequence

from softhand_sim.control.protocol import ControllerState, ValveCommand

_POSITIONS = (
    ValveCommand(False, False),
    ValveCommand(True, False),
    ValveCommand(False, True),
    ValveCommand(True, True),
)


class ValveRelay:
    """Takes a code for each element in place of its set pressure: 0 shut, 1 inlet open, 2 outlet open, 3 both.

    So the valves' positions travel, and are saved, where set pressures would be; the relay itself remembers nothing.
    They move at the next control tick, every 20 ms, as under the ON-OFF law.
    """

    def reset(self) -> ControllerState:
        """Return an empty memory."""
        return ()

    def command(
        self, readings_pa_abs: Sequence[float], set_pa_gauge: Sequence[float], state: ControllerState
    ) -> tuple[tuple[ValveCommand, ...], ControllerState]:
        """Return the valve positions that the codes stand for (see ``Controller``)."""
        del readings_pa_abs
        return tuple(_POSITIONS[int(code)] for code in set_pa_gauge), state
