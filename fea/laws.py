"""Constitutive laws: first Piola-Kirchhoff stress P = dW/dF and consistent tangent A = dP/dF, batched over points.

Rubber-like laws here are the isochoric part only; the volumetric part acts on the element's mean dilatation and
lives in :mod:`fea.assembly`.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fea.arrays import F64

_PAIRS = ((0, 1), (0, 2), (1, 2))


class Law(Protocol):
    """What the assembly needs of a material."""

    @property
    def bulk_modulus_pa(self) -> float:
        """Modulus kappa of the element-mean volumetric energy kappa/2 (J - 1)^2, 0 where the law has its own."""
        ...

    def energy(self, F: F64) -> F64:
        """Return W [J/m^3], shape [...], of deformation gradients F, shape [..., 3, 3]."""
        ...

    def stress_and_tangent(self, F: F64) -> tuple[F64, F64]:
        """Return P [Pa], shape [..., 3, 3], and A_iJjL = dP_iJ/dF_jL [Pa], shape [..., 3, 3, 3, 3]."""
        ...


@dataclass(frozen=True, kw_only=True)
class IsochoricOgden:
    """W = sum_k c_k (l1^a_k + l2^a_k + l3^a_k - 3) of the isochoric stretches l_i = J^(-1/3) lambda_i.

    Ogden (1972), Proc. R. Soc. A 326. The classical form has c_k = mu_k / alpha_k. Mooney-Rivlin is the special case
    alpha = (2, -2), c = (C10, C01), since the second isochoric invariant is the sum of l_i^-2.
    """

    coefficients_pa: tuple[float, ...]
    exponents: tuple[float, ...]
    bulk_modulus_pa: float = 0.0

    @property
    def shear_modulus_pa(self) -> float:
        """Initial shear modulus, half the sum of c_k alpha_k^2 [Pa]."""
        return 0.5 * sum(c * a * a for c, a in zip(self.coefficients_pa, self.exponents, strict=True))

    def energy(self, F: F64) -> F64:
        """Return W [J/m^3], shape [...]."""
        squared = np.linalg.eigvalsh(np.swapaxes(F, -1, -2) @ F)
        strain = 0.5 * np.log(squared)
        strain = strain - strain.mean(axis=-1, keepdims=True)
        total = np.zeros(strain.shape[:-1])
        for c, a in zip(self.coefficients_pa, self.exponents, strict=True):
            total += c * np.expm1(a * strain).sum(axis=-1)
        return total

    def stress_and_tangent(self, F: F64) -> tuple[F64, F64]:
        """Return P and A in the principal frame of C = F^T F (Simo & Hughes, Computational Inelasticity, ch. 6)."""
        squared, N = np.linalg.eigh(np.swapaxes(F, -1, -2) @ F)
        strain = 0.5 * np.log(squared)
        tau, hessian, slope = self._principal(strain)
        S = tau / squared
        # D_ab = coefficient of N_a N_a N_b N_b in dS/dE, gamma_ab that of the shear dyads
        D = hessian / (squared[..., :, None] * squared[..., None, :])
        diagonal = np.arange(3)
        D[..., diagonal, diagonal] -= 2.0 * tau / squared**2

        M = np.zeros((*strain.shape[:-1], 3, 3, 3, 3))
        for a in range(3):
            for b in range(3):
                M[..., a, a, b, b] += D[..., a, b]
                # geometric stiffness delta_ij S_JL written in the principal frame
                M[..., a, b, a, b] += S[..., b] / squared[..., a]
        for pair, (a, b) in enumerate(_PAIRS):
            gamma = (slope[..., pair] - 0.5 * (tau[..., a] + tau[..., b])) / (squared[..., a] * squared[..., b])
            for i, j in ((a, b), (b, a)):
                M[..., i, j, i, j] += gamma
                M[..., i, j, j, i] += gamma

        n = F @ N  # columns n_a = F N_a
        P = (n * S[..., None, :]) @ np.swapaxes(N, -1, -2)
        shape = F.shape[:-2]
        dyads = (np.swapaxes(n, -1, -2)[..., :, None, :, None] * np.swapaxes(N, -1, -2)[..., None, :, None, :]).reshape(
            *shape, 9, 9
        )  # row (a, b), column (i, J)
        A = np.swapaxes(dyads, -1, -2) @ (M.reshape(*shape, 9, 9) @ dyads)
        return P, A.reshape(*shape, 3, 3, 3, 3)

    def _principal(self, strain: F64) -> tuple[F64, F64, F64]:
        """Kirchhoff stresses tau_i, their derivatives d tau_i / d e_j, and (tau_j - tau_i) / (2 tanh(e_j - e_i)).

        The last is written with sinh(x)/x and tanh(x)/x, hence exact where stretches are equal.
        """
        mean = strain.mean(axis=-1, keepdims=True)
        isochoric = strain - mean
        tau = np.zeros_like(strain)
        hessian = np.zeros((*strain.shape, 3))
        slope = np.zeros_like(strain)
        for c, a in zip(self.coefficients_pa, self.exponents, strict=True):
            power = np.exp(a * isochoric)
            average = power.mean(axis=-1, keepdims=True)
            tau += c * a * (power - average)
            term = -(power[..., :, None] + power[..., None, :] - average[..., None]) / 3.0
            index = np.arange(3)
            term[..., index, index] += power
            hessian += c * a * a * term
            for pair, (i, j) in enumerate(_PAIRS):
                d = strain[..., j] - strain[..., i]
                middle = np.exp(0.5 * a * (isochoric[..., i] + isochoric[..., j]))
                slope[..., pair] += 0.5 * c * a * a * middle * _sinhc(0.5 * a * d) / _tanhc(d)
        return tau, hessian, slope


@dataclass(frozen=True, kw_only=True)
class StVenantKirchhoff:
    """Linear elasticity in the Green strain: S = lambda tr(E) I + 2 mu E, compressible, integrated pointwise."""

    young_modulus_pa: float
    poisson_ratio: float
    bulk_modulus_pa: float = 0.0

    @property
    def shear_modulus_pa(self) -> float:
        """Shear modulus E / (2 (1 + nu)) [Pa]."""
        return self.young_modulus_pa / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def lame_pa(self) -> float:
        """First Lame constant E nu / ((1 + nu)(1 - 2 nu)) [Pa]."""
        nu = self.poisson_ratio
        return self.young_modulus_pa * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))

    def energy(self, F: F64) -> F64:
        """Return W [J/m^3], shape [...]."""
        E = 0.5 * (np.swapaxes(F, -1, -2) @ F - np.eye(3))
        trace = np.trace(E, axis1=-2, axis2=-1)
        return np.asarray(0.5 * self.lame_pa * trace**2 + self.shear_modulus_pa * (E * E).sum(axis=(-1, -2)))

    def stress_and_tangent(self, F: F64) -> tuple[F64, F64]:
        """Return P and A."""
        lame, mu = self.lame_pa, self.shear_modulus_pa
        E = 0.5 * (np.swapaxes(F, -1, -2) @ F - np.eye(3))
        S = lame * np.trace(E, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) + 2.0 * mu * E
        left = F @ np.swapaxes(F, -1, -2)
        A = lame * F[..., :, :, None, None] * F[..., None, None, :, :]
        A += mu * F[..., :, None, None, :] * np.swapaxes(F, -1, -2)[..., None, :, :, None]
        A += mu * left[..., :, None, :, None] * np.eye(3)[:, None, :]
        A += np.eye(3)[:, None, :, None] * S[..., None, :, None, :]
        return F @ S, A


def _sinhc(x: F64) -> F64:
    small = np.abs(x) < 1e-4
    safe = np.where(small, 1.0, x)
    return np.where(small, 1.0 + x * x / 6.0, np.sinh(safe) / safe)


def _tanhc(x: F64) -> F64:
    small = np.abs(x) < 1e-4
    safe = np.where(small, 1.0, x)
    return np.where(small, 1.0 - x * x / 3.0, np.tanh(safe) / safe)


def cofactor_derivative(F: F64) -> F64:
    """Return d2 det(F) / dF_iJ dF_jL = eps_ijk eps_JLM F_kM, shape [..., 3, 3, 3, 3]."""
    H = np.zeros((*F.shape[:-2], 3, 3, 3, 3))
    for i, j, k, s in _PERMUTATIONS:
        for J, L, M, t in _PERMUTATIONS:
            H[..., i, J, j, L] += s * t * F[..., k, M]
    return H


_PERMUTATIONS = ((0, 1, 2, 1), (1, 2, 0, 1), (2, 0, 1, 1), (0, 2, 1, -1), (2, 1, 0, -1), (1, 0, 2, -1))
