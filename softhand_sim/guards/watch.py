"""Watches a running trial once a control tick and keeps the last state from which it can be repeated."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.grasp.record import Recorder
from softhand_sim.guards import checkpoint
from softhand_sim.guards.limits import Alarm, Guards
from softhand_sim.guards.sentry import Sentry
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]

CHECKPOINT_TICKS = 50
"""Choice: a repeat starts at most a second before the alarm; a checkpoint costs about a hundredth of a second's run."""
_RANGE_TICKS = 10
"""Choice: extremes stay, so what passed a limit in between is not missed."""


@dataclass(kw_only=True)
class Watch:
    """The guards of one trial; `look` after every tick, `keep` before every command.

    Attributes
    ----------
    alarm: the first guard that fired.
    state: the last checkpoint, named arrays.
    driven: wrist's references of each step since then, if a phase drives the wrist itself.
    """

    simulation: HandSimulation
    recorder: Recorder
    limits: Guards
    alarm: Alarm | None = None
    state: dict[str, Vector] = field(default_factory=dict)
    driven: list[Vector] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._sentry = Sentry(simulation=self.simulation, object_body=self.recorder.object_body, limits=self.limits)
        self._ticks = 0
        self.keep()

    def keep(self) -> None:
        """Take a checkpoint: commands have just been given, or a second has passed."""
        self._sentry.book.notice_push()
        book = {f"book_{name}": value for name, value in self._sentry.book.state().items()}
        self.state = {**checkpoint.take(self.simulation), **book, "ticks": np.array([self._ticks])}
        self._kept_at, self.driven = self._ticks, []

    def resume(self, state: Mapping[str, Vector]) -> None:
        """Go back to a checkpoint."""
        checkpoint.restore(self.simulation, state)
        self._sentry.book.notice_push()
        self._sentry.book.restore({name[5:]: value for name, value in state.items() if name.startswith("book_")})
        self._ticks = self._kept_at = int(state["ticks"][0])

    def look(self) -> Alarm | None:
        """Return the alarm if a guard fires now; the trial is to end then."""
        self._ticks += 1
        deepest_m = max(self.recorder.deepest_m, self.recorder.finger_deepest_m)
        self.alarm = self._sentry.look(deepest_m, range_too=self._ticks % _RANGE_TICKS == 0)
        if self.alarm is None and self._ticks - self._kept_at >= CHECKPOINT_TICKS:
            self.keep()
        return self.alarm
