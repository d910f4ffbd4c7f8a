"""Grasp poses proposed from an object's shape: fingers against thumb from above, around it, leaning over."""

import itertools
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.grasp.choice.antipodal import AntipodalPairs, antipodal_pairs
from softhand_sim.grasp.choice.oblique import PUSH_M, from_anywhere
from softhand_sim.grasp.choice.reach import TABLE_GAP_M, TABLE_PRESS_M, HandReach
from softhand_sim.grasp.plan import FIRM_ANGLE_DEG, GraspPlan, pose_of_palm
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]

# choice: enough to find the sides of forty objects; a line costs 0.2 ms on a mesh of 5000 triangles
PAIR_SAMPLES = 256
# choice: pairs within half of the friction; one on the edge of the cone has none left for the weight
CONE_SHARE = 0.5
# choice: in the plane across the way in, pairs may lie askew by as much as friction 0.8 allows at both ends
ASKEW = np.sin(np.arctan(0.8))
# choice: furthest that the palm stays away from an object
AWAY_M = 0.030
# choice: spread of what the shape does not tell
JITTER_M, JITTER_RAD = 0.010, 0.15
# choice: a pulse of the valves, 2 kPa, below the 80 kPa that the shipped finger is calibrated to; 4 % more thrust than
# 95 degrees
FIRMEST_ANGLE_DEG = 100.0
# choice: the thumb closes firmly always
SOFT_ANGLES_DEG = (70.0, 85.0)


def candidates(
    model: ObjectModel, calibration: FingerCalibration, anatomy: HandAnatomy, rng: np.random.Generator
) -> Iterator[GraspPlan]:
    """Yield grasp poses without end: from above, from the side, leaning over; more of them never change the first ones.

    The first one is the scripted grasp.

    Half of them put thumb and fingers at an antipodal pair of surface points, half at the mass centre along one of the
    body's main directions.

    Parameters
    ----------
    model: the object, as it rests, mass centre above the world's origin.
    calibration, anatomy: of the hand.
    rng: draws surface points and what the shape does not tell.
    """
    reach = HandReach.of(calibration, anatomy)
    pairs = antipodal_pairs(
        model.mesh, rng, samples=PAIR_SAMPLES, friction=CONE_SHARE * model.friction, widest_m=reach.opening_m
    )
    level = np.flatnonzero(np.abs(pairs.direction[:, 2]) < ASKEW)
    _, main = np.linalg.eigh(model.inertia_kg_m2[:2, :2])
    yield plan_grasp(model)
    number = 0
    while True:
        if len(level) and number // len(_FAMILIES) % 2 == 0:
            anchor, across = _near_centre(pairs, level, rng)
        else:
            anchor, across = np.zeros(3), np.append(main[:, rng.integers(2)], 0.0)
        across = across * rng.choice((-1.0, 1.0))
        turn = np.arctan2(across[1], across[0]) + rng.normal(0.0, JITTER_RAD)
        yield _FAMILIES[number % len(_FAMILIES)](model, reach, anchor, turn, rng)
        number += 1


def some(plans: Iterator[GraspPlan], count: int) -> list[GraspPlan]:
    """Return the first `count` of them."""
    return list(itertools.islice(plans, count))


def _near_centre(
    pairs: AntipodalPairs, level: npt.NDArray[np.int64], rng: np.random.Generator
) -> tuple[Vector, Vector]:
    """Draw a pair, those nearer to the mass centre more often: a hold beside it lets the object tilt."""
    middle = pairs.middle_m[level]
    weight = np.exp(-0.5 * (np.linalg.norm(middle[:, :2], axis=1) / (2.0 * JITTER_M)) ** 2) + 1e-3
    chosen = level[rng.choice(len(level), p=weight / weight.sum())]
    return pairs.middle_m[chosen], pairs.direction[chosen]


