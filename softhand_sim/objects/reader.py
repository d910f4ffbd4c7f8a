"""Reading a user's mesh file: checks first, then cleaning and repair."""

from pathlib import Path

import numpy as np
import trimesh

from softhand_sim.objects.mass import is_closed

FORMATS = (".obj", ".stl", ".ply", ".glb", ".gltf", ".off")
SMALLEST_SIDE_M = 0.005
"""Allowed largest side of an object, lower end; choice: smaller than a fingertip's contact patch."""
LARGEST_SIDE_M = 1.0
"""Upper end; choice: five times the length of a hand."""
FLATTEST_SIDE_M = 0.0005
"""Allowed thinnest side; choice: a flat sheet encloses no volume and cannot be a rigid body here."""


def read_triangles(path: Path, scale: float) -> trimesh.Trimesh:
    """Return the triangles of a mesh file in metres, all parts of a scene together, equal vertices merged.

    Parameters
    ----------
    path : Path
    scale : float
        Factor from the file's unit to metres.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no mesh, is empty, holds a coordinate that is not finite, or has an impossible size.
    """
    if not (np.isfinite(scale) and scale > 0.0):
        raise ValueError(f"scale is {scale}, needs a finite number > 0")
    if not path.exists():
        raise FileNotFoundError(f"no mesh file at {path}")
    if not path.is_file():
        raise ValueError(f"{path} is a folder, needs a mesh file")
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: the format {path.suffix!r} is not one of {', '.join(FORMATS)}")
    vertices, faces = _parse(path)
    if not len(faces):
        raise ValueError(f"{path}: the mesh is empty, it holds no triangles")
    bad = int(np.count_nonzero(~np.isfinite(vertices).all(axis=1)))
    if bad:
        raise ValueError(f"{path}: {bad} of {len(vertices)} vertices have a coordinate that is NaN or infinite")
    mesh = trimesh.Trimesh(vertices=vertices * scale, faces=faces, process=False)
    mesh.remove_unreferenced_vertices()
    _check_size(mesh, path)
    mesh.merge_vertices()
    # only triangles that merging has collapsed: dropping thin or doubled ones as well would tear a closed surface
    a, b, c = np.asarray(mesh.faces).T
    mesh.update_faces((a != b) & (b != c) & (c != a))
    mesh.remove_unreferenced_vertices()
    if len(mesh.faces) < 4:
        raise ValueError(f"{path}: {len(mesh.faces)} proper triangles, a solid needs at least 4")
    return mesh


def _parse(path: Path) -> tuple[np.ndarray, np.ndarray]:
    try:
        scene = trimesh.load_scene(path, process=False, maintain_order=True)
        mesh = scene.to_mesh() if scene.geometry else trimesh.Trimesh()
        return np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)
    except Exception as error:  # the parsers of the formats raise whatever they stumble over
        reason = (str(error).strip() or "no reason given").splitlines()[0]
        raise ValueError(f"{path}: not a readable mesh ({type(error).__name__}: {reason})") from error


def _check_size(mesh: trimesh.Trimesh, path: Path) -> None:
    sides = np.asarray(mesh.extents, dtype=np.float64)
    largest, thinnest = float(sides.max()), float(sides.min())
    allowed = f"allowed {SMALLEST_SIDE_M} m to {LARGEST_SIDE_M} m"
    if largest > LARGEST_SIDE_M:
        hint = "probably millimetres; use --scale 0.001" if largest <= 1000 * LARGEST_SIDE_M else "check the units"
        raise ValueError(f"{path}: the largest side is {largest:.4g} m, {allowed}; {hint}")
    if largest < SMALLEST_SIDE_M:
        raise ValueError(f"{path}: the largest side is {largest:.4g} m, {allowed}; check the units or use --scale")
    if thinnest < FLATTEST_SIDE_M:
        raise ValueError(f"{path}: the thinnest side is {thinnest:.4g} m, needs at least {FLATTEST_SIDE_M} m")


def repair(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, tuple[str, ...]]:
    """Return a copy with holes filled and normals outward where needed, and notes on what was done or is left open."""
    if is_closed(mesh) and mesh.volume > 0.0:
        return mesh, ()
    fixed = mesh.copy()
    trimesh.repair.fill_holes(fixed)
    trimesh.repair.fix_normals(fixed, multibody=True)
    if is_closed(fixed) and fixed.volume > 0.0:
        return fixed, ("surface repaired: holes filled, triangles turned outward",)
    return fixed, ("surface stays open after repair: mass centre and inertia are those of the convex parts",)
