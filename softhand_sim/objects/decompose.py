"""Convex parts of any mesh: its own hull where that is close enough, else CoACD (cached).

CoACD: X. Wei et al., "Approximate convex decomposition for 3D meshes with collision-aware concavity and
tree search", ACM Transactions on Graphics 41(4), 2022.
"""

from importlib.metadata import version

import coacd
import numpy as np
import trimesh

from softhand_sim.objects.bodies import without_cavities
from softhand_sim.objects.cache import content_key, read_parts, write_parts
from softhand_sim.objects.geometry import FloatArray, hull
from softhand_sim.objects.mass import is_closed, mass_properties

CONVEX_VOLUME_RATIO = 0.85
"""A closed mesh filling this much of its hull counts as convex.

choice: a scanned tin with a rim fills 0.89, an apple with dimples 0.98, a banana 0.65, a mug 0.26.
"""

HULL_DIRECTIONS = 256
"""Directions whose farthest points make a hull; choice: a 40 mm ball then loses 0.25 mm."""

COACD_FACES = 1000
"""Faces the mesh is reduced to first; choice: decomposition time grows faster than linearly with them."""

COACD_RECIPE: dict[str, float | int | str | bool] = {
    # choice: of the settings tried on a scanned mug and cup among the fastest (20 to 30 s instead of 90 s) at the same
    # number of parts, their volume within 10 % on the mug and 1 % on the cup; a scanned banana takes 1 s
    "threshold": 0.1,  # concavity allowed, relative to the size
    "max_convex_hull": 24,  # choice: more parts slow each contact search
    "preprocess_mode": "auto",  # remeshes what is not manifold
    "preprocess_resolution": 30,
    "resolution": 500,
    "mcts_nodes": 10,
    "mcts_iterations": 20,
    "mcts_max_depth": 3,
    "decimate": True,
    "max_ch_vertex": 64,
    "seed": 0,
}


def reduced_hull(points: FloatArray) -> trimesh.Trimesh:
    """Return the hull of the points, shape (n, 3), farthest in HULL_DIRECTIONS evenly spread directions."""
    corners = np.asarray(hull(points).vertices)
    if len(corners) > HULL_DIRECTIONS:
        # Fibonacci lattice on the sphere
        i = np.arange(HULL_DIRECTIONS)
        z = 1.0 - (2.0 * i + 1.0) / HULL_DIRECTIONS
        turn = np.pi * (3.0 - np.sqrt(5.0)) * i
        radius = np.sqrt(1.0 - z * z)
        directions = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])
        corners = corners[np.unique(np.argmax(directions @ corners.T, axis=1))]
    return hull(corners)


def is_nearly_convex(mesh: trimesh.Trimesh) -> bool:
    """Return whether a closed mesh fills CONVEX_VOLUME_RATIO of its hull; an open mesh never counts as convex."""
    if not is_closed(mesh):
        return False
    outer = mass_properties(mesh.convex_hull).volume_m3
    return mass_properties(mesh).volume_m3 >= CONVEX_VOLUME_RATIO * outer


def reduced(mesh: trimesh.Trimesh, faces: int) -> trimesh.Trimesh:
    """Return the mesh with at most this many faces (quadric edge collapse)."""
    if len(mesh.faces) <= faces:
        return mesh
    return mesh.simplify_quadric_decimation(face_count=faces)


def convex_parts(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, ...]:
    """Return convex solids, as closed meshes, that together stand for the mesh; cavities inside it are filled.

    Raises
    ------
    ValueError
        If the decomposition fails.
    """
    mesh = without_cavities(mesh)
    if is_nearly_convex(mesh):
        return (reduced_hull(np.asarray(mesh.vertices)),)
    small = reduced(mesh, COACD_FACES)
    recipe = f"coacd {version('coacd')} {sorted(COACD_RECIPE.items())}"
    key = content_key(small, recipe)
    parts = read_parts(key)
    if parts is None:
        parts = _run_coacd(small)
        write_parts(key, parts)
    return parts


def _run_coacd(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, ...]:
    coacd.set_log_level("off")
    found = coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.faces), **COACD_RECIPE)
    # slivers have no volume to speak of and upset the engine; choice: a millionth of the hull
    least = 1e-6 * float(mesh.convex_hull.volume)
    solids = [hull(vertices) for vertices, _ in found if len(vertices) >= 4]
    parts = tuple(solid for solid in solids if solid.volume > least)
    if not parts:
        raise ValueError("the decomposition into convex parts found no solid part")
    return parts
