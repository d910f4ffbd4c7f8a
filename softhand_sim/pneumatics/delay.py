"""Dead time of the solenoid valves."""

import math
from dataclasses import dataclass

from softhand_sim.checks import require_finite
from softhand_sim.control.protocol import ValveCommand

_TIME_TOLERANCE_S = 1e-9  # far below any step


@dataclass(frozen=True, kw_only=True)
class ValveDelay:
    """How long after its command a valve opens or shuts.

    A command that is taken back before the valve has moved leaves it where it is: a pulse shorter than the opening
    delay lets nothing through.

    Attributes
    ----------
    opening_s, closing_s
        Dead times [s]. Choice: 10 ms each, half a control tick; no figure of the CY05820D was found. Equal delays
        shift a pulse, unequal ones change its length.

    Raises
    ------
    ValueError
        If a time is negative, or both are zero (leave the delay out instead).
    """

    opening_s: float = 0.010
    closing_s: float = 0.010

    def __post_init__(self) -> None:
        require_finite("opening_s", self.opening_s, at_least=0.0)
        require_finite("closing_s", self.closing_s, at_least=0.0)
        if self.opening_s == self.closing_s == 0.0:
            raise ValueError("opening_s = closing_s = 0: one must be > 0; leave the delay out for none")

    def request(
        self, valves: tuple[ValveCommand, ...], commands: tuple[ValveCommand, ...], waiting_s: tuple[float, ...]
    ) -> tuple[tuple[ValveCommand, ...], tuple[float, ...]]:
        """Return positions and waiting times after a command: a valve that is to move starts waiting.

        Parameters
        ----------
        valves, commands
            Positions that the valves have and are to take, (3,).
        waiting_s
            Time until a valve moves [s], inlet and outlet of each element in turn, (6,); infinite if it stays.
        """
        waits: list[float] = []
        for k, (now, wanted) in enumerate(zip(valves, commands, strict=True)):
            for j in range(2):
                delay = self.opening_s if wanted[j] else self.closing_s
                waits.append(math.inf if now[j] == wanted[j] else min(waiting_s[2 * k + j], delay))
        return moved(valves, tuple(waits), 0.0)


def moved(
    valves: tuple[ValveCommand, ...], waiting_s: tuple[float, ...], dt: float
) -> tuple[tuple[ValveCommand, ...], tuple[float, ...]]:
    """Return positions and waiting times ``dt`` [s] later; valves whose time has come have moved."""
    waits = [wait - dt for wait in waiting_s]
    if min(waits) > _TIME_TOLERANCE_S:
        return valves, tuple(waits)
    due = [wait <= _TIME_TOLERANCE_S for wait in waits]
    after = tuple(
        ValveCommand(now.inlet_open != due[2 * k], now.outlet_open != due[2 * k + 1]) for k, now in enumerate(valves)
    )
    return after, tuple(math.inf if gone else wait for gone, wait in zip(due, waits, strict=True))
