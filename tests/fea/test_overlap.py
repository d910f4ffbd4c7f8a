import numpy as np
import pytest

from fea.meshes import rectangle
from fea.overlap import overlap
from fea.triangle import RULE, bends, shapes, slopes


def sheet(cells: int, height: float, *, side: float = 1.0, turned: float = 0.0, up: bool = True):
    """Faces [n, 3, 3] of a square at a height; normals up or down."""
    grid = np.linspace(-0.5 * side, 0.5 * side, cells + 1)
    points, triangles = rectangle(grid, grid)
    c, s = np.cos(turned), np.sin(turned)
    x = np.column_stack([points @ np.array([[c, s], [-s, c]]), np.full(len(points), height)])
    return x[triangles if up else triangles[:, ::-1]]


def area(faces):
    return 0.5 * np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1)


def places(points, first):
    return np.einsum("nc,nci->ni", shapes(points.xi, 3), first[points.first])


@pytest.mark.parametrize(("cells", "turned"), [((3, 3), 0.0), ((3, 4), 0.0), ((5, 2), 0.4)])
def test_points_integrate_over_the_common_part_exactly(cells, turned):
    first, second = sheet(cells[0], 0.0), sheet(cells[1], 0.01, side=0.6, turned=turned, up=False)
    points = overlap(first, second, 0.1)
    weight = 2.0 * area(first)[points.first] * points.weight
    assert weight.sum() == pytest.approx(0.36, rel=1e-12)
    # polynomials of degree 2 over the turned square of side 0.6: its second moments are a^4 / 12 in every direction
    x = places(points, first)
    np.testing.assert_allclose(weight @ x[:, :2], 0.0, atol=1e-14)
    np.testing.assert_allclose(
        np.einsum("n,na,nb->ab", weight, x[:, :2], x[:, :2]), 0.6**4 / 12.0 * np.eye(2), atol=1e-14
    )


def test_each_point_lies_in_front_of_the_face_it_names():
    first, second = sheet(3, 0.0), sheet(4, 0.01, up=False)
    points = overlap(first, second, 0.1)
    x, corners = places(points, first), second[points.second]
    whole = area(corners)
    parts = [corners.copy() for _ in range(3)]
    for k, part in enumerate(parts):
        part[:, k, :2] = x[:, :2]
    np.testing.assert_allclose(sum(area(part) for part in parts), whole, rtol=1e-12)


def test_only_the_nearest_of_several_layers_is_seen():
    first = sheet(2, 0.0)
    near, far = sheet(3, 0.02, side=0.5, up=False), sheet(4, 0.05, up=False)
    points = overlap(first, np.concatenate([far, near]), 0.1)
    weight = 2.0 * area(first)[points.first] * points.weight
    assert weight.sum() == pytest.approx(1.0, rel=1e-12)
    assert weight[points.second >= len(far)].sum() == pytest.approx(0.25, rel=1e-12)


def test_faces_out_of_reach_or_looking_the_same_way_are_left_out():
    first = sheet(2, 0.0)
    assert len(overlap(first, sheet(2, 0.2, up=False), 0.1).first) == 0
    assert len(overlap(first, sheet(2, 0.01), 0.1).first) == 0


@pytest.mark.parametrize("n_nodes", [3, 6])
def test_shape_functions_have_their_derivatives_and_add_up_to_one(n_nodes):
    xi, h = np.random.default_rng(0).uniform(0.0, 0.5, (5, 2)), 1e-6
    np.testing.assert_allclose(shapes(xi, n_nodes).sum(axis=1), 1.0)
    for axis, step in enumerate(h * np.eye(2)):
        difference = (shapes(xi + step, n_nodes) - shapes(xi - step, n_nodes)) / (2.0 * h)
        np.testing.assert_allclose(slopes(xi, n_nodes)[..., axis], difference, atol=1e-8)
        difference = (slopes(xi + step, n_nodes) - slopes(xi - step, n_nodes)) / (2.0 * h)
        np.testing.assert_allclose(difference, np.broadcast_to(bends(n_nodes)[..., axis], difference.shape), atol=1e-8)
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    nodes = np.concatenate([corners, 0.5 * (corners[[0, 1, 0]] + corners[[1, 2, 2]])])[:n_nodes]
    np.testing.assert_allclose(shapes(nodes, n_nodes), np.eye(n_nodes), atol=1e-15)


def test_the_rule_integrates_degree_two():
    at, weight = RULE
    for p, q, exact in ((0, 0, 1 / 2), (1, 0, 1 / 6), (2, 0, 1 / 12), (1, 1, 1 / 24)):
        assert weight @ (at[:, 0] ** p * at[:, 1] ** q) == pytest.approx(exact, rel=1e-14)
