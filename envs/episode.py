"""One world's episodes without Gymnasium around them: commanded, advanced by whoever steps the engine, observed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from envs.actions import ActionSpec
from envs.draw import Draw, Drawer
from envs.errors import BadOptionError
from envs.observations import Layout
from envs.options import OPTIONS, fixed
from envs.task import Task
from envs.world import World, WorldCache
from softhand_sim.grasp.place import place_object
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
    """

    action: ActionSpec
    layout: Layout
    drawer: Drawer
    names: tuple[str, ...]
    control_period_s: float
    sparse: bool
    has_gas: bool


class Episode:
    """The episodes of one world at a time; `reset`, then `command`, step `simulation`, and `judge`, in turns."""

    def __init__(self, spec: EpisodeSpec, worlds: WorldCache, task: Task) -> None:
        self.spec = spec
        self.task = task
        self.worlds = worlds
        self.draw = Draw()
        self.world: World | None = None

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
        place_object(
            world.simulation, world.object.rest_height_m, (*self.draw.object_offset_m, self.draw.object_yaw_rad)
        )
        self.task.begin(world, rng, options)
        return self._drawn(world.object)

    def enter(self, draw: Draw) -> None:
        """Go to the world of a draw."""
        self.draw = draw
        self.world = self.worlds.get(draw)

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

    def judge(self, elapsed_s: float) -> tuple[float, bool, Info]:
        """Return reward, whether the episode has ended, and the info."""
        world = self.here
        simulation = world.simulation
        beyond = bool(simulation.range_watch.beyond())
        warnings = _warnings(simulation.data)
        if simulation.diverged:
            info: Info = {"is_success": False, "diverged": True}
            reward = -1.0 if self.spec.sparse else 0.0
            return reward, True, info | {"beyond_calibration": beyond, "engine_warnings": warnings}
        verdict = self.task.judge(world, elapsed_s)
        success, reward = verdict.success, sum(verdict.terms.values())
        if self.spec.sparse:
            reward = float(self.task.goal_reward(self.task.achieved(world), self.task.desired()))
            success = reward == 0.0
        info = {"is_success": success, "diverged": False, "beyond_calibration": beyond, "engine_warnings": warnings}
        info |= {f"reward_{name}": value for name, value in verdict.terms.items()} | verdict.figures
        return reward, verdict.lost, info

    def observe(self) -> Vector:
        """Return the observed vector, (n,), new each time; zeros, as far as the bounds allow, when diverged."""
        world, layout = self.here, self.spec.layout
        simulation = world.simulation
        data, index = simulation.data, simulation.index
        if simulation.diverged:
            return np.clip(np.zeros_like(layout.low), layout.low, layout.high)
        valves = [float(v) for pair in simulation.gas.valves for v in pair] if simulation.gas is not None else [0.0] * 6
        parts: list[npt.ArrayLike] = [1e-3 * simulation.reading_pa_gauge(), valves, data.qpos[index.wrist_qpos]]
        if "joint_angle_rad" in layout.where:
            position, rotation = simulation.in_palm_frame(world.body)
            free = world.object_dof
            parts += [
                1e-3 * simulation.set_pressure_pa_gauge,
                1e-3 * simulation.pressure_pa_gauge(),
                data.qpos[index.joint_qpos].ravel(),
                data.qvel[world.joint_dofs],
                position,
                canonical_quaternion(rotation),
                data.qvel[free : free + 6],
                [
                    data.xpos[world.body, 2] - world.object.rest_height_m,
                    world.mass_kg(self.draw),
                    world.friction(self.draw),
                ],
            ]
        if self.task.target and not self.spec.sparse:
            parts.append(self.task.commanded())
        return layout.pack(parts)

    def goals(self) -> tuple[Vector, Vector]:
        """Return the achieved and the desired goal, (g,) each; a lost simulation has achieved the lowest."""
        if self.here.simulation.diverged:
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


def canonical_quaternion(rotation: Vector) -> Vector:
    """Return the unit quaternion w, x, y, z with w >= 0 of a rotation matrix, shape (4,)."""
    out = np.empty(4)
    mujoco.mju_mat2Quat(out, rotation.ravel())
    return -out if out[0] < 0.0 else out


def _warnings(data: mujoco.MjData) -> dict[str, int]:
    """Return the engine's warnings of this episode by name, with their number."""
    numbers = data.warning.number
    return {mujoco.mjtWarning(k).name: int(numbers[k]) for k in np.flatnonzero(numbers)}
