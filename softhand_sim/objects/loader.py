"""Any mesh file as a graspable object."""

from pathlib import Path

import numpy as np
import trimesh

from softhand_sim.objects.decompose import convex_parts, reduced
from softhand_sim.objects.geometry import ShapeGeometry
from softhand_sim.objects.mass import MassProperties, combined, is_closed, mass_properties, signed_volume_m3
from softhand_sim.objects.model import DEFAULT_FRICTION, ObjectModel, build_object, check_friction, check_mass
from softhand_sim.objects.reader import read_triangles, repair
from softhand_sim.objects.resting import resting_rotation, turned

WORKING_FACES = 100_000
"""A finer mesh is reduced first; choice: edges of 1 mm on a mug, seconds instead of a minute for a million."""
VISUAL_FACES = 4000
"""Faces kept for pictures; choice: finer than a pixel at the sizes rendered here."""


def load_mesh_object(
    path: str | Path,
    *,
    mass_kg: float,
    friction: float = DEFAULT_FRICTION,
    scale: float = 1.0,
    name: str | None = None,
    keep_upright: bool = False,
    root: Path | None = None,
) -> ObjectModel:
    """Return an object from an OBJ, STL, PLY, GLB, glTF or OFF file.

    The mesh is checked, repaired, split into convex parts (cached), laid down in its most probable resting
    pose and moved to its mass centre. Mass centre and inertia are those of the enclosed solid at uniform
    density, or of the convex parts if the surface stays open.

    Parameters
    ----------
    path : str or Path
    mass_kg : float
    friction : float
    scale : float
        Factor from the file's unit to metres.
    name : str, optional
        Default: the file's name without its ending.
    keep_upright : bool
        Take the stable pose nearest to the file's own (z up) instead of the most probable one: a mug then stands.
    root : Path, optional
        Folder that neither the file nor a file it names may leave; by default the file's own.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If mass, friction or scale is impossible, or the file holds no usable mesh of a possible size.
    """
    path = Path(path)
    check_mass(mass_kg)
    check_friction(friction)
    mesh = read_triangles(path, scale, root)
    try:
        mesh, notes = _worked_up(mesh)
        parts = convex_parts(mesh)
        properties = mass_properties(mesh) if is_closed(mesh) and signed_volume_m3(mesh) > 0.0 else combined(parts)
        turn = resting_rotation(np.vstack([part.vertices for part in parts]), properties.centre_m, keep_upright)
    except (ValueError, RuntimeError) as error:  # qhull and the decomposition raise RuntimeError
        reason = (str(error).strip() or "no reason given").splitlines()[0]
        raise ValueError(f"{path}: {reason}") from error
    if len(mesh.faces) > VISUAL_FACES:
        notes = (*notes, f"picture reduced from {len(mesh.faces)} to {VISUAL_FACES} triangles")
    visual = reduced(mesh, VISUAL_FACES)
    return build_object(
        ShapeGeometry(mesh=turned(visual, turn), convex_parts=tuple(turned(part, turn) for part in parts)),
        name=path.stem if name is None else name,
        kind="mesh",
        mass_kg=mass_kg,
        friction=friction,
        properties=MassProperties(
            volume_m3=properties.volume_m3,
            centre_m=turn @ properties.centre_m,
            inertia_m5=turn @ properties.inertia_m5 @ turn.T,
        ),
        notes=notes,
    )


def _worked_up(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, tuple[str, ...]]:
    """Return the mesh repaired, and first reduced if it is finer than anything here can see; and notes."""
    if len(mesh.faces) <= WORKING_FACES:
        return repair(mesh)
    coarse = reduced(mesh, WORKING_FACES)
    fixed, notes = repair(coarse)
    return fixed, (f"reduced from {len(mesh.faces)} to {len(coarse.faces)} triangles", *notes)
