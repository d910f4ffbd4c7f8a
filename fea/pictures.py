"""Pictures of the deformed half model coloured by strain, and of curves; needs matplotlib (extra ``plots``)."""

import os
from pathlib import Path
from typing import Any

import numpy as np

from fea.arrays import F64
from fea.lattice import SolidMesh, free_faces

# each six-node face is drawn as four flat triangles
_QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
_LIGHT = np.array([0.35, -0.75, 0.55])
# the half model seen from the cut (y = 0), from the palm side and a little from the tip
_VIEW = np.array([-0.35, 1.0, 0.18])


def draw_half_model(path: Path, mesh: SolidMesh, u_m: F64, strain: F64, *, title: str, top: float) -> None:
    """Draw the surface at a displacement [n_nodes, 3], coloured by a node field [n_nodes] from 0 to ``top``."""
    faces = free_faces(mesh, lambda c: np.ones(c.shape[:-1], dtype=bool))
    triangles = faces[:, _QUARTERS].reshape(-1, 3)
    x = mesh.points_m + u_m
    forward = _VIEW / np.linalg.norm(_VIEW)
    across = np.array([0.0, 0.0, 1.0]) - forward[2] * forward
    across /= np.linalg.norm(across)
    up = np.cross(across, forward)
    corners = x[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    seen = -(normal @ forward) < 0.0  # faces' normals point into the solid
    order = np.flatnonzero(seen)[np.argsort(-(corners[seen].mean(axis=1) @ forward))]
    flat = 1e3 * np.stack([corners[order] @ across, corners[order] @ up], axis=-1)
    light = 0.72 + 0.28 * np.clip(-normal[order] @ (_LIGHT / np.linalg.norm(_LIGHT)), 0.0, 1.0)
    _draw(path, flat, strain[triangles[order]].mean(axis=1), light, title, top)


def _draw(path: Path, flat: F64, values: F64, light: F64, title: str, top: float) -> None:
    from matplotlib import cm, colormaps, colors  # noqa: PLC0415 - optional dependency
    from matplotlib.collections import PolyCollection  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    span = high - low
    figure = Figure(figsize=(9.0, 1.6 + 8.0 * min(1.4, max(0.12, span[1] / span[0]))), dpi=130)
    axes = figure.subplots()
    norm = colors.Normalize(0.0, max(top, 1e-9))
    colours = colormaps["viridis"](norm(values))
    colours[:, :3] *= light[:, None]
    axes.add_collection(PolyCollection(list(flat), facecolors=colours, edgecolors=colours, linewidths=0.2))
    margin = 0.03 * span.max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("mm")
    axes.set_title(title)
    mappable = cm.ScalarMappable(norm=norm, cmap="viridis")
    figure.colorbar(mappable, ax=axes, label="von Mises strain", shrink=0.9, pad=0.02)
    _save(figure, path)


def draw_curves(path: Path, x: F64, curves: dict[str, F64], *, x_label: str, y_label: str) -> None:
    """Draw labelled curves over one abscissa."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency

    figure = Figure(figsize=(6.0, 4.0), dpi=130)
    axes = figure.subplots()
    for label, y in curves.items():
        axes.plot(x, y, marker="o", markersize=3, label=label)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.grid(alpha=0.3)
    if len(curves) > 1:
        axes.legend()
    _save(figure, path)


def _save(figure: Any, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{os.getpid()}.{path.name}")
    figure.savefig(partial, bbox_inches="tight")
    partial.replace(path)
