"""Puts the object on the table."""

import mujoco
import numpy as np

from softhand_sim.simulation import HandSimulation

Offset = tuple[float, float, float]


def on_table(rest_height_m: float, offset: Offset) -> tuple[float, ...]:
    """Return position (m) and quaternion w, x, y, z of an object that stands at x, y (m), turned by a yaw (rad)."""
    x, y, yaw = offset
    return x, y, rest_height_m, np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)


def place_object(simulation: HandSimulation, rest_height_m: float, offset: Offset) -> None:
    """Stand the body ``object`` on the table at x, y (m), turned by a yaw (rad) about the vertical."""
    address = simulation.model.joint("object_joint").qposadr[0]
    simulation.data.qpos[address : address + 7] = on_table(rest_height_m, offset)
    mujoco.mj_forward(simulation.model, simulation.data)
