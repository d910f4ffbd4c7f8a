"""What is measured while a trial runs: the object's path in the hand, contacts and forces, the peak pressures."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from softhand_sim.grasp.contacts import PALM, ContactMap
from softhand_sim.grasp.verdict import creep_rate_m_per_s
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]


@dataclass(kw_only=True)
class Recorder:
    """Samples a running trial; grows with it."""

    object_body: int
    rest_height_m: float
    contacts: ContactMap
    deepest_m: float = 0.0
    lifted_deepest_m: float = 0.0
    highest_lift_m: float = 0.0
    peak_pressure_pa_gauge: Vector = field(default_factory=lambda: np.zeros(3))
    reference: tuple[Vector, Vector] | None = None
    way: list[tuple[Vector, Vector]] = field(default_factory=list)
    hold_time_s: list[float] = field(default_factory=list)
    hold_position_m: list[Vector] = field(default_factory=list)
    hold_force_n: list[Vector] = field(default_factory=list)
    samples: int = 0
    finger_contact_samples: int = 0
    finger_deepest_m: float = 0.0

    @classmethod
    def of(cls, simulation: HandSimulation, rest_height_m: float) -> "Recorder":
        """Watch the body called ``object``."""
        body = int(simulation.model.body("object").id)
        return cls(object_body=body, rest_height_m=rest_height_m, contacts=ContactMap.of(simulation.model))

    def sample(self, simulation: HandSimulation) -> None:
        """Take one sample: contacts, the object's height and way in the hand, the pressures."""
        data = simulation.data
        self.samples += 1
        if data.ncon:
            depth, crossing = self.contacts.depths_m(data)
            self.deepest_m = max(self.deepest_m, depth)
            if crossing is not None:
                self.finger_contact_samples += 1
                self.finger_deepest_m = max(self.finger_deepest_m, crossing)
        self.highest_lift_m = max(self.highest_lift_m, self.lift_m(simulation))
        np.maximum(self.peak_pressure_pa_gauge, simulation.pressure_pa_gauge(), out=self.peak_pressure_pa_gauge)
        if self.reference is not None:
            self.way.append(simulation.in_palm_frame(self.object_body))

    def lift_m(self, simulation: HandSimulation) -> float:
        """Height (m) that the object has gained over its rest on the table."""
        return float(simulation.data.xpos[self.object_body, 2]) - self.rest_height_m

    def mark(self, simulation: HandSimulation) -> None:
        """Take the object's present pose in the hand as what slip and tilt are measured from."""
        self.reference = simulation.in_palm_frame(self.object_body)
        self.way = []

    def start_hold(self) -> None:
        """Forget the hold before: creep and forces are those of the last one."""
        self.hold_time_s, self.hold_position_m, self.hold_force_n = [], [], []

    def sample_hold(self, simulation: HandSimulation) -> None:
        """Take one sample of the object's path in the hand and of the forces on it during a hold."""
        data = simulation.data
        self.hold_time_s.append(float(data.time))
        self.hold_position_m.append(simulation.in_palm_frame(self.object_body)[0])
        touching = self.contacts.of_object(data)
        self.hold_force_n.append(self.contacts.normal_forces_n(data, touching))
        if len(touching):
            self.lifted_deepest_m = max(self.lifted_deepest_m, -float(data.contact.dist[touching].min()))

    def slip_and_tilt(self, simulation: HandSimulation) -> tuple[float, float]:
        """Displacement (m) and turn (rad) of the object in the palm's frame since the mark."""
        if self.reference is None:
            return 0.0, 0.0
        position, rotation = simulation.in_palm_frame(self.object_body)
        turn = Rotation.from_matrix(self.reference[1].T @ rotation).magnitude()
        return float(np.linalg.norm(position - self.reference[0])), float(turn)

    def worst_slip_and_tilt(self) -> tuple[float, float]:
        """Largest displacement (m) and turn (rad) of the object in the palm's frame since the mark."""
        if self.reference is None or not self.way:
            return 0.0, 0.0
        positions, rotations = (np.array(part) for part in zip(*self.way, strict=True))
        turns = Rotation.from_matrix(self.reference[1].T @ rotations).magnitude()
        return float(np.linalg.norm(positions - self.reference[0], axis=1).max()), float(np.max(turns))

    def creep_m_per_s(self) -> float:
        """Drift (m/s) over the second half of the hold, when the fingers have come to rest."""
        half = len(self.hold_time_s) // 2
        if len(self.hold_time_s) - half < 2:
            return 0.0
        return creep_rate_m_per_s(np.array(self.hold_time_s[half:]), np.array(self.hold_position_m[half:]))

    def force_n(self) -> Vector:
        """Mean normal force (N) of each finger and the palm over the second half of the hold, shape (6,)."""
        late = self.hold_force_n[len(self.hold_force_n) // 2 :]
        return np.mean(late, axis=0) if late else np.zeros(PALM + 1)

    def touching(self, simulation: HandSimulation) -> tuple[int, tuple[str, ...]]:
        """Return the number of contacts of object and hand, and the links in contact, by name."""
        found = self.contacts.of_object(simulation.data)
        links = {self.contacts.link[self.contacts.hand_geom(simulation.data, int(i))] for i in found}
        return len(found), tuple(sorted(links))
