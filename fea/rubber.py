"""Rubber-like laws by the names and parameters they are published with."""

from fea.laws import IsochoricOgden


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
