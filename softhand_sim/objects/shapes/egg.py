"""Lemons, pears, strawberries: bodies of revolution about a lying axis, thicker at one end."""

import numpy as np

from softhand_sim.objects.geometry import HULL_SECTORS, SECTORS, FloatArray, ShapeGeometry, hull, require_positive, tube
from softhand_sim.objects.resting import laid_down

NECK_STATIONS = 2001


def egg(*, length_m: float, diameter_m: float, taper_ratio: float, neck_ratio: float) -> ShapeGeometry:
    """Return a fruit lying on its side, the thick end towards +x.

    r = a sin t (1 + k cos t + m cos^2 t), x = (length/2) cos t with k = `taper_ratio` and m = `neck_ratio` (our own
    closed form): k = m = 0 is an ellipsoid, m > 0 fills the ends. a follows from the diameter wanted. Its volume is
    pi a^2 (length/2) (4/3 + 4 (k^2 + 2 m)/15 + 4 m^2/35).

    Raises
    ------
    ValueError
        If a parameter is out of range, or the outline would have a waist thinner than half of its ends.
    """
    require_positive(length_m=length_m, diameter_m=diameter_m)
    if not 0.0 <= taper_ratio <= 0.8:
        raise ValueError(f"taper_ratio is {taper_ratio}, allowed 0 to 0.8")
    if not -0.3 <= neck_ratio <= 0.5:
        raise ValueError(f"neck_ratio is {neck_ratio}, allowed -0.3 to 0.5")
    if not 1.0 - taper_ratio + neck_ratio > 0.0:
        raise ValueError(f"taper_ratio {taper_ratio} and neck_ratio {neck_ratio} leave no thin end")

    def outline(t: FloatArray) -> FloatArray:
        return np.asarray(np.sin(t) * (1.0 + taper_ratio * np.cos(t) + neck_ratio * np.cos(t) ** 2))

    thickest = float(outline(np.linspace(0.0, np.pi, NECK_STATIONS)).max())

    def rings(stations: int, sides: int) -> FloatArray:
        """Return sections from -x to +x, shape (stations, sides, 3), anticlockwise seen from +x."""
        t = np.linspace(np.pi, 0.0, stations)
        radius = diameter_m / 2.0 / thickest * outline(t)
        around = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False) + np.pi / sides - np.pi / 2.0
        x = np.broadcast_to(length_m / 2.0 * np.cos(t)[:, None], (stations, sides))
        return np.stack([x, radius[:, None] * np.cos(around), radius[:, None] * np.sin(around)], axis=-1)

    fine, coarse = rings(SECTORS + 1, SECTORS), rings(HULL_SECTORS + 1, HULL_SECTORS)
    mesh = tube(fine[0, 0], fine[1:-1], fine[-1, 0])
    return laid_down(ShapeGeometry(mesh=mesh, convex_parts=(hull(coarse.reshape(-1, 3)),)))


KINDS = {"egg": egg}
