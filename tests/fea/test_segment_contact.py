from dataclasses import replace

import numpy as np
import pytest

from fea.gap_law import NoSeparation, Unilateral
from fea.lattice import free_faces
from fea.rubber import neo_hookean
from fea.segment_contact import SegmentOptions, segment_contact
from fea.verification.contact_blocks import Block, block_pair, drive

GAP, DISTANCE = 0.12e-3, 0.1e-3
LAWS = {
    "unilateral": Unilateral(stiffness_pa=1e6, distance_m=DISTANCE),
    "no separation": NoSeparation(stiffness_pa=1e6, distance_m=DISTANCE, gap_m=GAP),
}
OPTIONS = SegmentOptions(law=LAWS["unilateral"], reach_m=0.5e-3)


def make_pair(options=OPTIONS):
    lower = Block(side_m=4e-3, height_m=0.5e-3, cells=3, layers=1)
    upper = Block(side_m=2e-3, height_m=0.5e-3, cells=2, layers=1, turned_deg=17.0)
    return block_pair(lower, upper, neo_hookean(3.3e5, 1e6), options, gap_m=GAP)


def moved(pair, shift, noise=2e-6):
    u = np.where(pair.upper[:, None], shift, 0.0)
    return u + np.random.default_rng(0).uniform(-noise, noise, u.shape)


@pytest.mark.parametrize("law", LAWS)
def test_force_and_hessian_are_derivatives_of_the_energy(law):
    """Faces are bent by noise, so the gaps' curvature takes part; points past the upper block's edge too."""
    pair = make_pair(replace(OPTIONS, law=LAWS[law]))
    u = moved(pair, [0.3e-3, 0.1e-3, -0.07e-3])
    contact = pair.contact.following(moved(pair, [0.2e-3, 0.0, -0.05e-3]))
    way, h = np.random.default_rng(1).standard_normal(u.shape), 1e-10
    state = contact.evaluate(u, project=False)
    slope = (contact.energy(u + h * way) - contact.energy(u - h * way)) / (2.0 * h)
    assert -(state.force_n * way).sum() == pytest.approx(slope, rel=1e-6)
    # the tangent leaves out how the direction to an edge turns
    rows = np.flatnonzero(~contact._found(u)[1].on_edge)
    assert 0.5 * len(contact.face) < len(rows) < len(contact.face)
    p = contact.points
    within = replace(p, first=p.first[rows], second=p.second[rows], xi=p.xi[rows], weight=p.weight[rows])
    flat = replace(contact, points=within, face=contact.face[rows], eta=contact.eta[rows])
    state = flat.evaluate(u, project=False)
    change = (flat.force_n(u - h * way) - flat.force_n(u + h * way)).ravel() / (2.0 * h)
    full = state.hessian + state.hessian.T
    full.setdiag(state.hessian.diagonal())
    np.testing.assert_allclose(full @ way.ravel(), change, atol=1e-6 * np.abs(change).max())


def test_projected_hessian_is_positive_semi_definite():
    pair = make_pair()
    u = moved(pair, [0.0, 0.0, -0.09e-3], noise=1e-5)
    used = np.unique(np.concatenate([pair.contact.first, pair.contact.second]))
    dofs = (3 * used[:, None] + np.arange(3)).ravel()

    def lowest(project):
        upper = pair.contact.evaluate(u, project=project).hessian[dofs][:, dofs].toarray()
        values = np.linalg.eigvalsh(upper + np.triu(upper, 1).T)
        return values[0] / values[-1]

    assert lowest(True) > -1e-12
    assert lowest(False) < -1e-6


def test_contact_has_neither_resultant_nor_moment():
    pair = make_pair()
    u = moved(pair, [0.2e-3, 0.1e-3, -0.08e-3], noise=1e-5)
    force, x = pair.contact.force_n(u), pair.model.mesh.points_m + u
    push = np.abs(force).sum()
    assert force[pair.upper, 2].sum() > 0.1 * push
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12 * push)
    np.testing.assert_allclose(np.cross(x, force).sum(axis=0), 0.0, atol=1e-12 * push * np.ptp(x))


def test_pressure_is_that_of_the_gap_and_ends_with_the_overlap():
    pair = make_pair()
    gap = 0.04e-3
    u = moved(pair, [0.0, 0.0, gap - GAP], noise=0.0)
    pressure = 1e6 * (1.0 - gap / DISTANCE) ** 2
    # the part of the ground in front of the block, and a rim where the distance to the block's edge counts
    rim = 4.0 * 2e-3 * (DISTANCE - gap)
    force = pair.contact.force_n(u)[pair.upper, 2].sum()
    assert pressure * 4e-6 <= force * (1.0 + 1e-12) < pressure * (4e-6 + rim)
    assert pair.contact.minimum_gap_m(u, within_m=1e-3) == pytest.approx(gap, rel=1e-9)
    assert pair.contact.minimum_gap_m(u, within_m=0.5 * gap) is None
    assert not pair.contact.force_n(moved(pair, [0.0, 0.0, 0.0], noise=0.0)).any()
    found = pair.contact.contact_pressure_pa(u)
    at = pair.model.mesh.points_m[pair.contact.first_nodes]
    assert 0.6 * pressure < found[np.hypot(at[:, 0], at[:, 1]) < 0.5e-3].min()
    assert found.max() <= pressure * (1.0 + 1e-9)
    assert (found == 0.0).any()  # corners of the ground whose faces are in front of nothing


def test_no_separation_holds_when_pulled_and_slides_freely():
    options = replace(OPTIONS, law=LAWS["no separation"])
    pair = make_pair(options)
    states = drive(pair, 1e-5 * np.array([[0.0, 0.0, -2.0], [0.0, 0.0, 2.0], [2.0, 0.0, 2.0]]), tolerance=1e-8)
    down, up, aside = (s.force_n for s in states)
    assert down[2] < 0.0 < up[2]
    assert up[2] == pytest.approx(-down[2], rel=0.15)  # finite strain
    assert abs(aside[0]) < 1e-2 * aside[2]


def test_bad_settings_and_shared_nodes_are_refused():
    pair = make_pair()
    face = free_faces(pair.model.mesh, lambda c: np.isclose(c[..., 2], 0.5e-3))
    with pytest.raises(ValueError, match="share"):
        segment_contact(pair.model.mesh, face, face, OPTIONS)
    wide = replace(LAWS["unilateral"], distance_m=2.0 * GAP)
    with pytest.raises(ValueError, match="must be below the smallest gap at rest"):
        make_pair(replace(OPTIONS, law=wide))
    with pytest.raises(ValueError, match=r"reach_m = -1\.0"):
        replace(OPTIONS, reach_m=-1.0)
    with pytest.raises(ValueError, match=r"friction = 3\.0"):
        replace(OPTIONS, friction=3.0)
    for law in LAWS.values():
        with pytest.raises(ValueError, match=r"stiffness_pa = 0\.0"):
            replace(law, stiffness_pa=0.0)
