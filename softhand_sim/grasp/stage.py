"""What the phases of a running trial act on."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from softhand_sim.grasp.record import Recorder
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]

SAMPLE_S = 0.02
"""Time between samples of the record, and between questions whether a phase is over: the sensor's and controller's."""


@dataclass(kw_only=True)
class Stage:
    """A trial under way, from the start of its first phase on.

    Attributes
    ----------
    simulation, recorder: the world, and what watches it.
    mass_kg: of the object.
    settle_s: rest after each move.
    drive: called before every step of the engine; a phase that sets it takes it away again.
    """

    simulation: HandSimulation
    recorder: Recorder
    mass_kg: float
    settle_s: float
    drive: Callable[[], None] | None = None

    def arrived(self) -> bool:
        """Whether the wrist's reference stands at its target."""
        return self.simulation.wrist_arrived

    def after(self, duration_s: float) -> Callable[[], bool]:
        """Return the question whether `duration_s` from now have passed."""
        data = self.simulation.data
        end_s = data.time + duration_s
        return lambda: bool(data.time >= end_s)

    def press(self, force_n: Vector) -> None:
        """Let a force, shape (3,), along the world's axes act on the object's mass centre until the next call."""
        self.simulation.data.xfrc_applied[self.recorder.object_body, :3] = force_n

    @property
    def gravity_m_per_s2(self) -> Vector:
        """The world's gravity, shape (3,)."""
        return np.array(self.simulation.model.opt.gravity)


class Phase(Protocol):
    """One part of a protocol: plain values, and what they do.

    `needs_object` tells that the phase says nothing about an object that was not lifted: the trial then ends before it.
    """

    @property
    def needs_object(self) -> bool:
        """Whether the trial ends before this phase if the object is not off the table."""
        ...

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Give commands, and after each yield the question whether it is done; asked every 20 ms."""
        ...


def unit_vector(x: float, y: float, z: float) -> Vector:
    """Return the direction of a vector, shape (3,).

    Raises
    ------
    ValueError
        If it has no direction.
    """
    length = float(np.linalg.norm((x, y, z)))
    if not 0.0 < length < np.inf:
        raise ValueError(f"x, y, z: {(x, y, z)} must be finite numbers, not all zero")
    return np.array([x, y, z]) / length
