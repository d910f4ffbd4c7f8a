"""Sees a world: the observed vector by one compiled call, or by NumPy where numba is missing."""

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from envs.observations import Layout
from envs.world import World
from softhand_sim.actuation.choice import has_numba

Vector = npt.NDArray[np.float64]

NOTHING = np.zeros(0)
"""What a task without a target adds to an observation."""
_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


class Observer:
    """Observations of one world at a time; `enter` it first."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._privileged = "joint_angle_rad" in layout.where
        self._compiled = has_numba()
        self._own = np.zeros(3)
        self._gather: Callable[..., None] | None = None

    def enter(self, rest_height_m: float, mass_kg: float, friction: float) -> None:
        """Begin with an object at rest at that height [m], of that mass [kg] and friction."""
        self._own = np.array([rest_height_m, mass_kg, friction])

    def nothing(self) -> Vector:
        """Return zeros, as far as the bounds allow, (n,): what is seen of a simulation that diverged."""
        return np.minimum(np.maximum(0.0, self._layout.low), self._layout.high)

    def see(self, world: World, commanded: Vector) -> Vector:
        """Return the observed vector, (n,), new each time; ``commanded``, (t,), is what the task adds at the end."""
        if not self._compiled:
            return self.see_plainly(world, commanded)
        out = np.empty(len(self._layout.low))
        arguments = (*self._state(world), commanded, self._layout.low, self._layout.high, out)
        if self._gather is None:
            self._gather = _gatherer(*arguments)
        self._gather(*arguments)
        return out

    def see_plainly(self, world: World, commanded: Vector) -> Vector:
        """Return what `see` does, without compiled code."""
        reading, valves, sets, pressure, qpos, qvel, positions, velocities, xpos, xquat, palm, body, own = self._state(
            world
        )
        seen, moving = qpos[positions], qvel[velocities]
        parts: list[npt.ArrayLike] = [1e-3 * reading, valves, seen[:6]]
        if self._privileged:
            placed = object_in_palm(xpos, xquat, palm, body)
            parts += [1e-3 * sets, 1e-3 * pressure, seen[6:], moving[:15], placed, moving[15:]]
            parts += [xpos[body, 2:] - own[:1], own[1:]]
        return self._layout.pack([*parts, commanded])

    def _state(self, world: World) -> tuple[Any, ...]:
        """Return the first arguments of `envs.gather.gather`."""
        simulation, data = world.simulation, world.simulation.data
        return (
            simulation.reading_pa_gauge(), simulation.valves_open(), simulation.set_pressure_pa_gauge,
            simulation.pressure_pa_gauge(), data.qpos, data.qvel, world.wrist_and_joint_qpos,
            world.joint_and_object_dof, data.xpos, data.xquat, simulation.index.palm_body, world.body, self._own,
        )  # fmt: skip


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
