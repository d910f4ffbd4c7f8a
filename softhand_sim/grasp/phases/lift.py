"""Lift: straight up at the wrist's speed limit, then rest."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from softhand_sim.checks import require_in
from softhand_sim.grasp.stage import Stage


@dataclass(frozen=True, kw_only=True)
class Lift:
    """Raise the hand by `height_m` at the wrist's speed limit (paper: 100 mm/s)."""

    height_m: float
    needs_object: bool = False

    def __post_init__(self) -> None:
        require_in("height_m", self.height_m, 1e-3, 0.5)

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Move, wait for the wrist, rest."""
        simulation = stage.simulation
        simulation.wrist_target = simulation.wrist_target + np.array([0, 0, self.height_m, 0, 0, 0])
        yield stage.arrived
        yield stage.after(stage.settle_s)


KINDS = {"lift": Lift}
