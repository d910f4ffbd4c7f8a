"""Antipodal pairs against bodies whose pairs are known: a ball, a box, a tetrahedron."""

import numpy as np
import pytest
import trimesh

from softhand_sim.grasp.choice.antipodal import antipodal_pairs


def pairs_of(mesh, friction, *, widest_m=1.0, samples=200):
    return antipodal_pairs(mesh, np.random.default_rng(0), samples=samples, friction=friction, widest_m=widest_m)


def test_every_line_within_the_cone_of_a_ball_is_a_pair():
    radius, friction = 0.03, 0.5
    found = pairs_of(trimesh.creation.icosphere(subdivisions=4, radius=radius), friction)
    # a chord makes the same angle with the normals at both ends; facets turn the normals by up to a degree
    assert len(found) > 190
    lever = np.linalg.norm(found.middle_m, axis=1)
    assert lever.max() < radius * np.sin(np.arctan(friction)) * 1.05
    assert found.width_m == pytest.approx(2.0 * np.sqrt(radius**2 - lever**2), rel=0.01)


def test_without_friction_only_diameters_of_a_ball_remain():
    radius = 0.03
    found = pairs_of(trimesh.creation.icosphere(subdivisions=5, radius=radius), 0.03)
    assert np.linalg.norm(found.middle_m, axis=1).max() < 0.05 * radius
    assert found.width_m == pytest.approx(2.0 * radius, rel=0.01)


def test_pairs_of_a_box_lie_on_opposite_faces():
    sides = np.array([0.04, 0.06, 0.10])
    found = pairs_of(trimesh.creation.box(sides), 1e-6, samples=600)
    axis = np.argmax(np.abs(found.direction), axis=1)
    assert len(found) == 600
    assert found.width_m == pytest.approx(sides[axis])
    # points are drawn evenly over the surface
    area = np.prod(sides) / sides
    assert np.bincount(axis) / 600 == pytest.approx(area / area.sum(), abs=0.06)
    narrow = pairs_of(trimesh.creation.box(sides), 1e-6, widest_m=0.05)
    assert set(np.argmax(np.abs(narrow.direction), axis=1)) == {0}


@pytest.mark.parametrize(("friction", "some"), [(0.68, False), (0.9, True)])
def test_a_tetrahedron_needs_friction_of_its_half_angle(friction, some):
    """Two faces of a regular tetrahedron meet at 70.5 degrees: no pair below tan(35.3 degrees) = 0.707."""
    corners = 0.02 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    mesh = trimesh.Trimesh(corners, [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    assert (len(pairs_of(mesh, friction, samples=500)) > 0) is some
