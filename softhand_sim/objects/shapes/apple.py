"""Apples and other round fruit with a dimple at each pole."""

import numpy as np
from scipy.optimize import brentq

from softhand_sim.objects.geometry import (
    HULL_SECTORS,
    SECTORS,
    FloatArray,
    ShapeGeometry,
    hull,
    require_positive,
    revolve,
)


def apple_profile(
    polar_rad: FloatArray,
    *,
    diameter_m: float,
    height_m: float,
    dimple_depth_m: float,
    dimple_width_ratio: float,
    taper_ratio: float,
) -> tuple[FloatArray, FloatArray]:
    """Return radius and height, both shape (n,), of the apple's outline at polar angles from the top, shape (n,).

    r = a sin t (1 + k cos t), z = c cos t - sgn(cos t) d exp(-(sin t / s)^2): an ellipse, tapered, with a
    Gaussian dimple at each pole (our own closed form). a, c, d follow from the diameter, height and dimple
    depth wanted.
    """
    t = np.linspace(0.0, np.pi, 4001)
    half = height_m / 2.0
    dimple = np.exp(-((np.sin(t) / dimple_width_ratio) ** 2))

    def rim_error(c: float) -> float:
        d = dimple_depth_m - half + c  # the pole lies one dimple depth below the rim, which lies at height/2
        return float(np.max(c * np.cos(t[:2001]) - d * dimple[:2001])) - half

    c = float(brentq(rim_error, half, 4.0 * half, xtol=1e-12)) if dimple_depth_m > 0.0 else half
    d = dimple_depth_m - half + c
    shape = np.sin(t) * (1.0 + taper_ratio * np.cos(t))
    a = diameter_m / 2.0 / float(shape.max())
    radius = a * np.sin(polar_rad) * (1.0 + taper_ratio * np.cos(polar_rad))
    bump = d * np.exp(-((np.sin(polar_rad) / dimple_width_ratio) ** 2))
    return radius, c * np.cos(polar_rad) - np.sign(np.cos(polar_rad)) * bump


def apple(
    *,
    diameter_m: float,
    height_m: float,
    dimple_depth_m: float,
    dimple_width_ratio: float,
    taper_ratio: float,
) -> ShapeGeometry:
    """Return an apple: a body of revolution with a dimple at each pole; collisions see its hull (dimples filled).

    Raises
    ------
    ValueError
        If a parameter is out of range.
    """
    require_positive(diameter_m=diameter_m, height_m=height_m, dimple_depth_m=dimple_depth_m)
    if not dimple_depth_m < height_m / 4.0:
        raise ValueError(f"dimple_depth_m is {dimple_depth_m}, needs < a quarter of height_m {height_m}")
    if not 0.1 <= dimple_width_ratio <= 0.6:
        raise ValueError(f"dimple_width_ratio is {dimple_width_ratio}, allowed 0.1 to 0.6")
    if not 0.0 <= taper_ratio <= 0.3:
        raise ValueError(f"taper_ratio is {taper_ratio}, allowed 0 to 0.3")

    def outline(points: int) -> tuple[FloatArray, FloatArray]:
        return apple_profile(
            np.linspace(np.pi, 0.0, points),
            diameter_m=diameter_m,
            height_m=height_m,
            dimple_depth_m=dimple_depth_m,
            dimple_width_ratio=dimple_width_ratio,
            taper_ratio=taper_ratio,
        )

    mesh = revolve(*outline(SECTORS + 1), SECTORS)
    coarse = revolve(*outline(HULL_SECTORS + 1), HULL_SECTORS)
    return ShapeGeometry(mesh=mesh, convex_parts=(hull(coarse.vertices),))


KINDS = {"apple": apple}
