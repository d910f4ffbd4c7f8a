import numpy as np
import pytest
from scipy.optimize import minimize

from fea.projection import nearest, neighbours
from fea.triangle import shapes

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
NODES = np.concatenate([CORNERS, 0.5 * (CORNERS[[0, 1, 0]] + CORNERS[[1, 2, 2]])])


def height(x, y):
    return 0.2 * x * (1.0 - x) + 0.3 * x * y - 0.1 * y**2


def face():
    """A curved face over the unit triangle whose solid lies below: the normal of its nodes' order points down."""
    x = np.column_stack([NODES, height(*NODES.T)])
    return x[[0, 2, 1, 5, 4, 3]][None]


def find(points, faces, start=0):
    n = len(points)
    around = np.full((len(faces), 1), -1) if len(faces) == 1 else np.array([[1], [0]])
    return nearest(points, faces, np.full(n, start), np.full((n, 2), 1.0 / 3.0), around)


def brute_force(point, nodes):
    def distance(xi):
        return np.linalg.norm(shapes(xi[None], 6)[0] @ nodes - point)

    bounds = {"type": "ineq", "fun": lambda xi: np.array([xi[0], xi[1], 1.0 - xi.sum()])}
    starts = ([0.3, 0.3], [0.9, 0.05], [0.05, 0.9], [0.05, 0.05])
    return min(minimize(distance, s, constraints=bounds, tol=1e-12, method="SLSQP").fun for s in starts)


def test_distance_is_the_smallest_also_past_edges_and_corners():
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(-0.4, 1.2, (30, 2)), rng.uniform(0.3, 0.6, 30)])
    _, found = find(points, face())
    np.testing.assert_allclose(found.gap_m, [brute_force(p, face()[0]) for p in points], rtol=1e-6)
    assert found.on_edge.any()
    assert not found.on_edge.all()
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=1), 1.0)
    foot = np.einsum("nk,nki->ni", found.shape, np.repeat(face(), 30, axis=0))
    np.testing.assert_allclose(foot + found.gap_m[:, None] * found.normal, points, atol=1e-12)


def test_gap_is_negative_inside_the_solid():
    at = np.array([[0.3, 0.3]])
    inside = np.column_stack([at, height(*at.T) - 0.05])
    _, found = find(inside, face())
    assert -0.05 < found.gap_m[0] < -0.04
    assert found.normal[0, 2] > 0.0


def ridge(angle: float):
    """Two flat faces that meet in the edge x = 0, the right one turned down by an angle: a roof if positive."""
    left = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.5, 0.0]])
    right = np.array([[0.0, 0.0, 0.0], [np.cos(angle), 0.5, -np.sin(angle)], [0.0, 1.0, 0.0]])
    faces = np.stack([left, right])
    middle = 0.5 * (faces[:, [0, 1, 0]] + faces[:, [1, 2, 2]])
    order = [0, 2, 1, 5, 4, 3]
    return np.concatenate([faces, middle], axis=1)[:, order]


@pytest.mark.parametrize("angle", [0.05, 1.2])
def test_gap_and_normal_are_continuous_around_a_ridge(angle):
    """Around the edge the gap is the distance to it, and the normal turns from one face's to the other's."""
    turn = np.linspace(-0.3, angle + 0.3, 400)
    points = np.column_stack([0.1 * np.sin(turn), np.full(400, 0.5), 0.1 * np.cos(turn)])
    _, found = find(points, ridge(angle))
    assert np.abs(np.diff(found.gap_m)).max() < 1e-3
    assert np.linalg.norm(np.diff(found.normal, axis=0), axis=1).max() < 3.0 * np.diff(turn)[0]
    on = (turn > 1e-9) & (turn < angle - 1e-9)
    np.testing.assert_allclose(found.gap_m[on], 0.1, rtol=1e-9)


def test_in_a_valley_the_nearer_face_counts_and_the_wedge_behind_is_inside():
    valley = ridge(-0.1)
    left, right = find(np.array([[-0.02, 0.5, 0.05], [0.02, 0.5, 0.05]]), valley)[0]
    assert (left, right) == (0, 1)
    _, found = find(np.array([[0.0, 0.5, -0.05]]), valley)
    assert found.gap_m[0] == pytest.approx(-0.05, rel=0.01)


def test_neighbours_share_a_node():
    faces = np.array([[0, 1, 2], [1, 2, 3], [3, 4, 5], [6, 7, 8]])
    rings = [set(row[row >= 0]) for row in neighbours(faces)]
    assert rings == [{1}, {0, 2}, {1}, set()]
