"""Simulated time a second of free-running environments under random actions, resets included, all in turns.

Single environments, and vector environments as `gymnasium.make_vec` makes them: ours on native threads, others one
after the other (Gymnasium's default, sync) and in a process each (async).
"""

import importlib
import importlib.util
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from tqdm import tqdm

import envs
from softhand_sim.hand.scene import EngineSettings

SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "grasp apple": (envs.GRASP_ENV_ID, {"objects": "apple"}),
    "grasp mug": (envs.GRASP_ENV_ID, {"objects": "mug"}),
    "reorient bar": (envs.REORIENT_ENV_ID, {}),
}
OTHER = "AdroitHandRelocate-v1"
PROCESSES, TURNS = 2, 5
Vector = npt.NDArray[np.float64]


@dataclass(kw_only=True)
class Run:
    """A free-running environment; mutable on purpose: it counts.

    Attributes
    ----------
    scene, way
        What runs, and how.
    env
        Of Gymnasium, single or vector.
    single
        One that has the same engine.
    own_processes
        Whether it is stepped in processes of its own, whose time is not known here.
    spent
        Time by the clock, of the processor, and simulated [s], (3,).
    """

    scene: str
    way: str
    env: Any
    single: Any
    own_processes: bool = False

    def __post_init__(self) -> None:
        self.spent = np.zeros(3)
        self._over = np.zeros(self.worlds, dtype=bool)

    @property
    def worlds(self) -> int:
        """How many are stepped together."""
        return int(getattr(self.env, "num_envs", 1))

    def start(self, seed: int) -> None:
        """Reset, and take the first step, which may compile."""
        self.env.reset(seed=seed)
        self.env.action_space.seed(seed)
        self._act()

    def turn(self, seconds: float) -> None:
        """Take random actions for some time by the clock."""
        (step_s, steps), began, actions = _period(self.single), _clocks(), 0
        while time.perf_counter() - began[0] < seconds:
            actions += self._act()
        self.spent += [*(_clocks() - began), actions * steps * step_s]

    def _act(self) -> int:
        """Take an action in every world; return how many were no resets."""
        over = self._over
        *_, terminated, truncated, _ = self.env.step(self.env.action_space.sample())
        if self.worlds > 1:
            # a vector environment resets itself in the next step
            self._over = terminated | truncated
            return int(self.worlds - over.sum())
        if terminated or truncated:
            self.env.reset()
        return 1

    def row(self) -> dict[str, Any]:
        """Return the figures, JSON-ready."""
        step_s, steps = _period(self.single)
        wall, processor, simulated = self.spent.tolist()
        return {
            "scene": self.scene,
            "way": self.way,
            "worlds": self.worlds,
            "engine_steps": steps,
            "time_step_s": step_s,
            "simulated_s_per_s": simulated / wall,
            "simulated_s_per_processor_s": None if self.own_processes else simulated / processor,
        }


def free_running(
    given: dict[str, Any], *, worlds: int, threads: int, seconds: float, seed: int
) -> list[dict[str, Any]]:
    """Return figures of each environment, each so long by the clock; ``given`` are arguments of ours.

    Without ``worlds`` there are no vector environments, and without gymnasium-robotics nothing but ours.
    """
    runs: list[Run] = []
    for scene, (env_id, own) in SCENES.items():
        single = gymnasium.make(env_id, **given, **own)
        runs.append(Run(scene=scene, way="single", env=single, single=single))
        if worlds > 0:
            vector = gymnasium.make_vec(env_id, num_envs=worlds, threads=threads, **given, **own)
            runs.append(Run(scene=scene, way=f"native, {threads} threads", env=vector, single=single))
    scene, (env_id, own) = next(iter(SCENES.items()))
    trial = gymnasium.make(env_id, engine=EngineSettings(), **given, **own)
    runs.append(Run(scene=f"{scene}, a trial's", way="single", env=trial, single=trial))
    if importlib.util.find_spec("gymnasium_robotics") is not None:
        runs += _others(worlds)
    try:
        for run in runs:
            run.start(seed)
        for _ in tqdm(range(TURNS), desc="free-running", unit="turn", disable=None):
            for run in runs:
                run.turn(seconds / TURNS)
    finally:
        for run in runs:
            run.env.close()
    return [run.row() for run in runs]


def _others(worlds: int) -> list[Run]:
    gymnasium.register_envs(importlib.import_module("gymnasium_robotics"))
    single = _quietly(lambda: gymnasium.make(OTHER))
    runs = [Run(scene=OTHER, way="single", env=single, single=single)]
    if worlds > 0:
        sync = _quietly(lambda: gymnasium.make_vec(OTHER, num_envs=worlds, vectorization_mode="sync"))
        processes = _quietly(lambda: gymnasium.make_vec(OTHER, num_envs=PROCESSES, vectorization_mode="async"))
        runs.append(Run(scene=OTHER, way="sync", env=sync, single=single))
        way = f"async, {PROCESSES} processes"
        runs.append(Run(scene=OTHER, way=way, env=processes, single=single, own_processes=True))
    return runs


def _quietly(make: Callable[[], Any]) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return make()


def tell(rows: list[dict[str, Any]]) -> None:
    """Print the figures."""
    print(f"{'random actions':<24}{'way':<20}{'worlds':>7}{'simulated s/s':>15}{'by processor':>14}   an action")
    for row in rows:
        processor = row["simulated_s_per_processor_s"]
        told = "-" if processor is None else f"{processor:.1f}"
        print(
            f"{row['scene']:<24}{row['way']:<20}{row['worlds']:>7}{row['simulated_s_per_s']:>15.1f}{told:>14}   "
            f"{row['engine_steps']} of {1e3 * row['time_step_s']:g} ms"
        )


def _clocks() -> Vector:
    return np.array([time.perf_counter(), time.process_time()])


def _period(env: Any) -> tuple[float, int]:
    """Return the engine's time step [s], and its steps in an action."""
    raw = env.unwrapped
    if hasattr(raw, "frame_skip"):
        return float(raw.model.opt.timestep), int(raw.frame_skip)
    return float(raw.episode.here.simulation.dt), int(raw.episode.substeps)