def _from_above(
    model: ObjectModel, reach: HandReach, anchor: Vector, turn_rad: float, rng: np.random.Generator
) -> GraspPlan:
    """Palm down, thumb and fingers on either side of the anchor along the direction `turn_rad`."""
    top_m = float(model.mesh.bounds[1, 2]) + model.rest_height_m
    lowest = max(top_m + 0.002, reach.depth_m - TABLE_PRESS_M)
    height = lowest + rng.uniform(0.0, 1.0) ** 2 * AWAY_M
    tilt = rng.normal(0.0, JITTER_RAD, size=2)
    axes = _turned(turn_rad) @ _tilted_down(*tilt)
    shift = anchor[:2] + rng.normal(0.0, 0.5 * JITTER_M, size=2)
    # the palm's centre lies behind the middle of the opening, and above it as the palm is tilted
    middle = np.array([shift[0], shift[1], height])
    place = middle - reach.centre_m * axes[:, 0] - 0.5 * reach.depth_m * (axes[:, 2] + [0.0, 0.0, 1.0])
    return _plan(place, axes, (0.0, 0.0, 1.0), rng)


def _from_the_side(
    model: ObjectModel, reach: HandReach, anchor: Vector, turn_rad: float, rng: np.random.Generator
) -> GraspPlan:
    """Palm upright, its little finger lowest, thumb and fingers on either side along the direction `turn_rad`."""
    tilt = rng.normal(0.0, JITTER_RAD)
    axes = _turned(turn_rad) @ _upright(tilt)
    inward = _turned(turn_rad) @ np.array([0.0, -1.0, 0.0])
    near_m = float((np.asarray(model.mesh.vertices) @ inward).min())
    gap = rng.uniform(-PUSH_M, AWAY_M) if rng.uniform() < 0.5 else rng.uniform(-PUSH_M, 0.0)
    top_m = float(model.mesh.bounds[1, 2]) + model.rest_height_m
    lowest = reach.half_width_m * np.cos(tilt) + TABLE_GAP_M
    height = rng.uniform(lowest, max(lowest, min(top_m, model.rest_height_m + anchor[2] + 0.02)))
    along = axes[:, 0] * [1.0, 1.0, 0.0]
    sideways = float(anchor @ along) - reach.centre_m + rng.normal(0.0, 0.5 * JITTER_M)
    place = sideways * along + (near_m - gap) * inward
    place[2] = height
    return _plan(place, axes, tuple(-inward), rng)


def _leaning(
    model: ObjectModel, reach: HandReach, anchor: Vector, turn_rad: float, rng: np.random.Generator
) -> GraspPlan:
    """Palm leaning over in any direction."""
    place, axes, retreat = from_anywhere(model, reach, anchor, turn_rad, rng)
    return _plan(place, axes, tuple(float(v) for v in retreat), rng)


_FAMILIES = (_from_above, _from_the_side, _leaning)


def _plan(place: Vector, axes: Vector, retreat: tuple[float, ...], rng: np.random.Generator) -> GraspPlan:
    return GraspPlan(wrist_pose=pose_of_palm(place, axes), retreat=retreat, set_angle_deg=set_angles_deg(rng))


def set_angles_deg(rng: np.random.Generator) -> tuple[float, ...]:
    """Draw set angles: firm ones, in half of the draws the four fingers softer, against the one thumb."""
    firm = float(rng.choice((FIRM_ANGLE_DEG, FIRMEST_ANGLE_DEG)))
    long_fingers = float(rng.choice(SOFT_ANGLES_DEG)) if rng.uniform() < 0.5 else firm
    return firm, long_fingers, long_fingers


def _turned(angle_rad: float) -> Vector:
    """Turn about the vertical, shape (3, 3)."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _tilted_down(pitch_rad: float, roll_rad: float) -> Vector:
    """Return the axes of a palm that looks down, tilted about its y and x axes, shape (3, 3)."""
    down = np.diag([1.0, -1.0, -1.0])
    cp, sp, cr, sr = np.cos(pitch_rad), np.sin(pitch_rad), np.cos(roll_rad), np.sin(roll_rad)
    pitch = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    roll = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    return np.asarray(pitch @ roll @ down)


def _upright(tilt_rad: float) -> Vector:
    """Return the axes of a palm that looks to -y, index finger up, leaning over by `tilt_rad`, shape (3, 3)."""
    c, s = np.cos(tilt_rad), np.sin(tilt_rad)
    return np.array([[1.0, 0.0, 0.0], [0.0, -s, -c], [0.0, c, -s]])
