from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from tests_fea_helpers import tube_model

from fea.assembly import SolidModel
from fea.lattice import Lattice, build_mesh
from fea.laws import IsochoricOgden, StVenantKirchhoff
from fea.linear_solver import SymmetricSolver
from fea.load import Load, Supply
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.path import follow
from fea.workspace import workspace

SOFT = IsochoricOgden(coefficients_pa=(1.0667e5, 11.25, 609.0), exponents=(1.05, 4.0, -1.6), bulk_modulus_pa=3e7)
STIFF = StVenantKirchhoff(young_modulus_pa=2.76e6, poisson_ratio=0.417)


def small_tube() -> SolidModel:
    material = np.zeros((3, 3, 3), dtype=np.int64)
    material[1, :, 1] = 1
    lattice = Lattice(
        r_m=np.array([3e-3, 4.2e-3, 4.8e-3, 5.5e-3]),
        theta_rad=np.linspace(0, np.pi, 4),
        z_m=np.array([0.0, 0.7e-3, 1.2e-3, 2e-3]),
        material=material,
    )
    return tube_model(lattice, {0: SOFT, 1: STIFF})


@pytest.mark.parametrize("stiffness", [None, 2e13])
def test_residual_and_tangent_match_finite_differences(stiffness):
    model = small_tube()
    rng = np.random.default_rng(1)
    u = 2e-5 * rng.standard_normal(model.mesh.points_m.shape)
    rest = model.cavity.volume_m3(model.mesh.points_m)
    supply = None if stiffness is None else Supply(volume_m3=1.1 * rest, stiffness_pa_per_m3=stiffness)
    load = Load(pressure_pa_gauge=2e4, force_n=1e-3 * rng.standard_normal(u.shape), supply=supply)
    state = model.evaluate(u, load)
    full = (state.tangent + sp.triu(state.tangent, k=1).T).toarray()
    if stiffness is not None:
        full += np.outer(state.rank_one, state.rank_one)
    h = 1e-9
    for _ in range(4):
        v = np.zeros_like(u)
        v.reshape(-1)[model.free] = rng.standard_normal(len(model.free))
        slope = (model.energy(u + 10 * h * v, load) - model.energy(u - 10 * h * v, load)) / (20 * h)
        work = float((state.internal_n - state.external_n) @ v.ravel()[model.free])
        assert slope == pytest.approx(work, rel=1e-6)
        plus, minus = model.evaluate(u + h * v, load), model.evaluate(u - h * v, load)
        change = ((plus.internal_n - plus.external_n) - (minus.internal_n - minus.external_n)) / (2 * h)
        expected = full @ v.ravel()[model.free]
        assert np.linalg.norm(change - expected) < 1e-6 * np.linalg.norm(expected)


def test_supply_gives_less_as_the_cavity_grows():
    load = Load(pressure_pa_gauge=5e3, supply=Supply(volume_m3=2e-6, stiffness_pa_per_m3=1e10))
    assert load.pressure_at(2e-6) == 5e3
    assert load.pressure_at(2.1e-6) == pytest.approx(4e3)
    assert Load(pressure_pa_gauge=5e3).pressure_at(2.1e-6) == 5e3
    further = Load(pressure_pa_gauge=6e3, supply=Supply(volume_m3=2.4e-6, stiffness_pa_per_m3=1e10))
    between = load.towards(further, 0.25)
    assert between.pressure_at(2.1e-6) == pytest.approx(
        0.75 * load.pressure_at(2.1e-6) + 0.25 * further.pressure_at(2.1e-6)
    )


def test_newton_solves_with_a_supply_and_ends_on_its_line():
    model = small_tube()
    rest = model.cavity.volume_m3(model.mesh.points_m)
    work, zero = workspace(model), np.zeros_like(model.mesh.points_m)
    stiff = Supply(volume_m3=1.02 * rest, stiffness_pa_per_m3=1e14)
    load = Load(supply=stiff)
    outcome = solve_equilibrium(work, zero, load, NewtonOptions(), balanced=Load(supply=replace(stiff, volume_m3=rest)))
    assert outcome.converged
    pressure = model.pressure_pa_gauge(outcome.u_m, load)
    volume = model.cavity.volume_m3(model.mesh.points_m + outcome.u_m)
    assert rest < volume < 1.02 * rest
    assert pressure == pytest.approx(1e14 * (1.02 * rest - volume))
    plain = solve_equilibrium(work, zero, Load(pressure_pa_gauge=pressure), NewtonOptions(), balanced=Load())
    np.testing.assert_allclose(plain.u_m, outcome.u_m, atol=1e-5 * np.abs(plain.u_m).max())


