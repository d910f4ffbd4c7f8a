"""Worlds of several episodes in one batch of the engine: what each episode commands goes in, what it sees comes out."""

from collections.abc import Sequence
from functools import partial

import mujoco
import numpy as np
import numpy.typing as npt

from envs.episode import Episode, GasSeen
from softhand_sim.batch import HandBatch
from softhand_sim.effects.build import build_losses, build_pneumatics

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class Lanes:
    """Episodes side by side, one lane each: reset in their own simulations, advanced together in a `HandBatch`.

    An episode's simulation is brought up to date after every advance, so that the episode reads it as ever, but for its
    gas and losses, which live in the batch. Lanes differ in mass, friction and place of the object alone.

    Parameters
    ----------
    episodes
        At least one; their worlds are of one object and one calibration.
    threads
        Of the engine; 0 for all processors.
    """

    def __init__(self, episodes: Sequence[Episode], threads: int) -> None:
        self._episodes = tuple(episodes)
        self._threads = threads
        self._hands: HandBatch | None = None
        self._seen: tuple[npt.NDArray[np.float64], ...] = ()
        for lane, episode in enumerate(self._episodes):
            episode.gas_of = partial(self._gas_of, lane)
        self._state: npt.NDArray[np.float64] = np.zeros(0)

    def enter(self, lanes: Sequence[int]) -> None:
        """Take over episodes that were just reset."""
        hands = self._batch()
        # masses and friction coefficients are read from the worlds' own models
        hands.engine.set_models([episode.here.model for episode in self._episodes])
        for lane in lanes:
            simulation = self._episodes[lane].here.simulation
            mujoco.mj_getState(simulation.model, simulation.data, self._state, _STATE)
            hands.reset([lane], [np.random.default_rng(0)], simulation.wrist_reference)
            hands.engine.state[lane] = self._state
        # positions alone: the rest would change what the solver starts from
        hands.engine.forward(np.asarray(lanes), stage=mujoco.mjtStage.mjSTAGE_POS.value)
        for lane in lanes:
            simulation = self._episodes[lane].here.simulation
            hands.actuation.set_gas(lane, simulation.gas)
            hands.actuation.set_losses(lane, simulation.loss_state)
        self._see()

    def advance(self, steps: int) -> None:
        """Advance all lanes by steps of the engine, and let their episodes `look`.

        A lane whose coordinates are no numbers any more stands still until its next reset.
        """
        hands = self._batch()
        for lane, episode in enumerate(self._episodes):
            simulation = episode.here.simulation
            hands.set_pressure_pa_gauge[lane] = simulation.set_pressure_pa_gauge
            hands.wrist_target[lane] = simulation.wrist_target
        qpos = hands.engine.bind("qpos")
        lost = np.zeros(len(self._episodes), dtype=bool)
        for _ in range(steps):
            hands.step()
            bad = ~np.isfinite(qpos).all(axis=1)
            if bad.any():
                self._park(np.flatnonzero(bad))
                lost |= bad
        for lane, episode in enumerate(self._episodes):
            simulation = episode.here.simulation
            hands.engine.get_data(lane, simulation.data)
            simulation.wrist_reference = hands.wrist_reference[lane].copy()
        self._see()
        for episode, gone, beyond in zip(
            self._episodes, lost.tolist(), hands.passed_calibration().tolist(), strict=True
        ):
            episode.look(lost=gone, beyond=beyond)

    def state(self) -> npt.NDArray[np.float64]:
        """Return a copy of the engine's full state, one row a lane."""
        return np.array(self._batch().engine.state)

    def _see(self) -> None:
        """Read the gas of all lanes at once."""
        hands = self._batch()
        sets = hands.set_pressure_pa_gauge.copy()
        self._seen = (hands.reading_pa_gauge(), hands.valves_open(), sets, hands.pressure_pa_gauge())

    def _gas_of(self, lane: int) -> GasSeen:
        return GasSeen(*(field[lane] for field in self._seen))

    def _park(self, lanes: npt.NDArray[np.int64]) -> None:
        hands = self._batch()
        rest = [np.random.default_rng(0) for _ in lanes]
        hands.reset(lanes, rest, np.array([0.0, 0.0, 0.5, 0.0, 0.0, 0.0]))

    def _batch(self) -> HandBatch:
        if self._hands is None:
            world = self._episodes[0].here
            settings = world.settings
            self._hands = HandBatch(
                model=world.model,
                calibration=world.calibration,
                pneumatics=build_pneumatics(world.effects, world.calibration, settings.controller),
                worlds=len(self._episodes),
                threads=self._threads,
                anatomy=settings.anatomy,
                losses=build_losses(world.effects, world.calibration),
                persistent=True,
            )
            self._state = np.empty(mujoco.mj_stateSize(world.model, _STATE))
        return self._hands
