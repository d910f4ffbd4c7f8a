"""What is measured while a trial runs: the object's path in the hand, the deepest contact, the peak pressures."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from softhand_sim.grasp.verdict import creep_rate_m_per_s
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]


@dataclass(kw_only=True)
class Recorder:
    """Samples a running trial; grows with it."""

    object_body: int
    object_geoms: npt.NDArray[np.bool_]
    rest_height_m: float
    deepest_m: float = 0.0
    highest_lift_m: float = 0.0
    peak_pressure_pa_gauge: Vector = field(default_factory=lambda: np.zeros(3))
    lift_start: tuple[Vector, Vector] | None = None
    hold_time_s: list[float] = field(default_factory=list)
    hold_position_m: list[Vector] = field(default_factory=list)

    @classmethod
    def of(cls, simulation: HandSimulation, rest_height_m: float) -> "Recorder":
        """Watch the body called ``object``."""
        body = int(simulation.model.body("object").id)
        geoms = np.asarray(simulation.model.geom_bodyid == body)
        return cls(object_body=body, object_geoms=geoms, rest_height_m=rest_height_m)

    def sample(self, simulation: HandSimulation) -> None:
        """Take one sample: contacts of the object, its height, the pressures."""
        data = simulation.data
        if data.ncon:
            touching = self.object_geoms[data.contact.geom].any(axis=1)
            if touching.any():
                self.deepest_m = max(self.deepest_m, -float(data.contact.dist[touching].min()))
        self.highest_lift_m = max(self.highest_lift_m, self.lift_m(simulation))
        np.maximum(self.peak_pressure_pa_gauge, simulation.pressure_pa_gauge(), out=self.peak_pressure_pa_gauge)

    def lift_m(self, simulation: HandSimulation) -> float:
        """Height (m) that the object has gained over its rest on the table."""
        return float(simulation.data.xpos[self.object_body, 2]) - self.rest_height_m

    def mark_lift_start(self, simulation: HandSimulation) -> None:
        """Take the object's present pose in the hand as what slip and tilt are measured from."""
        self.lift_start = simulation.in_palm_frame(self.object_body)

    def sample_hold(self, simulation: HandSimulation) -> None:
        """Take one sample of the object's path in the hand during the hold."""
        self.hold_time_s.append(float(simulation.data.time))
        self.hold_position_m.append(simulation.in_palm_frame(self.object_body)[0])

    def slip_and_tilt(self, simulation: HandSimulation) -> tuple[float, float]:
        """Displacement (m) and turn (rad) of the object in the palm's frame since the lift began."""
        if self.lift_start is None:
            return 0.0, 0.0
        position, rotation = simulation.in_palm_frame(self.object_body)
        turn = Rotation.from_matrix(self.lift_start[1].T @ rotation).magnitude()
        return float(np.linalg.norm(position - self.lift_start[0])), float(turn)

    def creep_m_per_s(self) -> float:
        """Drift (m/s) over the second half of the hold, when the fingers have come to rest."""
        half = len(self.hold_time_s) // 2
        if len(self.hold_time_s) - half < 2:
            return 0.0
        return creep_rate_m_per_s(np.array(self.hold_time_s[half:]), np.array(self.hold_position_m[half:]))
