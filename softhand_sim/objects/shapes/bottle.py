"""Full squeeze bottles: an oval body, a shoulder, a round neck with its cap."""

import numpy as np

from softhand_sim.objects.geometry import SECTORS, FloatArray, ShapeGeometry, hull, require_positive, tube


def bottle(
    *,
    depth_m: float,
    width_m: float,
    height_m: float,
    body_height_m: float,
    neck_height_m: float,
    neck_diameter_m: float,
) -> ShapeGeometry:
    """Return a solid bottle standing upright, axis z, its oval body `depth_m` along x and `width_m` along y.

    The body's section is an ellipse up to `body_height_m`; the shoulder passes to the neck's circle linearly up to the
    neck, the topmost `neck_height_m`. With half axes a, b and neck radius c the shoulder of height h holds
    pi h (2 a b + (a + b) c + 2 c^2) / 6.

    Raises
    ------
    ValueError
        If a length is not positive or the parts do not fit together.
    """
    require_positive(**dict(locals()))
    if not body_height_m + neck_height_m < height_m:
        raise ValueError(f"body_height_m {body_height_m} and neck_height_m {neck_height_m} leave no shoulder")
    if not neck_diameter_m <= min(depth_m, width_m):
        raise ValueError(f"neck_diameter_m is {neck_diameter_m}, needs <= depth_m {depth_m} and width_m {width_m}")

    def oval(depth: float, width: float, z: float) -> FloatArray:
        angle = np.linspace(0.0, 2.0 * np.pi, SECTORS, endpoint=False)
        return np.column_stack([depth / 2.0 * np.cos(angle), width / 2.0 * np.sin(angle), np.full(SECTORS, z)])

    neck = (neck_diameter_m, neck_diameter_m)
    rings = np.stack(
        [
            oval(depth_m, width_m, 0.0),
            oval(depth_m, width_m, body_height_m),
            oval(*neck, height_m - neck_height_m),
            oval(*neck, height_m),
        ]
    )
    parts = tuple(hull(rings[i : i + 2].reshape(-1, 3)) for i in range(3))
    return ShapeGeometry(mesh=tube((0.0, 0.0, 0.0), rings, (0.0, 0.0, height_m)), convex_parts=parts)


KINDS = {"bottle": bottle}
