"""Puts the object on the table."""

import mujoco
import numpy as np

from softhand_sim.simulation import HandSimulation


def place_object(simulation: HandSimulation, rest_height_m: float, offset: tuple[float, float, float]) -> None:
    """Stand the body ``object`` on the table at x, y (m), turned by a yaw (rad) about the vertical."""
    x, y, yaw = offset
    address = simulation.model.joint("object_joint").qposadr[0]
    simulation.data.qpos[address : address + 7] = (
        x, y, rest_height_m, np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw),
    )  # fmt: skip
    mujoco.mj_forward(simulation.model, simulation.data)
