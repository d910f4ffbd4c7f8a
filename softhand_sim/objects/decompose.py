"""Convex parts of any mesh: its own hull where that is close enough, else CoACD (cached).

CoACD: X. Wei et al., "Approximate convex decomposition for 3D meshes with collision-aware concavity and
tree search", ACM Transactions on Graphics 41(4), 2022.
"""

import os
import signal
import subprocess
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
import trimesh

from softhand_sim.objects.bodies import without_cavities
from softhand_sim.objects.cache import content_key, read_parts, write_parts
from softhand_sim.objects.coacd_process import COACD_RECIPE
from softhand_sim.objects.geometry import FloatArray, hull
from softhand_sim.objects.mass import is_closed, mass_properties

CONVEX_VOLUME_RATIO = 0.85
"""A closed mesh filling this much of its hull counts as convex.

choice: a scanned tin with a rim fills 0.89, an apple with dimples 0.98, a banana 0.65, a mug 0.26.
"""

HULL_DIRECTIONS = 256
"""Directions whose farthest points make a hull; choice: a 40 mm ball then loses 0.25 mm."""

LONGEST_S = 600
"""Processor time given to a decomposition, whole seconds; choice: twenty times that of a scanned mug. Not the clock's:
whether an object is tried must not depend on what else the machine does."""

LONGEST_WAIT_S = 6000.0
"""Choice: a decomposition that got a tenth of a processor would be done by then; one that hangs without work ends."""

COACD_FACES = 1000
"""Faces the mesh is reduced to first; choice: decomposition time grows faster than linearly with them."""


_OUT_OF_TIME = [getattr(signal, "SIGXCPU", None)]


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
    # slivers have no volume to speak of and upset the engine; choice: a millionth of the hull
    least = 1e-6 * float(mesh.convex_hull.volume)
    solids = [hull(vertices) for vertices in _in_own_process(mesh) if len(vertices) >= 4]
    parts = tuple(solid for solid in solids if solid.volume > least)
    if not parts:
        raise ValueError("the decomposition into convex parts found no solid part")
    return parts


def _in_own_process(mesh: trimesh.Trimesh) -> list[FloatArray]:
    """Return the corners of each part; a mesh that kills or hangs the decomposition costs its own process only."""
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder) / "mesh.npz", Path(folder) / "parts.npz"
        np.savez(given, vertices=mesh.vertices, faces=mesh.faces)
        # the child has to find this package where the parent has found it
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-m", "softhand_sim.objects.coacd_process", str(given), str(found), str(LONGEST_S)]
        try:
            done = subprocess.run(
                command,
                env=environment,
                timeout=LONGEST_WAIT_S,
                capture_output=True,
                check=False,
                stdin=subprocess.DEVNULL,
            )
        except subprocess.TimeoutExpired as error:
            raise ValueError(f"the decomposition into convex parts took longer than {LONGEST_WAIT_S:g} s") from error
        if -done.returncode in _OUT_OF_TIME:
            raise ValueError(f"the decomposition into convex parts took over {LONGEST_S} s of processor time")
        if done.returncode != 0:
            told = done.stderr.decode(errors="replace").strip().splitlines()
            reason = told[-1] if told else "no reason given"
            raise ValueError(f"the decomposition into convex parts failed (status {done.returncode}: {reason})")
        with np.load(found, allow_pickle=False) as data:
            return list(np.split(data["vertices"], np.cumsum(data["counts"])[:-1]))
