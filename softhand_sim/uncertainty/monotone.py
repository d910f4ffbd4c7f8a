"""The monotone torque law nearest to one that is not quite: differences that add up may leave the monotone ones."""

from math import asin, copysign, sin, sqrt

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

UP_TO_RAD = 0.9
"""Choice: the angles at which laws are compared; a joint turns 0.6 rad at 80 kPa, and more where another is blocked."""
_POINTS = 30


def nearest_monotone(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Return the cubic a q + b q^2 + c q^3 of nowhere negative slope that is nearest over 0 to 0.9 rad.

    Least squares over a = s^2, c = t^2, b = sqrt(3) s t sin(phi), which are the monotone cubics with a, c >= 0 and
    b^2 <= 3 a c. A monotone cubic is returned as it is.

    Parameters
    ----------
    a, b, c : float
        N m/rad, N m/rad2, N m/rad3; a above 0.

    Raises
    ------
    ValueError
        If ``a`` is not above 0: the law is too far from a monotone one.
    """
    if a <= 0.0:
        raise ValueError(f"stiffness_n_m_per_rad = {a:g}: must be above 0; the members are too far apart to add up")
    if c >= 0.0 and b * b <= 3.0 * a * c:
        return a, b, c
    u = np.linspace(0.0, 1.0, _POINTS + 1)[1:]
    unit = np.array([a * UP_TO_RAD, b * UP_TO_RAD**2, c * UP_TO_RAD**3])
    scale = float(np.abs(unit).sum())

    def law(x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        s, t, phi = x
        return scale * np.array([s * s, sqrt(3.0) * s * t * sin(phi), t * t])

    def error(x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        found = law(x) - unit
        return np.asarray(u * (found[0] + u * (found[1] + u * found[2])) / scale)

    start = sqrt(a * UP_TO_RAD / scale)
    size = max(abs(b) * UP_TO_RAD**2 / (sqrt(3.0) * start * scale), 1e-3)
    found = law(least_squares(error, [start, size, copysign(asin(0.95), b)], xtol=1e-14, ftol=1e-14, gtol=1e-14).x)
    return float(found[0] / UP_TO_RAD), float(found[1] / UP_TO_RAD**2), float(found[2] / UP_TO_RAD**3)
