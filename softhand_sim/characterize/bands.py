"""Mean and 95 % confidence band over repeats."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.stats import t as student

CONFIDENCE = 0.95


@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """Mean over the repeats and half width of its 95 % band (Student's t), both of one repeat's shape."""

    mean: npt.NDArray[np.float64]
    half_width: npt.NDArray[np.float64]


def confidence_band(samples: npt.NDArray[np.float64]) -> Band:
    """Return the band of ``samples``, shape (repeats, ...), repeats >= 2.

    Raises
    ------
    ValueError
        If there are fewer than two repeats.
    """
    repeats = samples.shape[0]
    if repeats < 2:
        raise ValueError(f"repeats = {repeats}: must be 2 or above for a band")
    spread = samples.std(axis=0, ddof=1) / np.sqrt(repeats)
    return Band(mean=samples.mean(axis=0), half_width=spread * float(student.ppf(0.5 + 0.5 * CONFIDENCE, repeats - 1)))
