"""Generators of the catalogue's shapes, one function a kind; the keyword arguments are the TOML keys.

Every mesh is closed, outward oriented, in metres, z up in its resting pose, and the same on every call.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from scipy.optimize import brentq

from softhand_sim.objects.geometry import FloatArray, Primitive, ShapeGeometry, hull, revolve, surface, tube
from softhand_sim.objects.mug import mug

SECTORS = 64  # choice: a 64-gon has 0.16 % less area than its circle
HULL_SECTORS = 32  # choice: facets of a collision hull stay within 0.2 mm of a 40 mm radius
BANANA_PARTS = 6  # choice: an 18 degree piece of the arc bulges about 1.2 mm over its hollow side


def _positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} is {value}, needs a finite number > 0")


def sphere(*, diameter_m: float, wall_thickness_m: float) -> ShapeGeometry:
    """Return a ball; `wall_thickness_m` = radius makes it solid, less makes it hollow.

    Raises
    ------
    ValueError
        If a length is not positive or the wall is thicker than the radius.
    """
    _positive(diameter_m=diameter_m, wall_thickness_m=wall_thickness_m)
    radius = diameter_m / 2.0
    if wall_thickness_m > radius:
        raise ValueError(f"wall_thickness_m is {wall_thickness_m}, needs <= the radius {radius}")
    polar = np.linspace(np.pi, 0.0, SECTORS // 2 + 1)
    ball = revolve(np.sin(polar), np.cos(polar), SECTORS)
    outer = surface(radius * ball.vertices, ball.faces)
    mesh = outer
    inner_radius = radius - wall_thickness_m
    if inner_radius > 0.0:
        vertices = np.vstack([outer.vertices, inner_radius * ball.vertices])
        mesh = surface(vertices, np.vstack([ball.faces, ball.faces[:, ::-1] + len(ball.vertices)]))
    return ShapeGeometry(mesh=mesh, convex_parts=(outer,), primitive=Primitive(kind="sphere", size_m=(radius,)))


def cylinder(*, diameter_m: float, height_m: float) -> ShapeGeometry:
    """Return a solid upright cylinder.

    Raises
    ------
    ValueError
        If a length is not positive.
    """
    _positive(diameter_m=diameter_m, height_m=height_m)
    radius, half = diameter_m / 2.0, height_m / 2.0
    mesh = revolve(np.array([0.0, radius, radius, 0.0]), np.array([-half, -half, half, half]), SECTORS)
    return ShapeGeometry(mesh=mesh, convex_parts=(mesh,), primitive=Primitive(kind="cylinder", size_m=(radius, half)))


def box(*, depth_m: float, width_m: float, height_m: float) -> ShapeGeometry:
    """Return a solid box with sides along x, y, z.

    Raises
    ------
    ValueError
        If a length is not positive.
    """
    _positive(depth_m=depth_m, width_m=width_m, height_m=height_m)
    half = (depth_m / 2.0, width_m / 2.0, height_m / 2.0)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(half)
    mesh = hull(corners)
    return ShapeGeometry(mesh=mesh, convex_parts=(mesh,), primitive=Primitive(kind="box", size_m=half))


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
    _positive(diameter_m=diameter_m, height_m=height_m, dimple_depth_m=dimple_depth_m)
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
    _positive(length_m=length_m, diameter_m=diameter_m, arc_radius_m=arc_radius_m)
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


GENERATORS: Mapping[str, Callable[..., ShapeGeometry]] = MappingProxyType(
    {
        "apple": apple,
        "banana": banana,
        "box": box,
        "cylinder": cylinder,
        "mug": mug,
        "sphere": sphere,
    }
)
"""Shape kinds of the catalogue; a new kind is one generator and one line here."""
