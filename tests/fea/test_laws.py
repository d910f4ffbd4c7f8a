import numpy as np
import pytest

from fea.laws import IsochoricOgden, StVenantKirchhoff

LAWS = {
    "ogden": IsochoricOgden(coefficients_pa=(1.12e5 / 1.05, 45.0 / 4.0, 975.0 / 1.6), exponents=(1.05, 4.0, -1.6)),
    "mooney_rivlin": IsochoricOgden(coefficients_pa=(0.21e6, 0.525e6), exponents=(2.0, -2.0)),
    "st_venant_kirchhoff": StVenantKirchhoff(young_modulus_pa=2.76e9, poisson_ratio=0.417),
}


def sample_gradients() -> np.ndarray:
    rng = np.random.default_rng(3)
    general = np.eye(3) + 0.3 * rng.standard_normal((12, 3, 3))
    q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    q *= np.sign(np.linalg.det(q))
    equal = [
        np.eye(3),
        1.3 * q,
        q @ np.diag([1.5, 1.5, 0.7]) @ q.T,
        q @ np.diag([1.5, 1.5 + 1e-7, 0.7]),
        np.diag([1.2, 1.2 + 1e-5, 1.2 - 1e-5]) @ q,
    ]
    return np.concatenate([general[np.linalg.det(general) > 0.1], equal])


@pytest.mark.parametrize("name", sorted(LAWS))
def test_stress_and_tangent_are_derivatives_of_the_energy(name):
    law, F, h = LAWS[name], sample_gradients(), 1e-6
    P, A = law.stress_and_tangent(F)
    numeric_P, numeric_A = np.zeros_like(P), np.zeros_like(A)
    for i in range(3):
        for j in range(3):
            step = np.zeros((3, 3))
            step[i, j] = h
            numeric_P[:, i, j] = (law.energy(F + step) - law.energy(F - step)) / (2 * h)
            plus, minus = law.stress_and_tangent(F + step)[0], law.stress_and_tangent(F - step)[0]
            numeric_A[..., i, j] = (plus - minus) / (2 * h)
    scale = np.abs(A).max()
    assert np.abs(P - numeric_P).max() < 1e-6 * scale
    assert np.abs(A - numeric_A).max() < 1e-6 * scale


def test_mooney_rivlin_is_the_invariants_formula():
    law, F = LAWS["mooney_rivlin"], sample_gradients()
    C = np.swapaxes(F, 1, 2) @ F
    J = np.linalg.det(F)
    I1 = np.trace(C, axis1=1, axis2=2)
    I2 = 0.5 * (I1**2 - np.trace(C @ C, axis1=1, axis2=2))
    expected = 0.21e6 * (I1 * J ** (-2 / 3) - 3) + 0.525e6 * (I2 * J ** (-4 / 3) - 3)
    np.testing.assert_allclose(law.energy(F), expected, atol=1e-9 * 1e6)


@pytest.mark.parametrize("name", sorted(LAWS))
def test_energy_does_not_see_a_rotation_and_small_shear_sees_the_shear_modulus(name):
    law, F = LAWS[name], sample_gradients()
    q, _ = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))
    q *= np.sign(np.linalg.det(q))
    np.testing.assert_allclose(law.energy(q @ F), law.energy(F), rtol=1e-9, atol=1e-9 * law.shear_modulus_pa)
    gamma = 1e-5
    shear = np.eye(3)
    shear[0, 1] = gamma
    P, _ = law.stress_and_tangent(shear[None])
    assert P[0, 0, 1] / gamma == pytest.approx(law.shear_modulus_pa, rel=1e-4)
