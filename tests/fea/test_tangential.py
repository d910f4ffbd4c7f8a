from dataclasses import replace

import ipctk
import numpy as np
import pytest

from fea.contact import ContactOptions
from fea.rubber import neo_hookean
from fea.tangential import TangentialPairs
from fea.verification.contact_blocks import Block, block_pair

LENGTH = 1e-5
OPTIONS = ContactOptions(stiffness_pa=1e6, friction=0.4, friction_slip_m=LENGTH, count_once=True)


@pytest.fixture(scope="module")
def touching():
    """Two blocks that do not match, the upper one turned and lowered, so that pairs of every kind are there."""
    lower = Block(side_m=4e-3, height_m=0.5e-3, cells=3, layers=1)
    upper = Block(side_m=2e-3, height_m=0.5e-3, cells=2, layers=1, turned_deg=17.0)
    pair = block_pair(lower, upper, neo_hookean(3.3e5, 1e6), OPTIONS, gap_m=0.12e-3)
    u = np.zeros_like(pair.model.mesh.points_m)
    u[pair.upper, 2] = -0.07e-3
    return pair, u + np.random.default_rng(0).uniform(-1e-6, 1e-6, u.shape)


def random_slip(pair, size_m: float):
    return size_m * np.random.default_rng(1).standard_normal(pair.model.mesh.points_m.shape)


def one_pair(limit_n: float = 2.0) -> TangentialPairs:
    """Node 0 on node 1 in the plane z = 0."""
    return TangentialPairs(
        nodes=np.array([[0, 1, 0, 0]]),
        weight=np.array([[1.0, -1.0, 0.0, 0.0]]),
        side=np.array([[1.0, -1.0, 0.0, 0.0]]),
        plane=np.eye(3)[None, :, :2],
        limit_n=np.array([limit_n]),
        length_m=LENGTH,
    )


@pytest.mark.parametrize("size", [0.3 * LENGTH, 5.0 * LENGTH])
def test_forces_and_hessian_are_those_of_ipctk(touching, size):
    pair, u = touching
    contact = pair.contact
    ours, slip = contact.friction_pairs(u), random_slip(pair, size)
    x = contact._positions(u)
    theirs = ipctk.TangentialCollisions()
    theirs.build(contact._mesh, x, contact._collisions(x), contact._potential, OPTIONS.friction)
    assert len(theirs) == len(ours.limit_n) > 20
    potential = ipctk.FrictionPotential(1e3 * LENGTH)
    moved = np.asfortranarray(1e3 * slip[contact.nodes])
    force = -potential.gradient(theirs, contact._mesh, moved).reshape(-1, 3)
    np.testing.assert_allclose(ours.force_n(slip)[contact.nodes], force, atol=1e-12 * np.abs(force).max())
    hessian = contact._upper(potential.hessian(theirs, contact._mesh, moved, ipctk.PSDProjectionMethod.NONE))
    assert abs(ours.hessian(slip) - hessian).max() < 1e-9 * abs(hessian).max()


def test_force_is_the_slope_of_the_energy_and_the_hessian_that_of_the_force(touching):
    pair, u = touching
    pairs, slip = pair.contact.friction_pairs(u), random_slip(pair, 0.7 * LENGTH)
    way, h = np.random.default_rng(2).standard_normal(u.shape), 1e-10
    slope = (pairs.energy_j(slip + h * way) - pairs.energy_j(slip - h * way)) / (2.0 * h)
    assert slope == pytest.approx(-float((pairs.force_n(slip) * way).sum()), rel=1e-6)
    change = -(pairs.force_n(slip + h * way) - pairs.force_n(slip - h * way)).ravel() / (2.0 * h)
    upper = pairs.hessian(slip)
    full = upper + upper.T
    full.setdiag(upper.diagonal())
    np.testing.assert_allclose(full @ way.ravel(), change, atol=1e-5 * np.abs(change).max())


@pytest.mark.parametrize("there", [0.4, 1.0, 7.0])
def test_secant_touches_the_energy_and_lies_above_it(there):
    """f(y) / y falls, so the quadratic with its value and slope at one slip is nowhere below: the way of MM methods."""
    pairs = one_pair()

    def energy(y):
        return pairs.energy_j(LENGTH * y * np.array([[0.6, 0.8, 5.0], [0.0, 0.0, 0.0]]))

    at = LENGTH * there * np.array([[0.6, 0.8, 0.0], [0.0, 0.0, 0.0]])
    stiffness = pairs.hessian(at, secant=True).toarray()[:2, :2]
    np.testing.assert_allclose(stiffness, stiffness[0, 0] * np.eye(2), atol=1e-9 * stiffness[0, 0])
    for y in np.linspace(0.0, 12.0, 60):
        parabola = energy(there) + 0.5 * stiffness[0, 0] * LENGTH**2 * (y**2 - there**2)
        assert parabola >= energy(y) - 1e-12
    assert pairs.force_n(at)[0, :2] == pytest.approx(-stiffness[0, 0] * at[0, :2])


def test_sliding_pair_resists_at_its_limit_and_only_across_in_its_tangent():
    slip = np.array([[3.0 * LENGTH, 0.0, 1.0], [0.0, 0.0, 0.0]])
    pairs = one_pair()
    np.testing.assert_allclose(pairs.force_n(slip), [[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]], atol=1e-12)
    tangent = pairs.hessian(slip).toarray()[:3, :3]
    np.testing.assert_allclose(tangent, np.diag([0.0, 2.0 / (3.0 * LENGTH), 0.0]), atol=1e-6)


def test_nodes_share_the_slip_of_their_pairs_and_the_rest_has_none(touching):
    pair, u = touching
    shift = np.array([3e-5, -2e-5, 0.0])
    slip = pair.contact.friction_pairs(u).mean_slip_m(np.where(pair.upper[:, None], shift, 0.0))
    touched = np.linalg.norm(slip, axis=1) > 0.0
    first = np.zeros_like(touched)
    first[pair.contact.first_nodes] = True
    sign = np.where(pair.upper, 1.0, -1.0)[touched, None]
    np.testing.assert_allclose(slip[touched, :2], sign * shift[:2], atol=0.05 * 3e-5)
    assert (touched & first).any()
    assert (touched & ~first).any()
    assert not touched[pair.top].any()


def test_pairs_that_take_away_turn_the_sign():
    slip = np.array([[0.5 * LENGTH, 0.0, 0.0], [0.0, 0.0, 0.0]])
    plus, minus = one_pair(), one_pair(-2.0)
    np.testing.assert_allclose(minus.force_n(slip), -plus.force_n(slip))
    both = replace(plus, **{n: np.concatenate([getattr(plus, n), getattr(minus, n)]) for n in _ROWS})
    assert not both.force_n(slip).any()


_ROWS = ("nodes", "weight", "side", "plane", "limit_n")
