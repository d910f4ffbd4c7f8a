"""One world's episodes without Gymnasium around them: commanded, advanced by whoever steps the engine, observed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from envs.actions import ActionSpec
from envs.draw import Draw, Drawer
from envs.errors import BadOptionError
from envs.guarding import LOOK_S, Guarding
from envs.observations import Layout
from envs.observer import NOTHING, Observer
from envs.options import OPTIONS, fixed
from envs.task import Task
from envs.world import World, WorldPool
from softhand_sim.fidelity.fidelity import Fidelity
from softhand_sim.grasp.place import place_object
from softhand_sim.guards.limits import Guards
from softhand_sim.hand.hand import HINGE_RANGE_RAD, SLIDE_RANGE_M
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]
Info = dict[str, Any]

_WRIST_RANGE = np.array([*SLIDE_RANGE_M, *[HINGE_RANGE_RAD] * 3])


@dataclass(frozen=True, kw_only=True)
class EpisodeSpec:
    """What does not change from episode to episode.

    Attributes
    ----------
    action, layout
        Of actions and of the observed vector.
    drawer
        Of episodes.
    names
        Of the objects.
    control_period_s
        Time of one action [s].
    sparse
        Whether the reward is the goal's.
    has_gas
        Whether there are valves and sensors.
    guards
        What a simulation may not pass (`softhand_sim.guards`); None: it may do anything but diverge.
    fidelity
        What a tolerance picked; None without one.
    """

    action: ActionSpec
    layout: Layout
    drawer: Drawer
    names: tuple[str, ...]
    control_period_s: float
    sparse: bool
    has_gas: bool
    guards: Guards | None = None
    fidelity: Fidelity | None = None


class Episode:
    """The episodes of one world at a time; `reset`, then `command`, `advance`, `observe` and `judge`, in turns."""

    def __init__(self, spec: EpisodeSpec, worlds: WorldPool, task: Task) -> None:
        self.spec = spec
        self.task = task
        self.worlds = worlds
        self.draw = Draw()
        self.world: World | None = None
        self.diverged = False
        self.guarding = Guarding(spec.guards)
        self._beyond = False
        self.observer = Observer(spec.layout)
        self._warnings: dict[str, int] = {}

    @property
    def here(self) -> World:
        """The world of the present episode.

        Raises
        ------
        RuntimeError
            Before the first reset.
        """
        if self.world is None:
            raise RuntimeError("no episode: call reset first")
        return self.world

    @property
    def substeps(self) -> int:
        """Steps of the engine in one action."""
        return round(self.spec.control_period_s / self.here.simulation.dt)

    def reset(self, rng: np.random.Generator, options: Mapping[str, Any]) -> Info:
        """Start an episode and return what was drawn.

        Raises
        ------
        BadOptionError
            If an option is unknown, or its value not allowed.
        """
        allowed = (*OPTIONS, *self.task.options)
        unknown = sorted(set(options) - set(allowed))
        if unknown:
            raise BadOptionError(f"options: {unknown} unknown, must be among {list(allowed)}")
        spec = self.spec
        draw = spec.drawer.draw(rng)
        self.draw = fixed(
            draw, options, objects=spec.names, calibrations=spec.drawer.calibrations, has_gas=spec.has_gas
        )
        self.enter(self.draw)
        world = self.here
        world.simulation.reset(rng, self.task.wrist_start(world.object))
        place_object(world.simulation, world.rest_height_m, (*self.draw.object_offset_m, self.draw.object_yaw_rad))
        self.task.stand_clear(world)
        self.task.begin(world, rng, options)
        self.guarding.begin(world)
        self.look()
        picked = {} if spec.fidelity is None else spec.fidelity.told()
        return self._drawn(world.object) | picked

    def enter(self, draw: Draw) -> None:
        """Go to the world of a draw."""
        self.draw = draw
        self.world = self.worlds.exchange(self.world, draw)
        self._beyond = False
        self.observer.enter(self.world.rest_height_m, self.world.mass_kg(draw), self.world.friction(draw))

    def command(self, action: npt.ArrayLike) -> None:
        """Give an action to controller and wrist.

        Raises
        ------
        BadActionError
            If it is none; nothing was changed.
        """
        command = self.spec.action.decode(action)
        simulation = self.here.simulation
        simulation.set_pressure_pa_gauge = command.fingers
        if command.wrist is None:
            simulation.wrist_target = self.task.wrist_script(float(simulation.data.time))
        else:
            target = simulation.wrist_reference.copy()
            target[: len(command.wrist)] += self.spec.control_period_s * command.wrist
            simulation.wrist_target = np.minimum(np.maximum(target, _WRIST_RANGE[:, 0]), _WRIST_RANGE[:, 1])

    def advance(self) -> None:
        """Take the engine's steps of one action, as far as coordinates are numbers, and `look`; so do the guards."""
        simulation, left = self.here.simulation, self.substeps
        at_once = max(1, round(LOOK_S / simulation.dt))
        try:
            while left > 0:
                simulation.advance(min(left, at_once))
                left -= at_once
                self.look()
                self.guarding.look(self.here, range_too=self._beyond)
        except ValueError:
            # the gas refuses the volumes of a finger that is nowhere
            if np.isfinite(simulation.data.qpos).all():
                raise
            self.look()
        self.diverged = self.diverged or self.guarding.diverged

    def look(self) -> None:
        """See what the engine says after its steps; before `observe` and `judge`, which rely on it."""
        simulation = self.here.simulation
        # extremes stay: what was passed once is passed
        self._beyond = self._beyond or simulation.range_watch.passed()
        # lists and one product: half the time of `any` and `isfinite`
        self._warnings = _named(simulation.warnings) if any(simulation.warnings.tolist()) else {}
        positions = simulation.data.qpos
        self.diverged = self.guarding.diverged or not math.isfinite(positions.dot(positions))
        if self._warnings:
            self.diverged = self.diverged or simulation.diverged

    def judge(self, elapsed_s: float) -> tuple[float, bool, Info]:
        """Return reward, whether the episode has ended, and the info."""
        world, guarding = self.here, self.guarding
        told: Info = {"diverged": self.diverged, **guarding.told(diverged=self.diverged)}
        told |= {"beyond_calibration": self._beyond, "engine_warnings": self._warnings}
        if self.diverged:
            return -1.0 if self.spec.sparse else 0.0, True, {"is_success": False, **told}
        verdict = self.task.judge(world, elapsed_s)
        success, reward = verdict.success, sum(verdict.terms.values())
        if self.spec.sparse:
            reward = float(self.task.goal_reward(self.task.achieved(world), self.task.desired()))
            success = reward == 0.0
        info: Info = {"is_success": success, **told}
        info |= {f"reward_{name}": value for name, value in verdict.terms.items()} | verdict.figures
        # with -1 a step, an early end would be a reward
        ended = (verdict.lost or guarding.alarm is not None) and not self.spec.sparse
        return reward, ended, info

    def observe(self) -> Vector:
        """Return the observed vector, (n,), new each time; zeros, as far as the bounds allow, when diverged."""
        if self.diverged:
            return self.observer.nothing()
        return self.observer.see(self.here, self.commanded())

    def commanded(self) -> Vector:
        """Return what the task adds to an observation, (t,); in goal mode that stands beside it."""
        return self.task.commanded() if self.task.target and not self.spec.sparse else NOTHING

    def goals(self) -> tuple[Vector, Vector]:
        """Return the achieved and the desired goal, (g,) each; a lost simulation has achieved the lowest."""
        if self.diverged:
            return np.array(self.task.goal_low), self.task.desired()
        return self.task.achieved(self.here), self.task.desired()

    def _drawn(self, model: ObjectModel) -> Info:
        draw, world = self.draw, self.here
        return {
            "object": model.name,
            "calibration": draw.calibration,
            "object_offset_m": np.array(draw.object_offset_m),
            "object_yaw_rad": draw.object_yaw_rad,
            "mass_kg": world.mass_kg(draw),
            "friction": world.friction(draw),
            "leak": "" if draw.leak is None else draw.leak.finger,
            "valve_flow_ratio": draw.valve_flow_ratio,
            "sensor_offset_pa": draw.sensor_offset_pa,
        }


def _named(warnings: npt.NDArray[np.int32]) -> dict[str, int]:
    """Return the engine's warnings of this episode by name, with their number."""
    return {mujoco.mjtWarning(k).name: n for k, n in enumerate(warnings.tolist()) if n}
