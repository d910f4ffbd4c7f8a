"""An interval of the success rate of one hand that is not known exactly: scatter of the trials and of the finger."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.stats import beta

CONFIDENCE = 0.95
_JEFFREYS = 0.5


@dataclass(frozen=True, kw_only=True)
class SuccessBand:
    """Success rate of a hand drawn from a spread of fingers.

    Attributes
    ----------
    held, trials : int
        Over all fingers.
    rate : float
        Share held.
    low, high : float
        95 % interval of the rate of one such hand.
    shares : mapping
        What part of the rate's variance belongs to ``trials`` (their number), to each source of tolerance, and to
        ``rest``, what differs between fingers and follows no source in a straight line. They add up to 1; sources are
        left out where there are too few fingers to tell.
    """

    held: int
    trials: int
    rate: float
    low: float
    high: float
    shares: Mapping[str, float]


def success_interval(held: Sequence[int], trials: int) -> tuple[float, float]:
    """Return the 95 % interval of the success rate of a hand that is one of several, each as likely.

    The mixture of the fingers' posteriors, Beta(held + 1/2, lost + 1/2) each (Jeffreys' prior; Brown, Cai, DasGupta,
    Stat. Sci. 16, 2001). Fingers that do alike give Jeffreys' interval of one finger's trials, however many they are:
    all fingers see the same trials.

    Parameters
    ----------
    held
        Trials held by each finger, (n,).
    trials
        Trials of each finger.

    Raises
    ------
    ValueError
        If there is no finger or no trial, or one holds more than ``trials`` or fewer than 0.
    """
    a, b = _posterior(held, trials)
    tail = 0.5 * (1.0 - CONFIDENCE)

    def quantile(p: float) -> float:
        return float(brentq(lambda x: float(np.mean(beta.cdf(x, a, b))) - p, 0.0, 1.0, xtol=1e-12))

    # as usual for Jeffreys: all or none held reaches to the end
    low = 0.0 if sum(held) == 0 else quantile(tail)
    high = 1.0 if sum(held) == trials * len(held) else quantile(1.0 - tail)
    return low, high


def success_band(held: Sequence[int], trials: int, coordinates: Sequence[Mapping[str, float]]) -> SuccessBand:
    """Return the success rate of a hand drawn from a spread, and what its uncertainty is made of.

    The variance of the mixture is the mean of the posteriors' variances, that of the trials, and the variance of their
    means, that of the fingers (law of total variance). The latter is shared out by a linear regression on the
    coordinates, each source getting its slope times its covariance with the means (Pratt, 1987).

    Parameters
    ----------
    held, trials
        As in :func:`success_interval`.
    coordinates
        Place of each finger on the axis of each source, (n,).

    Raises
    ------
    ValueError
        As in :func:`success_interval`, or if there are not as many coordinates as fingers.
    """
    if len(coordinates) != len(held):
        raise ValueError(f"coordinates: {len(coordinates)} given for {len(held)} fingers")
    low, high = success_interval(held, trials)
    a, b = _posterior(held, trials)
    mean = a / (a + b)
    within = float((mean * (1.0 - mean) / (a + b + 1.0)).mean())
    by_source, rest = _by_source(mean, coordinates)
    total = within + float(mean.var())
    shares = {"trials": within / total, **{name: v / total for name, v in by_source.items()}, "rest": rest / total}
    number = trials * len(held)
    return SuccessBand(held=sum(held), trials=number, rate=sum(held) / number, low=low, high=high, shares=shares)


def _posterior(held: Sequence[int], trials: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    if not held or trials < 1:
        raise ValueError(f"held: {len(held)} fingers of {trials} trials: must be 1 or more of each")
    for k, number in enumerate(held):
        if not 0 <= number <= trials:
            raise ValueError(f"held[{k}] = {number}: must lie in [0, {trials}]")
    counts = np.array(held, dtype=np.float64)
    return counts + _JEFFREYS, trials - counts + _JEFFREYS


def _by_source(
    mean: npt.NDArray[np.float64], coordinates: Sequence[Mapping[str, float]]
) -> tuple[dict[str, float], float]:
    """Return each source's part of the variance of the fingers' means, and the rest of it."""
    names = [name for name in coordinates[0] if len({row[name] for row in coordinates}) > 1]
    variance = float(mean.var())
    # a plane through as many points as it has unknowns would explain any scatter
    if not names or len(mean) < len(names) + 3:
        return {}, variance
    x = np.array([[row[name] for name in names] for row in coordinates])
    x, y = x - x.mean(axis=0), mean - mean.mean()
    slope, *_ = np.linalg.lstsq(x, y, rcond=None)
    parts = slope * (x * y[:, None]).mean(axis=0)
    found = {name: max(0.0, float(part)) for name, part in zip(names, parts, strict=True)}
    return found, max(0.0, variance - sum(found.values()))
