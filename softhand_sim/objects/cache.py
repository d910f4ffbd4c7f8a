"""A content-addressed cache of convex parts: one npz (no pickle) a decomposition, in the user's cache folder."""

import hashlib
import logging
import os
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh

from softhand_sim.objects.geometry import surface

_LOG = logging.getLogger(__name__)


def cache_folder() -> Path:
    """Return the cache folder: $SOFTHAND_CACHE, or `softhand-sim` in the platform's cache folder of the user."""
    chosen = os.environ.get("SOFTHAND_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "softhand-sim"


def content_key(mesh: trimesh.Trimesh, recipe: str) -> str:
    """Return the SHA-256 of a mesh's exact vertices and faces and of the recipe applied to it."""
    digest = hashlib.sha256(recipe.encode())
    for array in (np.asarray(mesh.vertices, dtype="<f8"), np.asarray(mesh.faces, dtype="<i8")):
        digest.update(str(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _file(key: str) -> Path:
    return cache_folder() / "convex" / f"{key}.npz"


def read_parts(key: str) -> tuple[trimesh.Trimesh, ...] | None:
    """Return the stored parts, or None if there are none or the file is damaged."""
    path = _file(key)
    try:
        with np.load(path, allow_pickle=False) as data:
            vertices = np.split(data["vertices"], np.cumsum(data["vertex_counts"])[:-1])
            faces = np.split(data["faces"], np.cumsum(data["face_counts"])[:-1])
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        _LOG.warning("cached convex parts %s are damaged and made again: %s", path, error)
        return None
    if not vertices or len(vertices) != len(faces):
        return None
    return tuple(surface(v, f) for v, f in zip(vertices, faces, strict=True))


def write_parts(key: str, parts: Sequence[trimesh.Trimesh]) -> None:
    """Store parts under a key; a cache that cannot be written is logged, not an error."""
    path = _file(key)
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".tmp", delete=False) as file:
            temporary = Path(file.name)
            np.savez_compressed(
                file,
                vertices=np.vstack([part.vertices for part in parts]),
                faces=np.vstack([part.faces for part in parts]),
                vertex_counts=np.array([len(part.vertices) for part in parts], dtype=np.int64),
                face_counts=np.array([len(part.faces) for part in parts], dtype=np.int64),
            )
        temporary.replace(path)
    except OSError as error:
        _LOG.warning("convex parts not cached in %s: %s", path.parent, error)
        if temporary is not None:
            temporary.unlink(missing_ok=True)
