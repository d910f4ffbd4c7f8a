import sys
from dataclasses import dataclass

import numpy as np
import pytest
import scipy.sparse as sp
from tests_fea_helpers import tube_model

import fea.ranges
from fea.assembly import SolidModel, element_forces
from fea.compiled import compiled_law, kernel_name
from fea.lattice import Lattice
from fea.laws import IsochoricOgden, Law, StVenantKirchhoff
from fea.load import Load
from fea.rubber import ClosedNeoHookean, PointwiseVolume, mooney_rivlin

NEO = ClosedNeoHookean(shear_modulus_pa=3e4)
LAWS = {
    "ogden": IsochoricOgden(coefficients_pa=(1.0667e5, 11.25, 609.0), exponents=(1.05, 4.0, -1.6)),
    "ogden_nearly_incompressible": IsochoricOgden(
        coefficients_pa=(1.0667e5, 11.25, 609.0), exponents=(1.05, 4.0, -1.6), bulk_modulus_pa=1e7
    ),
    "mooney_rivlin": mooney_rivlin(2.1e5, 5.25e5, 1e6),
    "st_venant_kirchhoff": StVenantKirchhoff(young_modulus_pa=2.76e9, poisson_ratio=0.417),
    "neo_hookean": NEO,
    "neo_hookean_pointwise": PointwiseVolume(law=NEO, point_bulk_modulus_pa=6e5),
    "both_volumetric_terms": PointwiseVolume(law=mooney_rivlin(2e4, 1e4, 3e5), point_bulk_modulus_pa=1e5),
}


@dataclass(frozen=True)
class Subclassed(ClosedNeoHookean):
    def energy(self, F):
        return 2.0 * super().energy(F)


def rotations(n: int, rng: np.random.Generator) -> np.ndarray:
    q, _ = np.linalg.qr(rng.standard_normal((n, 3, 3)))
    return q * np.sign(np.linalg.det(q))[:, None, None]


def sample_deformations(rng: np.random.Generator) -> np.ndarray:
    """F with random stretches in [0.3, 3], and equal and nearly equal ones, in random frames."""
    stretches = [*rng.uniform(0.3, 3.0, (40, 3)), *(1.0 + 1e-3 * rng.standard_normal((8, 3)))]
    for gap in (0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2):
        stretches += [(1.0, 1.0 + gap, 1.0), (1.5, 1.5 + gap, 0.7), (0.3, 3.0, 3.0 - gap), (3.0, 3.0 - gap, 3.0 + gap)]
    n = len(stretches)
    general = rotations(n, rng) * np.array(stretches)[:, None, :] @ rotations(n, rng)
    aligned = np.array([np.diag(s) for s in stretches])
    return np.concatenate([general, aligned])


