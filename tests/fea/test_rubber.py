from dataclasses import dataclass

import numpy as np
import pytest

from fea.arrays import F64
from fea.assembly import SolidModel
from fea.laws import Law
from fea.load import Load
from fea.meshes import linear_mesh, rectangle, sweep
from fea.mixed import MixedModel
from fea.rubber import ClosedNeoHookean, mooney_rivlin, neo_hookean, ogden


def small_shear_modulus(law: Law) -> float:
    F = np.eye(3)
    F[0, 1] = 1e-5
    return float(law.stress_and_tangent(F[None])[0][0, 0, 1] / 1e-5)


@dataclass(frozen=True, kw_only=True)
class Softened:
    """Damage-like wrapper: a law by composition, every stress multiplied by 1 - damage."""

    law: Law
    damage: float

    @property
    def bulk_modulus_pa(self) -> float:
        return (1.0 - self.damage) * self.law.bulk_modulus_pa

    def energy(self, F: F64) -> F64:
        return (1.0 - self.damage) * self.law.energy(F)

    def stress_and_tangent(self, F: F64) -> tuple[F64, F64]:
        P, A = self.law.stress_and_tangent(F)
        return (1.0 - self.damage) * P, (1.0 - self.damage) * A


def test_initial_shear_moduli_by_name_and_convention():
    assert small_shear_modulus(neo_hookean(3e4)) == pytest.approx(3e4, rel=1e-6)
    assert small_shear_modulus(mooney_rivlin(2e4, 1e4)) == pytest.approx(6e4, rel=1e-6)
    mu, alpha = (3e4, 2e2, -1e3), (1.3, 5.0, -2.0)
    over_alpha = ogden(mu, alpha, convention="mu_over_alpha")
    two_mu = ogden(mu, alpha, convention="two_mu_over_alpha_squared")
    assert small_shear_modulus(over_alpha) == pytest.approx(0.5 * np.dot(mu, alpha), rel=1e-6)
    assert small_shear_modulus(two_mu) == pytest.approx(sum(mu), rel=1e-6)


@pytest.mark.parametrize(
    ("mu", "alpha", "convention", "named"),
    [((1.0,), (2.0,), "other", "convention"), ((1.0,), (0.0,), "mu_over_alpha", "alpha"), ((), (), "x", "alpha")],
)
def test_bad_ogden_parameters_are_named(mu, alpha, convention, named):
    with pytest.raises(ValueError, match=named):
        ogden(mu, alpha, convention=convention)


def block(law: Law, *, linear: bool = False) -> SolidModel:
    grid = np.linspace(0.0, 1.0, 3)
    mesh = sweep(rectangle(grid, grid), grid)
    if linear:
        mesh = linear_mesh(mesh)
    fixed = np.repeat((mesh.points_m[:, 2] == 0.0)[:, None], 3, axis=1)
    return SolidModel(mesh=mesh, laws={0: law}, fixed=fixed)


def test_any_law_can_be_wrapped_without_subclassing():
    law = ogden((3e4, 2e2, -1e3), (1.3, 5.0, -2.0), convention="mu_over_alpha", bulk_modulus_pa=1e6)
    plain, soft = block(law), block(Softened(law=law, damage=0.3))
    u = 0.02 * np.random.default_rng(0).standard_normal(plain.mesh.points_m.shape)
    a, b = plain.evaluate(u, Load()), soft.evaluate(u, Load())
    np.testing.assert_allclose(b.internal_n, 0.7 * a.internal_n, rtol=0.0, atol=1e-12 * np.abs(a.internal_n).max())
    np.testing.assert_allclose(b.tangent.data, 0.7 * a.tangent.data, rtol=1e-9, atol=1e-6)
    assert soft.energy(u, Load()) == pytest.approx(0.7 * plain.energy(u, Load()), rel=1e-12)


def test_linear_tetrahedra_derive_from_their_energy_and_have_their_weight():
    model = block(neo_hookean(1e4, 1e5), linear=True)
    rng = np.random.default_rng(1)
    u = 0.02 * rng.standard_normal(model.mesh.points_m.shape)
    v = np.zeros_like(u)
    v.reshape(-1)[model.free] = rng.standard_normal(len(model.free))
    h = 1e-6
    slope = (model.energy(u + h * v, Load()) - model.energy(u - h * v, Load())) / (2 * h)
    state = model.evaluate(u, Load())
    assert slope == pytest.approx(float(state.internal_n @ v.ravel()[model.free]), rel=1e-7)
    plus, minus = model.evaluate(u + h * v, Load()), model.evaluate(u - h * v, Load())
    change = (plus.internal_n - minus.internal_n) / (2 * h)
    upper = state.tangent
    product = upper @ v.ravel()[model.free] + upper.T @ v.ravel()[model.free] - upper.diagonal() * v.ravel()[model.free]
    assert np.linalg.norm(change - product) < 1e-6 * np.linalg.norm(product)
    weight = model.gravity_force({0: 1000.0}, np.array([0.0, 0.0, -9.81]))
    assert weight.sum(axis=0) == pytest.approx([0.0, 0.0, -9810.0])


def test_mixed_tangent_is_the_derivative_of_its_residual():
    grid = np.linspace(0.0, 1.0, 3)
    mesh = sweep(rectangle(grid, grid), grid)
    fixed = np.repeat((mesh.points_m[:, 2] == 0.0)[:, None], 3, axis=1)
    model = MixedModel(mesh=mesh, laws={0: neo_hookean(1.0, 50.0)}, fixed=fixed)
    rng = np.random.default_rng(2)
    u = 0.02 * rng.standard_normal(mesh.points_m.shape) * ~fixed
    p = rng.standard_normal(model.n_vertices)
    direction = rng.standard_normal(model.size)
    v = np.zeros_like(u)
    v.reshape(-1)[model.free] = direction[: len(model.free)]
    q = direction[len(model.free) :]  # the pressure's unit is the shear modulus, here 1
    h = 1e-6
    plus, minus = (model.evaluate(u + s * h * v, p + s * h * q, Load())[0] for s in (1.0, -1.0))
    upper = model.evaluate(u, p, Load())[2]
    product = upper @ direction + upper.T @ direction - upper.diagonal() * direction
    assert np.linalg.norm((minus - plus) / (2 * h) - product) < 1e-6 * np.linalg.norm(product)


def test_closed_neo_hookean_is_the_ogden_term_with_exponent_two():
    rng = np.random.default_rng(4)
    F = np.concatenate([np.eye(3)[None], np.eye(3) + 0.2 * rng.standard_normal((20, 3, 3))])
    closed, spectral = ClosedNeoHookean(shear_modulus_pa=3.0), neo_hookean(3.0)
    np.testing.assert_allclose(closed.energy(F), spectral.energy(F), atol=1e-13)
    for a, b in zip(closed.stress_and_tangent(F), spectral.stress_and_tangent(F), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12 * np.abs(b).max())


def test_mixed_form_needs_a_bulk_modulus():
    model = block(neo_hookean(1.0))
    with pytest.raises(ValueError, match="bulk modulus"):
        MixedModel(mesh=model.mesh, laws=model.laws, fixed=np.zeros_like(model.mesh.points_m, dtype=bool))
