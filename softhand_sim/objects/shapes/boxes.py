"""Boxes with sharp or rounded upright edges."""

import numpy as np

from softhand_sim.objects.geometry import Primitive, ShapeGeometry, hull, require_positive

ARC_STEPS = 8  # choice: an edge rounded with 20 mm is then within 0.1 mm of its arc


def box(*, depth_m: float, width_m: float, height_m: float) -> ShapeGeometry:
    """Return a solid box with sides along x, y, z.

    Raises
    ------
    ValueError
        If a length is not positive.
    """
    require_positive(depth_m=depth_m, width_m=width_m, height_m=height_m)
    half = (depth_m / 2.0, width_m / 2.0, height_m / 2.0)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(half)
    mesh = hull(corners)
    return ShapeGeometry(mesh=mesh, convex_parts=(mesh,), primitive=Primitive(kind="box", size_m=half))


def rounded_box(*, depth_m: float, width_m: float, height_m: float, edge_radius_m: float) -> ShapeGeometry:
    """Return a solid box with sides along x, y, z whose four upright edges are rounded.

    Volume (depth width - (4 - pi) edge_radius^2) height.

    Raises
    ------
    ValueError
        If a length is not positive, or the radius is more than half of the smaller horizontal side.
    """
    require_positive(depth_m=depth_m, width_m=width_m, height_m=height_m, edge_radius_m=edge_radius_m)
    if edge_radius_m > min(depth_m, width_m) / 2.0:
        raise ValueError(f"edge_radius_m is {edge_radius_m}, needs <= half of depth_m {depth_m} and width_m {width_m}")
    quarter = np.linspace(0.0, np.pi / 2.0, ARC_STEPS + 1)
    corner = np.column_stack([np.cos(quarter), np.sin(quarter)]) * edge_radius_m
    corner += np.array([depth_m, width_m]) / 2.0 - edge_radius_m
    outline = np.vstack([corner * (x, y) for x in (-1, 1) for y in (-1, 1)])
    half = height_m / 2.0
    mesh = hull(np.vstack([np.column_stack([outline, np.full(len(outline), z)]) for z in (-half, half)]))
    return ShapeGeometry(mesh=mesh, convex_parts=(mesh,))


KINDS = {"box": box, "rounded_box": rounded_box}
