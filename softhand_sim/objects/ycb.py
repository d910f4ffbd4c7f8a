"""The YCB object set as downloaded: which meshes a folder holds, and what the catalogue knows of them.

B. Calli et al., "Benchmarking in Manipulation Research: Using the Yale-CMU-Berkeley Object and Model Set", IEEE
Robotics & Automation Magazine 22(3), 2015. One folder an object, such as ``013_apple``, with the scans below it.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softhand_sim.objects.catalogue import CatalogueEntry, load_catalogue
from softhand_sim.objects.loader import load_mesh_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.objects.references import check_inside

INDEX = "objects.json"
"""The set's list of objects, ``{"objects": ["001_chips_can", ...]}``; without it every subfolder is one."""
SCANS = (
    "google_16k/textured.obj",
    "google_16k/nontextured.stl",
    "google_16k/nontextured.ply",
    "textured.obj",
    "nontextured.stl",
    "nontextured.ply",
    "poisson/nontextured.stl",
    "poisson/nontextured.ply",
    "tsdf/nontextured.stl",
    "tsdf/nontextured.ply",
)
"""Where an object's mesh may lie, best first."""


def ycb_names(folder: Path) -> tuple[str, ...]:
    """Return the objects of a YCB folder, by its index if there is one, else its subfolders in order.

    Raises
    ------
    FileNotFoundError
        If there is no such folder.
    ValueError
        If the index is not of the set's form, or there are no objects.
    """
    if not folder.is_dir():
        raise FileNotFoundError(f"no YCB folder at {folder}")
    index = folder / INDEX
    if index.is_file():
        try:
            data: Any = json.loads(index.read_text(encoding="utf-8"))
        except (UnicodeDecodeError, json.JSONDecodeError) as error:
            raise ValueError(f"{index}: not a JSON file: {error}") from error
        names = data.get("objects") if isinstance(data, dict) else None
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ValueError(f'{index}: needs {{"objects": [names]}}')
    else:
        names = sorted(entry.name for entry in folder.iterdir() if entry.is_dir() and not entry.name.startswith("."))
    if not names:
        raise ValueError(f"{folder}: holds no objects")
    return tuple(dict.fromkeys(names))


def ycb_mesh(folder: Path, name: str) -> Path:
    """Return the best mesh file of one object.

    Raises
    ------
    FileNotFoundError
        If the object's folder or mesh is missing.
    ValueError
        If the name or a link leads outside the folder.
    """
    home = check_inside(name, folder, folder, folder / INDEX)
    if not home.is_dir():
        raise FileNotFoundError(f"no folder of the object {name!r} at {folder}")
    found = next((folder / name / scan for scan in SCANS if (folder / name / scan).is_file()), None)
    if found is None:
        raise FileNotFoundError(f"{folder / name}: no mesh; looked for {', '.join(SCANS)}")
    check_inside(found.name, found.parent, folder, folder / name)
    return found


def load_ycb_object(
    folder: Path,
    name: str,
    *,
    mass_kg: float | None = None,
    friction: float | None = None,
    catalogue: Mapping[str, CatalogueEntry] | None = None,
) -> ObjectModel:
    """Return one object of a YCB folder, standing in the stable pose nearest to its scan's.

    Parameters
    ----------
    folder : Path
    name : str
        Such as ``013_apple``.
    mass_kg, friction : float, optional
        Overrides; by default those of the catalogue's object with this YCB identifier.
    catalogue : mapping, optional
        By default the shipped one.

    Raises
    ------
    FileNotFoundError
        If the object's folder or mesh is missing.
    ValueError
        If the mass is unknown, a path leads outside the folder, or the mesh is unusable.
    """
    path = ycb_mesh(folder, name)
    entries = load_catalogue() if catalogue is None else catalogue
    known = next((entry for entry in entries.values() if entry.ycb == name), None)
    if mass_kg is None and known is None:
        raise ValueError(f"{path}: the catalogue has no mass of {name!r}; give one (--mass)")
    mass = mass_kg if mass_kg is not None or known is None else known.mass_kg
    assert mass is not None
    extra: dict[str, Any] = {}
    if friction is not None:
        extra["friction"] = friction
    elif known is not None:
        extra["friction"] = known.friction
    return load_mesh_object(path, mass_kg=mass, name=name, keep_upright=True, root=folder, **extra)
