"""The actuation in plain Python, world by world: runs where numba is missing; the kernel is held against it."""

import numpy as np
import numpy.typing as npt

from softhand_sim.actuation.parts import EngineArrays, HandParts
from softhand_sim.calibration import JOINT_RANGE_RAD, JOINTS
from softhand_sim.elements import FINGERS, spread_to_fingers
from softhand_sim.losses import LossState
from softhand_sim.pneumatics.state import PneumaticState

Vector = npt.NDArray[np.float64]

MOST_BEND_RAD = len(JOINTS) * JOINT_RANGE_RAD[1]
"""An engine that diverges shows infinite angles before it says so."""


class PlainActuation:
    """`Actuation` of n hands by `PneumaticSystem` and `Losses`."""

    def __init__(self, hand: HandParts, engine: EngineArrays) -> None:
        n = len(engine.ctrl)
        self._hand, self._engine = hand, engine
        self._loses = hand.losses.any
        self._gas: list[PneumaticState | None] = [None] * n
        self._losses = [hand.losses.rest(np.zeros(len(FINGERS))) for _ in range(n)]
        self._played: Vector | None = None
        self.set_pa_gauge = np.zeros((n, 3))
        self.pressure_pa_gauge = np.zeros((n, len(FINGERS)))

    def reset(self, world: int, rng: np.random.Generator) -> None:
        """Empty the fingers of a world."""
        elongation = self._elongation_m(world)
        self._losses[world] = self._hand.losses.rest(elongation)
        system = self._hand.pneumatics
        self._gas[world] = None if system is None else system.reset(self._volumes_m3(elongation), rng)

    def step(self, dt: float) -> None:
        """Advance every world."""
        hand, engine = self._hand, self._engine
        for world, sets in enumerate(self.set_pa_gauge):
            elongation, state = self._elongation_m(world), self._gas[world]
            if self._played is not None:
                pressure = tuple(self._played[world].tolist())
            elif hand.pneumatics is None or state is None:
                pressure = spread_to_fingers(sets.tolist())
            else:
                state = hand.pneumatics.step(
                    state, self._volumes_m3(elongation + self._losses[world].bulge_m), sets, dt
                )
                self._gas[world], pressure = state, hand.pneumatics.finger_pressures_pa_gauge(state)
            self.pressure_pa_gauge[world] = pressure
            engine.ctrl[world, hand.index.pressure_ctrl] = pressure
            if self._loses:
                bend = np.minimum(np.abs(engine.qpos[world, hand.index.joint_qpos]).sum(axis=1), MOST_BEND_RAD)
                self._losses[world], force = hand.losses.step(
                    self._losses[world], elongation, bend, self.pressure_pa_gauge[world], dt
                )
                engine.ctrl[world, hand.index.loss_ctrl] = force

    def play(self, pressures_pa_gauge: Vector) -> None:
        """Give the fingers these pressures instead of the gas's."""
        self._played = pressures_pa_gauge

    def stop_playing(self) -> None:
        """Let the gas go on."""
        self._played = None

    def pressure_pa_abs(self) -> Vector:
        """Return the pressure where each element's sensor sits."""
        return np.array([state.pressure_pa_abs for state in self._gas if state is not None])

    def reading_pa_abs(self) -> Vector:
        """Return the last readings."""
        return np.array([state.readings_pa_abs for state in self._gas if state is not None])

    def valves_open(self) -> Vector:
        """Return which valves are open."""
        rows = [[valve for pair in state.valves for valve in pair] for state in self._gas if state is not None]
        return np.array(rows, dtype=np.float64)

    def gas(self, world: int) -> PneumaticState | None:
        """Return a world's gas."""
        return self._gas[world]

    def set_gas(self, world: int, state: PneumaticState | None) -> None:
        """Put a world's gas into a state."""
        self._gas[world] = state

    def losses(self, world: int) -> LossState:
        """Return a world's losses."""
        return self._losses[world]

    def set_losses(self, world: int, state: LossState) -> None:
        """Put a world's losses into a state."""
        self._losses[world] = state

    def _elongation_m(self, world: int) -> Vector:
        return self._hand.index.elongations_m(self._engine.ten_length[world])

    def _volumes_m3(self, elongation_m: Vector) -> list[float]:
        return self._hand.calibration.chamber.volumes_m3(elongation_m)
