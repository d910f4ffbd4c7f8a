"""The grasp that an object gets unasked: the shipped one of its shape, else the scripted one."""

import hashlib
from functools import cache

import numpy as np

from assets import asset_path
from softhand_sim.grasp.choice.grasp_file import GraspFile, KeptGrasp, load_grasps
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.model import ObjectModel

FILE = "catalogue.toml"
# choice: far below any tolerance of a grasp, far above what machines differ by
SAME_M = 1e-6


def default_grasp(model: ObjectModel) -> GraspPlan:
    """Return the grasp of an object that nobody chose one for.

    A shipped grasp belongs to the shape (mass and friction do not count, so a sweep over them keeps it) and to the
    hand's layout; without one, the scripted grasp is returned.
    """
    kept = shipped_grasp(model)
    return plan_grasp(model) if kept is None else kept.plan


def shipped_grasp(model: ObjectModel) -> KeptGrasp | None:
    """Return the shipped grasp of a shape, None if there is none for it or it belongs to another hand."""
    file = shipped_grasps()
    if file.hand_sha256 != hand_sha256(HandAnatomy()):
        return None
    shape = shape_m(model)
    return next((kept for kept in file.grasps.values() if _same(kept.shape_m, shape)), None)


@cache
def shipped_grasps() -> GraspFile:
    """Return the shipped grasps, those of the catalogue's objects; `scripts/choose_grasps.py` makes them anew."""
    return load_grasps(asset_path("grasps", FILE))


def shape_m(model: ObjectModel) -> tuple[float, ...]:
    """Return lengths that tell shapes apart, shape (12,), whatever mass and friction: what a shipped grasp is found by.

    Sides of the bounding box; height of the mass centre at rest; root of the surface's area; the six moments and
    products of inertia per mass, over the longest side; number of convex parts.
    """
    longest = float(model.extents_m.max())
    spread = model.inertia_kg_m2[np.triu_indices(3)] / (model.mass_kg * longest)
    rest, area = model.rest_height_m, float(np.sqrt(model.mesh.area))
    values = (*model.extents_m, rest, area, *spread, len(model.convex_parts))
    return tuple(float(value) for value in values)


def hand_sha256(anatomy: HandAnatomy) -> str:
    """Return the digest of a hand's layout."""
    return hashlib.sha256(repr(anatomy).encode()).hexdigest()


def _same(first: tuple[float, ...], second: tuple[float, ...]) -> bool:
    return len(first) == len(second) and bool(np.allclose(first, second, rtol=0.0, atol=SAME_M))