def test_cavity_gradient_and_hessian_match_finite_differences_of_the_volume():
    model = small_tube()
    rng = np.random.default_rng(2)
    x = model.mesh.points_m + 1e-4 * rng.standard_normal(model.mesh.points_m.shape)
    gradient, hessian = model.cavity.derivatives(x)
    v = 1e-3 * rng.standard_normal(x.shape)
    h = 1e-3
    slope = (model.cavity.volume_m3(x + h * v) - model.cavity.volume_m3(x - h * v)) / (2 * h)
    assert slope == pytest.approx(float((gradient * v).sum()), rel=1e-6)
    change = (model.cavity.derivatives(x + h * v)[0] - model.cavity.derivatives(x - h * v)[0]) / (2 * h)
    product = np.zeros_like(x)
    np.add.at(
        product,
        model.cavity.faces,
        np.einsum("fab,fb->fa", hessian, v[model.cavity.faces].reshape(-1, 18)).reshape(-1, 6, 3),
    )
    np.testing.assert_allclose(change, product, atol=1e-8 * np.abs(product).max())
    np.testing.assert_allclose(hessian, hessian.transpose(0, 2, 1), atol=1e-15)


def test_patch_of_curved_elements_carries_a_uniform_strain():
    lattice = Lattice(
        r_m=np.array([0.0, 1.0, 2.0, 3.0]),
        theta_rad=np.linspace(0, np.pi, 5),
        z_m=np.linspace(0.0, 2.0, 4),
        material=np.zeros((3, 4, 3), dtype=np.int64),
    )
    mesh = build_mesh(lattice)
    r, theta, z = mesh.cylindrical.T
    surface = (r == 3.0) | (r == 0.0) | (theta == 0.0) | np.isclose(theta, np.pi) | (z == 0.0) | (z == 2.0)
    fixed = np.repeat(surface[:, None], 3, axis=1)
    # the element-mean dilatation keeps uniform states exact, whatever the bulk modulus
    # (order 4 integrates the gradients of curved elements exactly; the four-point rule is exact in straight ones)
    model = SolidModel(mesh=mesh, laws={0: SOFT}, fixed=fixed, quadrature_order=4)
    gradient = np.array([[0.10, 0.05, 0.0], [-0.03, -0.06, 0.02], [0.04, 0.0, 0.03]])
    exact = mesh.points_m @ gradient.T
    start = np.where(fixed, exact, exact + 1e-3 * np.random.default_rng(0).standard_normal(exact.shape))
    options = NewtonOptions(step_cap_m=1.0, relative_tolerance=1e-9)
    outcome = solve_equilibrium(workspace(model), start, Load(), options)
    assert outcome.converged
    np.testing.assert_allclose(outcome.u_m, exact, atol=1e-8)


def test_superlu_and_the_default_solver_agree():
    model = small_tube()
    state = model.evaluate(np.zeros_like(model.mesh.points_m), Load(pressure_pa_gauge=1e3))
    ours = SymmetricSolver().solve(state.tangent, state.external_n)
    reference = SymmetricSolver(use_pardiso=False).solve(state.tangent, state.external_n)
    np.testing.assert_allclose(ours, reference, atol=1e-8 * np.abs(reference).max())


def test_thick_cylinder_matches_its_closed_form():
    mu, a, b = 1.0e5, 1.0e-2, 2.0e-2
    law = IsochoricOgden(coefficients_pa=(0.5 * mu,), exponents=(2.0,), bulk_modulus_pa=5e3 * mu)
    lattice = Lattice(
        r_m=np.linspace(a, b, 7),
        theta_rad=np.linspace(0, np.pi, 7),
        z_m=np.array([0.0, 4e-3]),
        material=np.zeros((6, 6, 1), dtype=np.int64),
    )
    model = tube_model(lattice, {0: law})
    inner = np.isclose(model.mesh.cylindrical[:, 0], a)
    seen = []

    def record(pressure, u):
        x = model.mesh.points_m[inner] + u[inner]
        seen.append((pressure, np.hypot(x[:, 0], x[:, 1]).mean()))

    pressures = [0.2e5, 0.4e5, 0.5e5]
    outcome = follow(model, lambda p: Load(pressure_pa_gauge=p), pressures, NewtonOptions(), on_target=record)
    assert outcome.status is Status.CONVERGED
    assert seen[-1][1] > 1.3 * a
    for pressure, radius in seen:
        outer = np.sqrt(b**2 - a**2 + radius**2)
        la, lb = radius / a, outer / b
        closed = mu * (np.log(la / lb) + 0.5 * (lb**-2 - la**-2))
        assert pressure == pytest.approx(closed, rel=1e-2)


def test_a_lost_equilibrium_is_a_value():
    model = small_tube()
    steps = NewtonOptions(max_iterations=6, min_step=0.2)
    outcome = follow(model, lambda p: Load(pressure_pa_gauge=p), [5e7], steps, on_target=lambda *_: None)
    assert outcome.status is not Status.CONVERGED
    assert np.isfinite(outcome.u_m).all()
