"""Asks a running world whether it can still be trusted; whoever steps it asks once a control tick or two."""

import math
from dataclasses import dataclass

from softhand_sim.guards.energy import EnergyBook
from softhand_sim.guards.limits import Alarm, AlarmKind, Guards
from softhand_sim.simulation import INSTABILITY, MEMORY_FULL, HandSimulation


@dataclass(kw_only=True)
class Sentry:
    """The guards of one world from its present state on; mutable on purpose: it keeps an energy book.

    Attributes
    ----------
    simulation: the world.
    object_body: number of the body that external forces may act on.
    limits: what may not be passed.
    """

    simulation: HandSimulation
    object_body: int
    limits: Guards

    def __post_init__(self) -> None:
        simulation = self.simulation
        self.book = EnergyBook(simulation.model, simulation.data, self.object_body)
        # a view of the engine's memory
        self._warnings = simulation.data.warning.number
        self._no_warnings = bytes(self._warnings.nbytes)

    def look(self, deepest_m: float, *, range_too: bool = True) -> Alarm | None:
        """Return the alarm if a guard fires now.

        Parameters
        ----------
        deepest_m: the deepest contact that counts (`Guards.penetration_m`), now or so far.
        range_too: whether to ask for pressures and joints beyond their range; their extremes stay till the next look.
        """
        alarm = self._diverged() or self._unbalanced() or self._penetrated(deepest_m)
        return self._extrapolated() if alarm is None and range_too else alarm

    def _diverged(self) -> Alarm | None:
        """Ask the simulation where the engine warned of something, or where no energy book would notice a NaN."""
        quiet = self._warnings.tobytes() == self._no_warnings
        if (quiet and self.limits.energy_j is not None) or not self.simulation.diverged:
            return None
        full = float(sum(self._warnings[kind] for kind in MEMORY_FULL))
        if full:
            return self._raise(AlarmKind.DIVERGED, "warnings_of_full_memory", full, 0.0)
        number = float(sum(self._warnings[kind] for kind in INSTABILITY))
        return self._raise(AlarmKind.DIVERGED, "warnings_of_instability", number, 0.0)

    def _unbalanced(self) -> Alarm | None:
        limit = self.limits.energy_j
        if limit is None:
            return None
        excess = self.book.look()
        if excess <= limit:
            return None
        if not math.isfinite(excess):
            return self._raise(AlarmKind.DIVERGED, "energy_not_finite", 0.0, 0.0)
        return self._raise(AlarmKind.UNBALANCED, "energy_excess_j", excess, limit)

    def _penetrated(self, deepest_m: float) -> Alarm | None:
        limit = self.limits.penetration_m
        if limit is None or deepest_m <= limit:
            return None
        return self._raise(AlarmKind.PENETRATED, "penetration_m", deepest_m, limit)

    def _extrapolated(self) -> Alarm | None:
        found = zip(("past_pressure_pa", "past_stop_rad"), self.simulation.range_watch.farthest(), strict=True)
        for name, figure in found:
            limit = getattr(self.limits, name)
            if limit is not None and figure > limit:
                return self._raise(AlarmKind.EXTRAPOLATED, name, figure, limit)
        return None

    def _raise(self, kind: AlarmKind, quantity: str, figure: float, limit: float) -> Alarm:
        return Alarm(kind=kind, quantity=quantity, figure=figure, limit=limit, time_s=float(self.simulation.data.time))
