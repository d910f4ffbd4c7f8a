"""Shake: the wrist swings with a sinusoidal acceleration."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from softhand_sim.checks import require_in
from softhand_sim.grasp.stage import Stage, unit_vector


@dataclass(frozen=True, kw_only=True)
class Shake:
    """Swing the hand along one of the world's axes, then rest.

    The hand's position is A (1 - cos wt) u with A w^2 = `acceleration_m_per_s2`, over a whole number of swings: it
    starts and ends at rest. The swing is faster than the wrist's limit for moves; the reference runs ahead of it by
    what the servo lags, x + 2 x'/w0 + x''/w0^2 for a critically damped one, faded in and out over a radian.

    Attributes
    ----------
    x, y, z: direction; made a unit vector.
    acceleration_m_per_s2: amplitude of the acceleration.
    frequency_hz: of the swing.
    swings: how many.
    """

    acceleration_m_per_s2: float
    frequency_hz: float
    swings: int
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    needs_object: bool = True

    def __post_init__(self) -> None:
        require_in("acceleration_m_per_s2", self.acceleration_m_per_s2, 0.0, 1000.0)
        require_in("frequency_hz", self.frequency_hz, 0.1, 20.0)
        require_in("swings", self.swings, 1, 1000)
        if self.swings != round(self.swings):
            raise ValueError(f"swings: {self.swings} must be a whole number")
        unit_vector(self.x, self.y, self.z)
        if self.amplitude_m > 0.1:
            raise ValueError(
                f"frequency_hz: {self.frequency_hz} gives an amplitude of {self.amplitude_m:.3g} m, over 0.1"
            )

    @property
    def amplitude_m(self) -> float:
        """Half of the way between the turning points."""
        return self.acceleration_m_per_s2 / (2.0 * np.pi * self.frequency_hz) ** 2

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Swing, rest."""
        simulation = stage.simulation
        home, start_s = simulation.wrist_target.copy(), float(simulation.data.time)
        direction = np.zeros(6)
        direction[:3] = unit_vector(self.x, self.y, self.z)
        rate = 2.0 * np.pi * self.frequency_hz
        anatomy = simulation.anatomy
        own_rate = np.sqrt(anatomy.wrist_stiffness_n_per_m / (anatomy.wrist_armature_kg + anatomy.hand_mass_kg))
        damping_s = 2.0 * np.sqrt(anatomy.wrist_armature_kg / anatomy.wrist_stiffness_n_per_m)
        duration_s = self.swings / self.frequency_hz

        def swing() -> None:
            phase = rate * min(float(simulation.data.time) - start_s, duration_s)
            ahead = damping_s * rate * np.sin(phase) + (rate / own_rate) ** 2 * np.cos(phase)
            # at its ends the acceleration jumps: the reference may not
            ahead *= min(1.0, phase, rate * duration_s - phase)
            simulation.wrist_reference = home + self.amplitude_m * (1.0 - np.cos(phase) + ahead) * direction
            simulation.wrist_target = simulation.wrist_reference.copy()

        stage.drive = swing
        yield stage.after(duration_s)
        stage.drive = None
        simulation.wrist_target = home
        yield stage.arrived
        yield stage.after(stage.settle_s)


KINDS = {"shake": Shake}
