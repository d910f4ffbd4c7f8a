"""Watches a running trial once a control tick and keeps the last state from which it can be repeated."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.grasp.record import Recorder
from softhand_sim.guards import checkpoint
from softhand_sim.guards.energy import EnergyBook
from softhand_sim.guards.limits import Alarm, AlarmKind, Guards
from softhand_sim.simulation import INSTABILITY, HandSimulation

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
        simulation = self.simulation
        self._book = EnergyBook(simulation.model, simulation.data, self.recorder.object_body)
        self._ticks = 0
        # a view of the engine's memory
        self._warnings = simulation.data.warning.number
        self._no_warnings = bytes(self._warnings.nbytes)
        self.keep()

    def keep(self) -> None:
        """Take a checkpoint: commands have just been given, or a second has passed."""
        self._book.notice_push()
        book = {f"book_{name}": value for name, value in self._book.state().items()}
        self.state = {**checkpoint.take(self.simulation), **book, "ticks": np.array([self._ticks])}
        self._kept_at, self.driven = self._ticks, []

    def resume(self, state: Mapping[str, Vector]) -> None:
        """Go back to a checkpoint."""
        checkpoint.restore(self.simulation, state)
        self._book.notice_push()
        self._book.restore({name[5:]: value for name, value in state.items() if name.startswith("book_")})
        self._ticks = self._kept_at = int(state["ticks"][0])

    def look(self) -> Alarm | None:
        """Return the alarm if a guard fires now; the trial is to end then."""
        self._ticks += 1
        self.alarm = self._diverged() or self._unbalanced() or self._penetrated() or self._extrapolated()
        if self.alarm is None and self._ticks - self._kept_at >= CHECKPOINT_TICKS:
            self.keep()
        return self.alarm

    def _diverged(self) -> Alarm | None:
        """Ask the simulation where the engine warned of something, or where no energy book would notice a NaN."""
        quiet = self._warnings.tobytes() == self._no_warnings
        if (quiet and self.limits.energy_j is not None) or not self.simulation.diverged:
            return None
        number = float(sum(self._warnings[kind] for kind in INSTABILITY))
        return self._raise(AlarmKind.DIVERGED, "warnings_of_instability", number, 0.0)

    def _unbalanced(self) -> Alarm | None:
        limit = self.limits.energy_j
        if limit is None:
            return None
        excess = self._book.look()
        if excess <= limit:
            return None
        if not math.isfinite(excess):
            return self._raise(AlarmKind.DIVERGED, "energy_not_finite", 0.0, 0.0)
        return self._raise(AlarmKind.UNBALANCED, "energy_excess_j", excess, limit)

    def _penetrated(self) -> Alarm | None:
        limit = self.limits.penetration_m
        if limit is None:
            return None
        recorder = self.recorder
        depth = max(recorder.deepest_m, recorder.finger_deepest_m)
        return self._raise(AlarmKind.PENETRATED, "penetration_m", depth, limit) if depth > limit else None

    def _extrapolated(self) -> Alarm | None:
        if self._ticks % _RANGE_TICKS:
            return None
        found = zip(("past_pressure_pa", "past_stop_rad"), self.simulation.range_watch.farthest(), strict=True)
        for name, figure in found:
            limit = getattr(self.limits, name)
            if limit is not None and figure > limit:
                return self._raise(AlarmKind.EXTRAPOLATED, name, figure, limit)
        return None

    def _raise(self, kind: AlarmKind, quantity: str, figure: float, limit: float) -> Alarm:
        return Alarm(kind=kind, quantity=quantity, figure=figure, limit=limit, time_s=float(self.simulation.data.time))
