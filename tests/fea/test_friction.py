from dataclasses import replace

import numpy as np
import pytest

from fea.contact import ContactOptions, SurfaceContact
from fea.friction import accumulated_slip_m, advance, begin, solve_step
from fea.lattice import free_faces
from fea.load import Load
from fea.meshes import surface_force
from fea.newton import NewtonOptions, solve_equilibrium
from fea.path import Sweep, follow
from fea.rubber import neo_hookean
from fea.verification.contact_blocks import Block, block_pair, drive
from fea.verification.contact_sliding import sliding, sliding_loop
from fea.workspace import workspace

FRICTION, SLIP, GAP = 0.4, 1e-5, 0.12e-3
HEIGHT = 0.5e-3
OPTIONS = ContactOptions(stiffness_pa=1e6, friction=FRICTION, friction_slip_m=SLIP, count_once=True)
NEWTON = NewtonOptions(relative_tolerance=1e-8, max_iterations=40)


def make_pair(options: ContactOptions = OPTIONS):
    lower = Block(side_m=4e-3, height_m=HEIGHT, cells=3, layers=1)
    upper = Block(side_m=2e-3, height_m=HEIGHT, cells=2, layers=1, turned_deg=17.0)
    return block_pair(lower, upper, neo_hookean(3.3e5, 1e6), options, gap_m=GAP)


@pytest.fixture(scope="module")
def pair():
    return make_pair()


def over(pair, shift=(0.0, 0.0, -0.07e-3), seed=0):
    """The upper block moved as one, with a little noise."""
    u = np.zeros_like(pair.model.mesh.points_m)
    u[pair.upper] = shift
    return u + np.random.default_rng(seed).uniform(-1e-6, 1e-6, u.shape)


@pytest.mark.parametrize("slip", [0.3 * SLIP, 30.0 * SLIP])
def test_tangent_is_the_derivative_of_the_force_where_normal_forces_are_frozen(pair, slip):
    u = over(pair)
    contact = begin(pair.contact, u).held(u)
    u = u + over(pair, (slip, 0.5 * slip, 0.0), seed=1) * np.array([1.0, 1.0, 0.0])
    direction = np.random.default_rng(2).standard_normal(u.shape)
    h = 1e-10
    change = (contact.evaluate(u - h * direction).force_n - contact.evaluate(u + h * direction).force_n) / (2.0 * h)
    for project in (False, True):
        upper = contact.evaluate(u, project=project).hessian
        full = upper + upper.T
        full.setdiag(upper.diagonal())
        error = np.abs(full @ direction.ravel() - change.ravel()).max() / np.abs(change).max()
        assert (error < 1e-5) is not project  # far from equilibrium it is the secant


def test_secant_is_positive_semi_definite():
    plain = make_pair(replace(OPTIONS, count_once=False))  # pairs that take away have no such guarantee
    u = over(plain)
    contact = begin(plain.contact, u)
    moved = u + over(plain, (5.0 * SLIP, 0.0, 0.0), seed=1)
    dofs = (3 * np.sort(plain.contact.nodes)[:, None] + np.arange(3)).ravel()

    def lowest(project):
        values = np.linalg.eigvalsh(contact.evaluate(moved, project=project).hessian[dofs][:, dofs].toarray(), UPLO="U")
        return values[0] / values[-1]

    assert lowest(True) > -1e-12
    assert lowest(False) < -1e-6


def test_all_slides_at_the_coefficient_times_the_normal_force(pair):
    u = over(pair)
    contact = begin(pair.contact, u)
    moved = u + np.where(pair.upper[:, None], [30.0 * SLIP, 0.0, 0.0], 0.0)
    friction = contact.friction_force_n(moved)
    normal = pair.contact.evaluate(moved).force_n[pair.upper, 2].sum()
    np.testing.assert_allclose(friction.sum(axis=0), 0.0, atol=1e-12 * normal)
    assert friction[pair.upper, 0].sum() == pytest.approx(-FRICTION * normal, rel=0.02)
    assert abs(friction[pair.upper, 1].sum()) < 0.02 * FRICTION * normal