def elements_with(F: np.ndarray, n_nodes: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacements, gradients and weights of elements whose points have the deformations F [n, points, 3, 3]."""
    n, points = F.shape[:2]
    u = rng.standard_normal((n, n_nodes, 3))
    inverse = np.linalg.pinv(np.swapaxes(u, 1, 2))[:, None]
    free = rng.standard_normal((n, points, n_nodes, 3))
    gradients = inverse @ (F - np.eye(3)) + free - inverse @ (np.swapaxes(u, 1, 2)[:, None] @ free)
    return u, np.ascontiguousarray(gradients), rng.uniform(0.5, 1.0, (n, points))


def fill(law: Law, u: np.ndarray, gradients: np.ndarray, weights: np.ndarray, *, tangent: bool = True):
    n, m, _ = u.shape
    force, upper = np.full((n, m, 3), np.nan), np.full((n, 3 * m * (3 * m + 1) // 2), np.nan)
    kernel = compiled_law(law)
    assert kernel is not None
    numbers = np.arange(n * m).reshape(n, m)
    ok = kernel.fill(u.reshape(-1, 3), numbers, np.arange(n), (gradients, weights), force, upper if tangent else None)
    return ok, force, upper


@pytest.mark.parametrize("nodes", [4, 10])
@pytest.mark.parametrize("name", sorted(LAWS))
def test_compiled_elements_are_the_reference_ones(name, nodes):
    rng = np.random.default_rng(4)
    F = sample_deformations(rng)
    points = 1 if nodes == 4 else 4
    F = F[: len(F) // points * points].reshape(-1, points, 3, 3)
    u, gradients, weights = elements_with(F, nodes, rng)
    ok, force, upper = fill(LAWS[name], u, gradients, weights)
    assert ok
    reference = element_forces(LAWS[name], u, gradients, weights)
    assert reference is not None
    largest = np.abs(reference[1]).max(axis=1)
    assert (np.abs(upper - reference[1]).max(axis=1) < 1e-12 * largest).all()
    # a force is compared with stiffness times displacement: at rest it is zero but for rounding
    scale = largest * np.abs(u).max(axis=(1, 2))
    assert (np.abs(force - reference[0]).max(axis=(1, 2)) < 1e-12 * scale).all()
    np.testing.assert_array_equal(fill(LAWS[name], u, gradients, weights, tangent=False)[1], force)


@pytest.mark.parametrize("name", sorted(LAWS))
@pytest.mark.parametrize("bad", [np.diag([1.0, 1.0, -0.2]), np.diag([1.0, 0.0, 1.0]), np.full((3, 3), np.nan)])
def test_an_inverted_or_undefined_point_is_reported(name, bad):
    rng = np.random.default_rng(5)
    F = np.tile(np.eye(3), (600, 4, 1, 1))
    u, gradients, weights = elements_with(F, 10, rng)
    assert fill(LAWS[name], u, gradients, weights)[0]
    F[-1, -1] = bad
    gradients[-1] = elements_with(F[-1:], 10, rng)[1] if np.isnan(bad).any() else _matching(u[-1], F[-1])
    assert not fill(LAWS[name], u, gradients, weights)[0]


def _matching(u: np.ndarray, F: np.ndarray) -> np.ndarray:
    return np.linalg.pinv(u.T) @ (F - np.eye(3))


def tube(*, compiled: bool = True) -> SolidModel:
    material = np.zeros((3, 3, 3), dtype=np.int64)
    material[1, :, 1] = 1
    material[2, :, 2] = 2
    lattice = Lattice(
        r_m=np.array([3e-3, 4.2e-3, 4.8e-3, 5.5e-3]),
        theta_rad=np.linspace(0, np.pi, 4),
        z_m=np.array([0.0, 0.7e-3, 1.2e-3, 2e-3]),
        material=material,
    )
    names = ("ogden_nearly_incompressible", "st_venant_kirchhoff", "neo_hookean_pointwise")
    model = tube_model(lattice, {i: LAWS[name] for i, name in enumerate(names)})
    fixed = np.ones(model.mesh.points_m.size, dtype=bool)
    fixed[model.free] = False
    return SolidModel(
        mesh=model.mesh, laws=model.laws, fixed=fixed.reshape(-1, 3), cavity=model.cavity, compiled=compiled
    )


def noise(model: SolidModel, size_m: float) -> np.ndarray:
    return size_m * np.random.default_rng(1).standard_normal(model.mesh.points_m.shape)


def test_a_model_with_all_kinds_of_laws_is_the_numpy_one_and_derives_from_its_energy():
    model, plain = tube(), tube(compiled=False)
    u, load = noise(model, 2e-5), Load(pressure_pa_gauge=2e4)
    state, reference = model.evaluate(u, load), plain.evaluate(u, load)
    for name in ("internal_n", "external_n", "reaction_n"):
        a, b = getattr(state, name), getattr(reference, name)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-12 * np.abs(reference.reaction_n).max())
    difference = state.tangent - reference.tangent
    assert np.abs(difference.data).max() < 1e-12 * np.abs(reference.tangent.data).max()
    full = sp.csr_array(state.tangent + sp.triu(state.tangent, k=1).T)
    v = np.zeros_like(u)
    v.reshape(-1)[model.free] = np.random.default_rng(2).standard_normal(len(model.free))
    h = 1e-9
    slope = (model.energy(u + 10 * h * v, load) - model.energy(u - 10 * h * v, load)) / (20 * h)
    work = float((state.internal_n - state.external_n) @ v.ravel()[model.free])
    assert slope == pytest.approx(work, rel=1e-6)
    plus, minus = model.evaluate(u + h * v, load), model.evaluate(u - h * v, load)
    change = ((plus.internal_n - plus.external_n) - (minus.internal_n - minus.external_n)) / (2 * h)
    expected = full @ v.ravel()[model.free]
    assert np.linalg.norm(change - expected) < 1e-6 * np.linalg.norm(expected)


def test_results_do_not_depend_on_threads_to_the_last_bit(monkeypatch):
    model = tube()
    u, load = noise(model, 2e-5), Load(pressure_pa_gauge=2e4)
    monkeypatch.setattr(fea.compiled, "_ELEMENTS", 7)
    monkeypatch.setattr("fea.gather._PLACES", 100)
    states = []
    for threads in (1, 2, 3):
        monkeypatch.setattr(fea.ranges, "thread_count", lambda n=threads: n)
        states.append(model.evaluate(u, load))
    for other in states[1:]:
        np.testing.assert_array_equal(other.tangent.data, states[0].tangent.data)
        np.testing.assert_array_equal(other.reaction_n, states[0].reaction_n)


def test_forces_alone_are_those_that_come_with_the_tangent():
    for model in (tube(), tube(compiled=False)):
        u, load = noise(model, 2e-5), Load(pressure_pa_gauge=2e4)
        with_tangent, alone = model.evaluate(u, load), model.evaluate(u, load, tangent=False)
        assert alone.tangent is None
        np.testing.assert_array_equal(alone.reaction_n, with_tangent.reaction_n)


def test_only_laws_of_exactly_the_known_types_run_compiled():
    assert compiled_law(NEO) is not None
    assert compiled_law(Subclassed(shear_modulus_pa=1.0)) is None
    assert compiled_law(PointwiseVolume(law=Subclassed(shear_modulus_pa=1.0), point_bulk_modulus_pa=1.0)) is None


def test_everything_works_without_numba(monkeypatch):
    compiled = tube()
    u = noise(compiled, 2e-5)
    state = compiled.evaluate(u, Load())
    assert kernel_name() == "numba"
    for name in [n for n in sys.modules if n.split(".")[0] == "numba" or n == "fea.kernels"]:
        monkeypatch.setitem(sys.modules, name, None)
    assert kernel_name() == "NumPy"
    plain = tube().evaluate(u, Load())
    np.testing.assert_allclose(
        plain.internal_n, state.internal_n, rtol=0.0, atol=1e-12 * np.abs(state.reaction_n).max()
    )
