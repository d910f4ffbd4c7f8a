"""Markers and screwdrivers: a thick round piece and a thin one on one lying axis."""

import numpy as np

from softhand_sim.objects.geometry import (
    HULL_SECTORS,
    SECTORS,
    FloatArray,
    ShapeGeometry,
    hull,
    require_positive,
    tube,
)
from softhand_sim.objects.resting import laid_down


def rod(
    *, thick_diameter_m: float, thick_length_m: float, thin_diameter_m: float, thin_length_m: float
) -> ShapeGeometry:
    """Return a solid of two coaxial cylinders lying along x, the thin one towards +x.

    Raises
    ------
    ValueError
        If a length is not positive, or the thin piece is not the thinner one.
    """
    require_positive(**dict(locals()))
    if not thin_diameter_m < thick_diameter_m:
        raise ValueError(f"thin_diameter_m is {thin_diameter_m}, needs < thick_diameter_m {thick_diameter_m}")
    ends = (0.0, thick_length_m, thick_length_m, thick_length_m + thin_length_m)
    radii = (thick_diameter_m / 2.0,) * 2 + (thin_diameter_m / 2.0,) * 2

    def rings(sides: int) -> FloatArray:
        """Return the four edge circles from -x to +x, anticlockwise seen from +x, a flat side down."""
        around = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False) + np.pi / sides - np.pi / 2.0
        circle = np.column_stack([np.zeros(sides), np.cos(around), np.sin(around)])
        return np.stack([r * circle + np.array([x, 0.0, 0.0]) for x, r in zip(ends, radii, strict=True)])

    fine, coarse = rings(SECTORS), rings(HULL_SECTORS)
    mesh = tube((0.0, 0.0, 0.0), fine, (ends[-1], 0.0, 0.0))
    parts = (hull(coarse[:2].reshape(-1, 3)), hull(coarse[2:].reshape(-1, 3)))
    return laid_down(ShapeGeometry(mesh=mesh, convex_parts=parts))


KINDS = {"rod": rod}