def test_friction_builds_up_over_the_length_and_is_remembered(pair):
    u = over(pair)
    step = np.where(pair.upper[:, None], [0.5 * SLIP, 0.0, 0.0], 0.0)

    def share(contact, at):
        normal = pair.contact.evaluate(at).force_n[pair.upper, 2].sum()
        return -contact.friction_force_n(at)[pair.upper, 0].sum() / (FRICTION * normal)

    contact = begin(pair.contact, u)
    half = u + step
    assert share(contact, half) == pytest.approx(0.75, rel=0.01)  # f(1/2) = 2/2 - 1/4
    assert share(contact.following(half), half) == pytest.approx(0.75, rel=0.01)
    far = u + 10.0 * step
    slid = contact.following(far)
    np.testing.assert_allclose(np.linalg.norm(slid.elastic_slip_m(far), axis=1).max(), 0.5 * SLIP, rtol=1e-6)
    for back, expected in ((1.0, 0.75), (2.0, 0.0), (4.0, -1.0)):
        assert share(slid, far - back * step) == pytest.approx(expected, abs=0.02)
    apart = over(pair, (0.0, 0.0, 0.05e-3))
    assert not contact.following(apart).elastic_slip_m(apart).any()


def test_slip_adds_up_along_the_way_to_and_fro():
    smooth = make_pair(replace(OPTIONS, friction=0.0))
    way = [0.0, 0.02e-3, 0.05e-3, 0.03e-3]
    states = [np.where(smooth.upper[:, None], [x, 0.0, -0.07e-3], 0.0) for x in way]
    slip = accumulated_slip_m(smooth.contact, states)
    x = smooth.model.mesh.points_m[smooth.contact.first_nodes]
    distance = np.hypot(x[:, 0], x[:, 1])
    np.testing.assert_allclose(slip[distance < 0.8e-3], 0.07e-3, rtol=0.01)
    assert not slip[distance > 2.3e-3].any()


def test_a_body_that_sticks_does_not_creep(pair):
    start = drive(pair, np.array([[0.0, 0.0, -0.06e-3], [0.02e-3, 0.0, -0.06e-3]]))[-1].u_m

    def held(following):
        work, u, forces = workspace(pair.model), start, []
        contact = begin(pair.contact, np.zeros_like(start))
        for _ in range(4):
            outcome = solve_step(work, u, Load(), NEWTON, contact=contact)
            assert outcome.converged
            u = outcome.u_m
            contact = following(contact, u)
            forces.append(pair.model.evaluate(u, Load(), tangent=False).reaction_n[pair.top, 0].sum())
        return forces[-1] / forces[0]

    assert held(advance) == pytest.approx(1.0, abs=0.01)
    assert held(lambda _, u: begin(pair.contact, u)) < 0.8  # without the elastic slip it creeps


@pytest.mark.parametrize(("contact", "exact"), [("segments", 2e-3), ("barrier", 1e-5)])
def test_the_way_to_and_fro_costs_work_only_with_friction(contact, exact):
    """Segments are cut anew each step, so their energy is the same on the way back to the error of their integral."""
    rough, smooth = sliding_loop(0.3, contact=contact), sliding_loop(0.0, contact=contact, steps=6)
    there, back = rough.sliding
    assert there == pytest.approx(0.3, rel=0.02)
    assert back == pytest.approx(-0.3, rel=0.02)
    scale = float(rough.normal_n.mean()) * np.ptp(rough.moved_m)
    assert rough.work_j > 0.2 * scale
    assert abs(smooth.work_j) < exact * scale
    np.testing.assert_allclose(smooth.ratio, smooth.ratio[::-1], atol=exact)
    assert abs(rough.ratio[rough.forward]) < 0.2  # it sticks where it turns back
    assert (np.abs(rough.ratio) < 0.3 * 1.02).all()


@pytest.mark.parametrize(("contact", "friction"), [("segments", 0.1), ("segments", 0.8), ("barrier", 0.8)])
def test_sliding_begins_at_the_coefficient(contact, friction):
    assert sliding(friction, contact=contact, steps=6).error < 0.02


