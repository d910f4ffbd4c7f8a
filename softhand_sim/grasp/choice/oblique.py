"""Grasp poses from any side: the palm leans over in any direction, until it looks level or a little upward.

A hand that leans brings a finger, a row of fingers or the thumb under an object: what lies on a finger's side is
carried by its stiffness across the joints, what lies on its pads by pressure and friction together.
"""

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from softhand_sim.grasp.choice.reach import TABLE_PRESS_M, HandReach
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]

# choice: from a palm that looks down to one that looks 10 degrees upward; fingers that scoop come in so
LARGEST_LEAN_RAD = float(np.radians(100.0))
# choice: the middle of the object lies between a third of the fingers' depth and the plane of their tips
SHALLOWEST, DEEPEST = 0.3, 0.9
# choice: a palm that leans no more than this comes in from straight above in half of the draws; no more than the
# second, always
FROM_ABOVE_RAD, ONLY_FROM_ABOVE_RAD = float(np.radians(65.0)), float(np.radians(20.0))
# choice: most that a palm pushes an object along the table, and what it keeps away from it otherwise
PUSH_M, CLEAR_M = 0.012, 0.002
# choice: spread of the middle of the hand about the anchor
SPREAD_M = 0.006


def from_anywhere(
    model: ObjectModel, reach: HandReach, anchor_m: Vector, turn_rad: float, rng: np.random.Generator
) -> tuple[Vector, Vector, Vector]:
    """Draw the palm's place (3,), its axes (3, 3, columns) and the way it backs off (3,).

    Parameters
    ----------
    model: the object at rest, mass centre above the world's origin.
    reach: of the hand.
    anchor_m: point that thumb and fingers are to close about, from the mass centre, shape (3,).
    turn_rad: direction from thumb to fingers before the palm leans over, from x.
    rng: draws the rest.
    """
    lean, toward = rng.uniform(0.0, LARGEST_LEAN_RAD), rng.uniform(0.0, 2.0 * np.pi)
    upright = Rotation.from_euler("z", turn_rad) * Rotation.from_matrix(np.diag([1.0, -1.0, -1.0]))
    axes = (Rotation.from_rotvec(lean * np.array([np.cos(toward), np.sin(toward), 0.0])) * upright).as_matrix()
    retreat = _way_back(axes[:, 2], lean, rng)
    depth = rng.uniform(SHALLOWEST, DEEPEST) * reach.depth_m
    middle = np.array([0.0, 0.0, model.rest_height_m]) + anchor_m + rng.normal(0.0, SPREAD_M, size=3)
    place = middle - axes @ [reach.centre_m, 0.0, depth]
    push = rng.uniform(0.0, PUSH_M) if lean > FROM_ABOVE_RAD else 0.0
    place -= max(0.0, CLEAR_M - push - _ahead_m(model, reach, place, axes)) * axes[:, 2]
    # a hand that comes in along the table has nothing pressed into it on its way
    place[2] += reach.too_low_m(place, axes, TABLE_PRESS_M if retreat[2] > 0.5 else 0.0)
    return place, axes, retreat


def _way_back(out: Vector, lean_rad: float, rng: np.random.Generator) -> Vector:
    """Return straight up, or against the direction `out` in which the palm looks, but never downward."""
    up = rng.uniform() < 0.5
    if lean_rad < ONLY_FROM_ABOVE_RAD or (up and lean_rad < FROM_ABOVE_RAD):
        return np.array([0.0, 0.0, 1.0])
    back = -out * [1.0, 1.0, 1.0 if out[2] < 0.0 else 0.0]
    return np.asarray(back / np.linalg.norm(back))


def _ahead_m(model: ObjectModel, reach: HandReach, place_m: Vector, axes: Vector) -> float:
    """Return how far (m) the nearest part of the object before the palm is from its plane; infinite without any."""
    seen = (np.asarray(model.mesh.vertices) - place_m + np.array([0.0, 0.0, model.rest_height_m])) @ axes
    before = (np.abs(seen[:, :2]) <= reach.half_palm_m).all(axis=1)
    return float(seen[before, 2].min(initial=np.inf))
