"""Bananas: tapered arcs."""

import numpy as np

from softhand_sim.objects.geometry import SECTORS, FloatArray, ShapeGeometry, hull, require_positive, tube

BANANA_PARTS = 6  # choice: an 18 degree piece of the arc bulges about 1.2 mm over its hollow side


def banana(*, length_m: float, diameter_m: float, arc_radius_m: float, taper_exponent: float) -> ShapeGeometry:
    """Return a banana lying on its side: tips at +-x, outer bulge to +y, flat underside.

    Circular sections of radius w(u) = (diameter/2) sqrt(1 - |u|^p), u from -1 to 1 along a circular arc of
    `arc_radius_m` whose chord is `length_m`; each stands normal to the arc and is lowered onto the table.
    By Pappus the volume is pi (diameter/2)^2 L p/(p+1) with L the length of the arc (the lowering is within
    the section's plane).

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    require_positive(length_m=length_m, diameter_m=diameter_m, arc_radius_m=arc_radius_m)
    if not length_m / 2.0 < arc_radius_m:
        raise ValueError(f"arc_radius_m is {arc_radius_m}, needs > half of length_m {length_m}")
    if not diameter_m < arc_radius_m:
        raise ValueError(f"diameter_m is {diameter_m}, needs < arc_radius_m {arc_radius_m}")
    if not 1.0 <= taper_exponent <= 10.0:
        raise ValueError(f"taper_exponent is {taper_exponent}, allowed 1 to 10")
    half_angle = np.arcsin(length_m / 2.0 / arc_radius_m)

    def rings(u: FloatArray, sides: int) -> FloatArray:
        """Return sections at the stations u, shape (m,), as (m, sides, 3); seen from +x they run anticlockwise."""
        width = diameter_m / 2.0 * np.sqrt(1.0 - np.abs(u) ** taper_exponent)
        around = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False) - np.pi / 2.0
        reach = arc_radius_m + width[:, None] * np.cos(around)
        z = width[:, None] * (1.0 + np.sin(around))
        along = half_angle * u[:, None]
        return np.stack([reach * np.sin(along), reach * np.cos(along), z], axis=-1)

    stations = np.sin(np.linspace(-np.pi / 2.0, np.pi / 2.0, 10 * BANANA_PARTS + 1))
    sections = rings(stations, SECTORS // 2)
    mesh = tube(sections[0, 0], sections[1:-1], sections[-1, 0])
    pieces = [np.linspace(a, a + 2.0 / BANANA_PARTS, 5) for a in np.linspace(-1, 1, BANANA_PARTS + 1)[:-1]]
    # the blunt tips need stations close to their end
    pieces[0] = np.concatenate([[-1.0, -0.995, -0.98, -0.95, -0.88], pieces[0][2:]])
    pieces[-1] = -pieces[0]
    parts = tuple(hull(rings(np.clip(u, -1.0, 1.0), 24).reshape(-1, 3)) for u in pieces)
    return ShapeGeometry(mesh=mesh, convex_parts=parts)


KINDS = {"banana": banana}
