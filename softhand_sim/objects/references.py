"""Files that a mesh file names: they may not lie outside the folder the mesh came from."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

# texture statements of Wavefront's material files; options come before the name
_MAPS = ("map_", "bump", "disp", "decal", "refl", "norm")


def check_inside(name: str, folder: Path, root: Path, source: Path) -> Path:
    """Return the path that `name`, written in `source`, means from `folder`.

    Raises
    ------
    ValueError
        If it leads outside `root`, directly or by a link.
    """
    try:
        target = (folder / name).resolve()
        inside = target.is_relative_to(root.resolve())
    except (OSError, RuntimeError, ValueError) as error:  # endless links, a zero byte
        raise ValueError(f"{source}: names {name!r}, which is no path ({error})") from error
    if not inside:
        raise ValueError(f"{source}: names {name!r}, which lies outside the folder {root}")
    return target


def check_references(path: Path, root: Path) -> None:
    """Make sure that the files a mesh file names, and those that they name, lie inside `root`.

    Knows OBJ with its material files and glTF. STL, PLY, OFF and GLB name no files that are read here.

    Raises
    ------
    ValueError
        If one lies outside; the message names both files.
    """
    if path.suffix.lower() == ".obj":
        for name in _after(path, ("mtllib",)):
            material = check_inside(name, path.parent, root, path)
            if material.is_file():
                for texture in _after(material, _MAPS):
                    check_inside(texture, material.parent, root, material)
    elif path.suffix.lower() == ".gltf":
        for uri in _uris(path):
            check_inside(unquote(uri), path.parent, root, path)


def _after(path: Path, statements: tuple[str, ...]) -> Iterator[str]:
    """Yield the file names of the lines of a text file that begin with one of the statements."""
    with path.open(encoding="utf-8", errors="replace") as lines:
        for line in lines:
            words = line.split()
            if len(words) > 1 and words[0].lower().startswith(statements):
                # a name with blanks in it is the rest of the line; with options before it, the last word
                rest = line.strip()[len(words[0]) :].strip()
                yield words[-1] if rest.startswith("-") else rest


def _uris(path: Path) -> Iterator[str]:
    try:
        data: Any = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ValueError(f"{path}: not a readable mesh (glTF that is no JSON: {error})") from error
    for key in ("buffers", "images"):
        entries = data.get(key, []) if isinstance(data, dict) else []
        for entry in entries if isinstance(entries, list) else []:
            uri = entry.get("uri") if isinstance(entry, dict) else None
            if isinstance(uri, str) and not uri.startswith("data:"):
                yield uri