def pull(pair):
    """Force on the upper block's lower face: down and sideways."""
    face = free_faces(pair.model.mesh, lambda c: np.abs(c[..., 2] - HEIGHT - GAP) < 1e-9)
    return surface_force(pair.model.mesh, face, np.array([8e4, 0.0, -4e5]))


def test_a_path_with_friction_resumes_where_it_broke_off(pair):
    force, targets = pull(pair), [0.5, 0.75, 1.0]
    options = replace(NEWTON, largest_step=0.25)

    def run(contact, resume=()):
        made, states = [], []
        sweep = Sweep(on_step=made.append, resume=resume)
        outcome = follow(
            pair.model,
            lambda s: Load(force_n=s * force),
            targets,
            options,
            on_target=lambda _, u: states.append(u),
            contact=contact,
            sweep=sweep,
        )
        assert outcome.converged
        return made, states

    steps, whole = run(pair.contact)
    _, resumed = run(pair.contact, steps[:3])
    _, forgetful = run(pair.contact, steps[2:3])
    assert pair.contact.evaluate(whole[-1]).force_n.any()
    np.testing.assert_allclose(resumed[-1], whole[-1], atol=1e-6 * SLIP)
    assert np.abs(forgetful[-1] - whole[-1]).max() > 1e-3 * SLIP  # the steps before matter


def test_no_friction_is_the_plain_contact():
    plain = make_pair(replace(OPTIONS, friction=0.0))
    u = over(plain)
    assert begin(plain.contact, u) is plain.contact
    assert advance(plain.contact, u) is plain.contact
    assert begin(None, u) is None
    start = np.zeros_like(u)
    load = Load(force_n=pull(plain))
    one = solve_step(workspace(plain.model), start, load, NEWTON, contact=plain.contact)
    two = solve_equilibrium(workspace(plain.model), start, load, NEWTON, contact=plain.contact)
    # threads add up in any order, which may change a step of the search: equal to the solver's tolerance
    np.testing.assert_allclose(one.u_m, two.u_m, atol=1e-4 * np.abs(two.u_m).max())


def test_contact_pressure_is_the_normal_force_over_the_area():
    options = replace(OPTIONS, friction=0.0)
    fine = Block(side_m=4e-3, height_m=HEIGHT, cells=6, layers=1)
    pressed = block_pair(fine, replace(fine, cells=5), neo_hookean(3.3e5, 1e6), options, gap_m=GAP)
    state = drive(pressed, np.array([[0.0, 0.0, -0.03e-3], [0.0, 0.0, -0.06e-3]]))[-1]
    lower = pressed.contact.first_nodes
    pressure = pressed.contact.contact_pressure_pa(state.u_m)
    assert pressure.shape == lower.shape
    x = np.abs(pressed.model.mesh.points_m[lower, :2]).max(axis=1)
    mean = -state.force_n[2] / (4e-3) ** 2
    inner = pressure[x < 0.7e-3]  # one element and more from the edges
    assert inner.mean() == pytest.approx(mean, rel=0.1)
    assert inner.std() < 0.1 * mean


@pytest.mark.parametrize(
    ("name", "value"), [("friction", -0.1), ("friction", 2.5), ("friction", np.nan), ("friction_slip_m", 0.0)]
)
def test_bad_friction_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=name):
        ContactOptions(**{name: value})


def test_pairs_counted_once_push_less_sideways():
    """Matching facets a little off: the plain set pushes them sideways although nothing rubs."""
    grid = Block(side_m=2e-3, height_m=HEIGHT, cells=2, layers=1)
    wide = replace(grid, side_m=4e-3, cells=4)
    sideways = []
    for once in (False, True):
        options = ContactOptions(stiffness_pa=1e6, count_once=once)
        matching = block_pair(wide, grid, neo_hookean(3.3e5, 1e6), options, gap_m=GAP)
        u = np.where(matching.upper[:, None], [0.03e-3, 0.0, -0.07e-3], 0.0)
        force = matching.contact.evaluate(u).force_n[matching.upper].sum(axis=0)
        sideways.append(abs(force[0] / force[2]))
        assert isinstance(matching.contact, SurfaceContact)
    assert sideways[0] > 0.1
    assert sideways[1] < 0.05
