"""One world's episodes without Gymnasium around them: commanded, advanced by whoever steps the engine, observed."""

import importlib.util
import math
from collections.abc import Callable, Mapping
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
_NOTHING = np.zeros(0)
_COMPILED = importlib.util.find_spec("numba") is not None
_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


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
        self._privileged = "joint_angle_rad" in spec.layout.where
        self._own = np.zeros(3)
        self._gather: Callable[..., None] | None = None
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
        self._own = np.array([self.world.rest_height_m, self.world.mass_kg(draw), self.world.friction(draw)])

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
        layout = self.spec.layout
        if self.diverged:
            return np.minimum(np.maximum(0.0, layout.low), layout.high)
        arguments = self._observable()
        if _COMPILED:
            out = np.empty(len(layout.low))
            if self._gather is None:
                self._gather = _gatherer(*arguments, layout.low, layout.high, out)
            self._gather(*arguments, layout.low, layout.high, out)
            return out
        return self._gathered(*arguments)

    def _observable(self) -> tuple[Any, ...]:
        """Return what an observation is made from: the first arguments of `envs.gather.gather`."""
        world, simulation, data = self.here, self.here.simulation, self.here.simulation.data
        commanded = self.task.commanded() if self.task.target and not self.spec.sparse else _NOTHING
        return (
            simulation.reading_pa_gauge(), simulation.valves_open(), simulation.set_pressure_pa_gauge,
            simulation.pressure_pa_gauge(), data.qpos, data.qvel, world.wrist_and_joint_qpos,
            world.joint_and_object_dof, data.xpos, data.xquat, simulation.index.palm_body, world.body, self._own,
            commanded,
        )  # fmt: skip

    def _gathered(  # noqa: PLR0913, PLR0917 - as `envs.gather.gather`
        self, reading: Vector, valves: Vector, sets: Vector, pressure: Vector, qpos: Vector, qvel: Vector,
        positions: Vector, velocities: Vector, xpos: Vector, xquat: Vector, palm: int, body: int, own: Vector,
        commanded: Vector,
    ) -> Vector:  # fmt: skip
        """Return the observed vector without compiled code."""
        seen, moving = qpos[positions], qvel[velocities]
        parts: list[npt.ArrayLike] = [1e-3 * reading, valves, seen[:6]]
        if self._privileged:
            placed = object_in_palm(xpos, xquat, palm, body)
            parts += [1e-3 * sets, 1e-3 * pressure, seen[6:], moving[:15], placed, moving[15:]]
            parts += [xpos[body, 2:] - own[:1], own[1:]]
        return self.spec.layout.pack([*parts, commanded])

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


def object_in_palm(xpos: Vector, xquat: Vector, palm: int, body: int) -> Vector:
    """Return position [m] and orientation (quaternion w, x, y, z, w >= 0) of a body in the palm's frame, (7,).

    ``xpos`` and ``xquat`` are the engine's, of all bodies; ``palm`` and ``body`` numbers of two of them.
    """
    out, turned = np.empty(7), xquat[palm] * _CONJUGATE
    mujoco.mju_rotVecQuat(out[:3], xpos[body] - xpos[palm], turned)
    mujoco.mju_mulQuat(out[3:], turned, xquat[body])
    if out[3] < 0.0:
        out[3:] *= -1.0
    return out


def _gatherer(*arguments: Any) -> Callable[..., None]:
    """Return the compiled gathering for arguments of these types."""
    from envs.gather import gather  # noqa: PLC0415 - numba is optional
    from softhand_sim.compiling import loaded  # noqa: PLC0415

    return loaded(gather, *arguments)


def _named(warnings: npt.NDArray[np.int32]) -> dict[str, int]:
    """Return the engine's warnings of this episode by name, with their number."""
    return {mujoco.mjtWarning(k).name: n for k, n in enumerate(warnings.tolist()) if n}
