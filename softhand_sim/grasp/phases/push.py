"""Push: a constant force on the object's mass centre."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from softhand_sim.checks import require_in
from softhand_sim.grasp.stage import Stage, unit_vector


@dataclass(frozen=True, kw_only=True)
class Push:
    """Push the object along one of the world's axes with its mass times an acceleration, then rest.

    Attributes
    ----------
    x, y, z: direction; made a unit vector.
    acceleration_m_per_s2, duration_s: DexGraspBench takes 10 m/s2 for 2 s (issue of the grasp benchmark).
    weightless: cancel the object's weight while pushing and after.
    """

    acceleration_m_per_s2: float
    duration_s: float
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    weightless: bool = False
    needs_object: bool = True

    def __post_init__(self) -> None:
        require_in("acceleration_m_per_s2", self.acceleration_m_per_s2, 0.0, 1000.0)
        require_in("duration_s", self.duration_s, 0.02, 100.0)
        unit_vector(self.x, self.y, self.z)

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Push, let go, rest."""
        direction = unit_vector(self.x, self.y, self.z)
        lift = -stage.gravity_m_per_s2 if self.weightless else np.zeros(3)
        stage.press(stage.mass_kg * (lift + self.acceleration_m_per_s2 * direction))
        yield stage.after(self.duration_s)
        stage.press(stage.mass_kg * lift)
        yield stage.after(stage.settle_s)


KINDS = {"push": Push}
