"""Turn: the wrist turns about a horizontal or the vertical axis."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from softhand_sim.checks import require_in
from softhand_sim.grasp.stage import Stage


@dataclass(frozen=True, kw_only=True)
class Turn:
    """Turn the wrist by `yaw_rad` about the vertical and by `pitch_rad` about the horizontal axis across it, then rest.

    Runs at the wrist's turning limit.
    """

    yaw_rad: float = 0.0
    pitch_rad: float = 0.0
    needs_object: bool = True

    def __post_init__(self) -> None:
        for name in ("yaw_rad", "pitch_rad"):
            require_in(name, getattr(self, name), -np.pi, np.pi)

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Turn, wait for the wrist, rest."""
        simulation = stage.simulation
        simulation.wrist_target = simulation.wrist_target + np.array([0, 0, 0, self.yaw_rad, self.pitch_rad, 0])
        yield stage.arrived
        yield stage.after(stage.settle_s)


KINDS = {"turn": Turn}
