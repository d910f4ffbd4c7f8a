"""Balls, solid or hollow."""

import numpy as np

from softhand_sim.objects.geometry import SECTORS, Primitive, ShapeGeometry, require_positive, revolve, surface


def sphere(*, diameter_m: float, wall_thickness_m: float) -> ShapeGeometry:
    """Return a ball; `wall_thickness_m` = radius makes it solid, less makes it hollow.

    Raises
    ------
    ValueError
        If a length is not positive or the wall is thicker than the radius.
    """
    require_positive(diameter_m=diameter_m, wall_thickness_m=wall_thickness_m)
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


KINDS = {"sphere": sphere}
