"""The guards of an environment's episodes: what ends one whose simulation can't be trusted."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from envs.world import World
from softhand_sim.guards.limits import Alarm, AlarmKind, Guards
from softhand_sim.guards.sentry import Sentry

Vector = npt.NDArray[np.float64]

LOOK_S = 0.04
"""Choice: how long the guards may look away, two ticks of the controller. Over 80 ms the energy book's rule takes 3 mJ,
which a wrist gains that starts to move, for energy from nowhere; over 40 ms no more than over 20."""


class Guarding:
    """The guards of one episode at a time, and the first alarm of it; without limits there is none.

    Parameters
    ----------
    limits
        What a simulation may not pass; None: it may do anything but diverge, which the episode notices itself.
    """

    def __init__(self, limits: Guards | None) -> None:
        self._limits = limits
        self._sentry: Sentry | None = None
        self.alarm: Alarm | None = None

    @property
    def diverged(self) -> bool:
        """Whether that was the alarm."""
        return self.alarm is not None and self.alarm.kind is AlarmKind.DIVERGED

    def begin(self, world: World, alarm: Alarm | None = None, book: Mapping[str, Vector] | None = None) -> None:
        """Watch a world from its present state on; a saved episode goes on with its alarm and energy book."""
        self.alarm, self._sentry = alarm, None
        if self._limits is not None:
            self._sentry = Sentry(simulation=world.simulation, object_body=world.body, limits=self._limits)
            if book:
                self._sentry.book.restore(book)

    def look(self, world: World, *, range_too: bool) -> None:
        """Ask the guards, until the first alarm; for what is beyond the calibrated range only if anything is."""
        sentry = self._sentry
        if sentry is None or self.alarm is not None:
            return
        limit = sentry.limits.penetration_m
        deepest_m = 0.0 if limit is None else world.contacts.deeper_m(world.simulation.data, limit)
        self.alarm = sentry.look(deepest_m, range_too=range_too)

    def book(self) -> dict[str, Vector]:
        """Return the energy book, to go on with; empty without guards."""
        return {} if self._sentry is None else self._sentry.book.state()

    def told(self, *, diverged: bool) -> dict[str, str]:
        """Return what an info says: the outcome that the first alarm means, and the alarm in a line; else empty."""
        if self.alarm is None:
            return {"outcome": AlarmKind.DIVERGED.value if diverged else "", "alarm": ""}
        return {"outcome": self.alarm.kind.value, "alarm": self.alarm.text()}
