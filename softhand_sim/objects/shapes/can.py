"""Full cans: upright cylinders."""

import numpy as np

from softhand_sim.objects.geometry import SECTORS, Primitive, ShapeGeometry, require_positive, revolve


def cylinder(*, diameter_m: float, height_m: float) -> ShapeGeometry:
    """Return a solid upright cylinder.

    Raises
    ------
    ValueError
        If a length is not positive.
    """
    require_positive(diameter_m=diameter_m, height_m=height_m)
    radius, half = diameter_m / 2.0, height_m / 2.0
    mesh = revolve(np.array([0.0, radius, radius, 0.0]), np.array([-half, -half, half, half]), SECTORS)
    return ShapeGeometry(mesh=mesh, convex_parts=(mesh,), primitive=Primitive(kind="cylinder", size_m=(radius, half)))


KINDS = {"cylinder": cylinder}
