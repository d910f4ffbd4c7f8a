"""Puts the object on the table, and the hand where it is clear of it."""

import mujoco
import numpy as np

from softhand_sim.grasp.contacts import ContactMap
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.simulation import HandSimulation

BACK_OFF_M, FARTHEST_M = 0.01, 0.3
"""Choices: steps of a hundredth of a metre, until a hand's length and more lies between hand and grasp."""
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


def stand_off(simulation: HandSimulation, plan: GraspPlan, distance_m: float) -> float:
    """Back the hand off from where it stands, ``distance_m`` before the grasp, while it overlaps the displaced object.

    An overlap lets go of energy that nobody put in: a cracker box displaced by 10 mm stood 7 mm deep in a finger and
    flew off with 10 mJ.

    Returns
    -------
    The distance (m) from the grasp, at most `FARTHEST_M` or what was asked.
    """
    contacts, distance = ContactMap.of(simulation.model), distance_m
    while contacts.of_object(simulation.data).size and distance + BACK_OFF_M <= FARTHEST_M:
        distance += BACK_OFF_M
        simulation.stand(plan.standoff(distance))
    return distance
