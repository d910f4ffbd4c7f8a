"""Reading a user's mesh file: checks first, then cleaning and repair."""

from pathlib import Path

import numpy as np
import trimesh

from softhand_sim.objects.bodies import one_body
from softhand_sim.objects.mass import is_closed, signed_volume_m3
from softhand_sim.objects.references import check_references

FORMATS = (".obj", ".stl", ".ply", ".glb", ".gltf", ".off")
SMALLEST_SIDE_M = 0.005
"""Allowed largest side of an object, lower end; choice: smaller than a fingertip's contact patch."""
LARGEST_SIDE_M = 1.0
"""Upper end; choice: five times the length of a hand."""
FLATTEST_SIDE_M = 0.0005
"""Allowed thinnest side; choice: a flat sheet encloses no volume and cannot be a rigid body here."""
LARGEST_BYTES = 500_000_000
"""Choice: ten million triangles of binary STL."""
EMPTY_VOLUME_RATIO = 1e-4
"""A closed surface with less than this share of its hull's volume is empty; choice: a paper bag of 0.1 mm has 4e-3."""


def read_triangles(path: Path, scale: float, root: Path | None = None) -> trimesh.Trimesh:
    """Return the triangles of a mesh file in metres, all parts of a scene together, equal vertices merged.

    Parameters
    ----------
    path : Path
    scale : float
        Factor from the file's unit to metres.
    root : Path, optional
        Folder that the file and those it names may not leave; by default the file's own.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no mesh, is empty or too large, holds a coordinate that is not finite, has an impossible size, or
        names a file outside `root`.
    """
    if not (np.isfinite(scale) and scale > 0.0):
        raise ValueError(f"scale is {scale}, needs a finite number > 0")
    if not path.exists():
        raise FileNotFoundError(f"no mesh file at {path}")
    if not path.is_file():
        raise ValueError(f"{path} is a folder, needs a mesh file")
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: the format {path.suffix!r} is not one of {', '.join(FORMATS)}")
    if path.stat().st_size > LARGEST_BYTES:
        raise ValueError(f"{path}: {path.stat().st_size} bytes, allowed {LARGEST_BYTES}")
    check_references(path, path.parent if root is None else root)
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
    _check_flat(mesh, path)
    # only triangles that merging has collapsed: dropping thin or doubled ones as well would tear a closed surface
    a, b, c = np.asarray(mesh.faces).T
    mesh.update_faces((a != b) & (b != c) & (c != a))
    mesh.remove_unreferenced_vertices()
    if len(mesh.faces) < 4:
        raise ValueError(f"{path}: {len(mesh.faces)} proper triangles, a solid needs at least 4")
    return mesh


def _parse(path: Path) -> tuple[np.ndarray, np.ndarray]:
    try:
        # materials and textures are never read
        scene = trimesh.load_scene(path, process=False, maintain_order=True, skip_materials=True)
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


def _check_flat(mesh: trimesh.Trimesh, path: Path) -> None:
    """Refuse a sheet that lies askew in its box, and triangles that all lie on one line."""
    points = np.asarray(mesh.vertices) - np.asarray(mesh.vertices).mean(axis=0)
    _, axes = np.linalg.eigh(points.T @ points)
    thinnest = float(np.ptp(points @ axes[:, 0]))
    if thinnest < FLATTEST_SIDE_M:
        raise ValueError(f"{path}: flat, {thinnest:.4g} m across, needs at least {FLATTEST_SIDE_M} m")


def repair(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, tuple[str, ...]]:
    """Return one body: holes filled and normals outward where needed, and notes on what was done or is left open.

    Raises
    ------
    ValueError
        If the mesh holds bodies that do not touch, or a closed surface encloses no volume.
    """
    notes: tuple[str, ...] = ()
    # the whole first: a cavity of a surface that is inside out looks like a body
    if is_closed(mesh) and signed_volume_m3(mesh) < 0.0:
        mesh = mesh.copy()
        mesh.invert()
        notes = ("surface repaired: triangles turned outward",)
    mesh, more = one_body(mesh)
    notes = (*notes, *more)
    if is_closed(mesh):
        enclosed = signed_volume_m3(mesh)
        if enclosed < EMPTY_VOLUME_RATIO * float(mesh.convex_hull.volume):
            raise ValueError(f"the closed surface encloses no volume ({enclosed:.3g} m3)")
        return mesh, notes
    fixed = mesh.copy()
    trimesh.repair.fill_holes(fixed)
    trimesh.repair.fix_normals(fixed, multibody=True)
    if is_closed(fixed) and signed_volume_m3(fixed) > 0.0:
        return fixed, (*notes, "surface repaired: holes filled, triangles turned outward")
    return fixed, (*notes, "surface stays open after repair: mass centre and inertia are those of the convex parts")
