"""Rubber-like laws by the names and parameters they are published with."""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64
from fea.laws import IsochoricOgden, Law, cofactor_derivative


@dataclass(frozen=True, kw_only=True)
class ClosedNeoHookean:
    """W = mu/2 (J^(-2/3) tr F^T F - 3) without principal stretches: the same as ``neo_hookean``, in half the time.

    With G = F^-T, I1 = tr F^T F and m = mu J^(-2/3): P = m (F - I1/3 G), and dG_iJ/dF_kL = -G_iL G_kJ gives
    A = m [1 - 2/3 (F x G + G x F) + 2/9 I1 G x G + I1/3 G_iL G_kJ] (Simo & Hughes, Computational Inelasticity, ch. 9).
    """

    shear_modulus_pa: float
    bulk_modulus_pa: float = 0.0

    def energy(self, F: F64) -> F64:
        """Return W [J/m^3], shape [...]."""
        first = (F * F).sum(axis=(-1, -2))
        return np.asarray(0.5 * self.shear_modulus_pa * (np.linalg.det(F) ** (-2.0 / 3.0) * first - 3.0))

    def stress_and_tangent(self, F: F64) -> tuple[F64, F64]:
        """Return P and A."""
        shape = F.shape[:-2]
        G = np.swapaxes(np.linalg.inv(F), -1, -2)
        first = (F * F).sum(axis=(-1, -2))[..., None, None]
        m = (self.shear_modulus_pa * np.linalg.det(F) ** (-2.0 / 3.0))[..., None, None]
        P = m * (F - first / 3.0 * G)
        left = np.stack([-2.0 / 3.0 * P, -2.0 / 3.0 * m * G], axis=-1).reshape(*shape, 9, 2)
        right = np.stack([G, F], axis=-3).reshape(*shape, 2, 9)
        A = (left @ right).reshape(*shape, 3, 3, 3, 3)
        scaled = m * first / 3.0 * G
        A += scaled[..., :, None, None, :] * np.swapaxes(G, -1, -2)[..., None, :, :, None]
        diagonal = np.arange(9)
        A.reshape(*shape, 9, 9)[..., diagonal, diagonal] += m[..., 0]
        return P, A


@dataclass(frozen=True, kw_only=True)
class PointwiseVolume:
    """A law plus kappa/2 (J - 1)^2 at each point: compressible rubber, and what most codes integrate.

    It locks in the near-incompressible range, where the element-mean energy of ``bulk_modulus_pa`` does not.
    """

    law: Law
    point_bulk_modulus_pa: float

    @property
    def bulk_modulus_pa(self) -> float:
        """The law's own modulus of the element-mean energy [Pa]."""
        return self.law.bulk_modulus_pa

    def energy(self, F: F64) -> F64:
        """Return W [J/m^3], shape [...]."""
        return np.asarray(self.law.energy(F) + 0.5 * self.point_bulk_modulus_pa * (np.linalg.det(F) - 1.0) ** 2)

    def stress_and_tangent(self, F: F64) -> tuple[F64, F64]:
        """Return P and A, with g = dJ/dF: p = kappa (J - 1) adds p g and kappa g x g + p dg/dF."""
        P, A = self.law.stress_and_tangent(F)
        J = np.linalg.det(F)
        g = J[..., None, None] * np.swapaxes(np.linalg.inv(F), -1, -2)
        p = self.point_bulk_modulus_pa * (J - 1.0)
        A = A + self.point_bulk_modulus_pa * g[..., :, :, None, None] * g[..., None, None, :, :]
        return P + p[..., None, None] * g, A + p[..., None, None, None, None] * cofactor_derivative(F)


def neo_hookean(shear_modulus_pa: float, bulk_modulus_pa: float = 0.0) -> IsochoricOgden:
    """W = mu/2 (I1bar - 3): one Ogden term with exponent 2 (Treloar, 1943)."""
    return IsochoricOgden(coefficients_pa=(0.5 * shear_modulus_pa,), exponents=(2.0,), bulk_modulus_pa=bulk_modulus_pa)


def mooney_rivlin(c10_pa: float, c01_pa: float, bulk_modulus_pa: float = 0.0) -> IsochoricOgden:
    """W = C10 (I1bar - 3) + C01 (I2bar - 3) with initial shear modulus 2 (C10 + C01) (Rivlin, 1948)."""
    return IsochoricOgden(coefficients_pa=(c10_pa, c01_pa), exponents=(2.0, -2.0), bulk_modulus_pa=bulk_modulus_pa)


def ogden(
    mu_pa: tuple[float, ...], alpha: tuple[float, ...], *, convention: str, bulk_modulus_pa: float = 0.0
) -> IsochoricOgden:
    """Return Ogden's law in one of its two published conventions.

    Parameters
    ----------
    mu_pa, alpha : tuples of equal length
    convention : str
        ``"mu_over_alpha"``: W = sum mu_k / alpha_k (...), initial shear modulus sum mu_k alpha_k / 2 (Ogden, 1972).
        ``"two_mu_over_alpha_squared"``: W = sum 2 mu_k / alpha_k^2 (...), initial shear modulus sum mu_k.
    bulk_modulus_pa : float

    Raises
    ------
    ValueError
        For an unknown convention, unequal lengths or a zero exponent.
    """
    if len(mu_pa) != len(alpha) or not mu_pa or 0.0 in alpha:
        raise ValueError(f"alpha = {alpha} must be as long as mu_pa, without zeros")
    pairs = list(zip(mu_pa, alpha, strict=True))
    if convention == "mu_over_alpha":
        coefficients = tuple(m / a for m, a in pairs)
    elif convention == "two_mu_over_alpha_squared":
        coefficients = tuple(2.0 * m / a**2 for m, a in pairs)
    else:
        raise ValueError(f"convention = {convention!r}; allowed: ['mu_over_alpha', 'two_mu_over_alpha_squared']")
    return IsochoricOgden(coefficients_pa=coefficients, exponents=alpha, bulk_modulus_pa=bulk_modulus_pa)
