"""Bands: what a source of uncertainty does to a finger's figures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from softhand_sim.uncertainty.blend import drawn_coordinates, weights
from softhand_sim.uncertainty.ensemble import Ensemble, Member, Source

DRAWS = 4000
"""Choice: the ends of the 95 % interval then move by 1 % of its width from seed to seed."""
CONFIDENCE = 0.95

Figures = Mapping[str, Mapping[str, float | None]]
"""Figures by name, of each member by name."""
_Values = Callable[[str], list[float | None]]


@dataclass(frozen=True, kw_only=True)
class Band:
    """An interval of a figure that holds the nominal value; None if nothing could be measured.

    ``missing`` names scenarios that have no value there.
    """

    nominal: float | None
    low: float | None
    high: float | None
    missing: tuple[str, ...] = ()


def tolerance_band(ensemble: Ensemble, source: Source, figures: Figures, *, spread: float = 1.0) -> dict[str, Band]:
    """Return the range of each figure over a tolerance: everything between its two ends and the nominal finger.

    An end without a calibration is the other one mirrored.
    """
    ends = [weights(ensemble, {source.name: at}) for at in (-spread, spread)]
    return _bands(ensemble, figures, lambda name: [_at(ensemble, figures, name, end) for end in ends], source.solved)


def scenario_band(ensemble: Ensemble, source: Source, figures: Figures) -> dict[str, Band]:
    """Return least and largest of each figure over the nominal finger and the scenarios."""

    def values(name: str) -> list[float | None]:
        return [figures[member.name][name] for member in source.solved]

    return _bands(ensemble, figures, values, source.members)


def combined_band(
    ensemble: Ensemble, figures: Figures, rng: np.random.Generator, *, spread: float = 1.0
) -> dict[str, Band]:
    """Return the 95 % interval of each figure over all tolerances at once.

    Each is uniform in its interval and independent of the others (choice: a tolerance states its ends and nothing
    else). Figures are linear between the nominal finger and the members, and differences add up.
    """
    drawn = [weights(ensemble, at) for at in drawn_coordinates(ensemble, DRAWS, rng, spread=spread)]
    members = {member.name: member for at in drawn for member, _ in at}

    def values(name: str) -> list[float | None]:
        nominal = figures[ensemble.nominal.name][name]
        found = {key: figures[key][name] for key in members}
        if nominal is None or any(value is None for value in found.values()):
            return []
        slopes = {key: value - nominal for key, value in found.items() if value is not None}
        all_values = [nominal + sum(share * slopes[member.name] for member, share in at) for at in drawn]
        tail = 50.0 * (1.0 - CONFIDENCE)
        return [float(v) for v in np.percentile(all_values, [tail, 100.0 - tail])]

    return _bands(ensemble, figures, values, tuple(members.values()))


def _at(ensemble: Ensemble, figures: Figures, name: str, shares: Sequence[tuple[Member, float]]) -> float | None:
    """Return a figure of the finger that has shares of some members' differences."""
    value = figures[ensemble.nominal.name][name]
    for member, share in shares:
        other, nominal = figures[member.name][name], figures[ensemble.nominal.name][name]
        if value is None or other is None or nominal is None:
            return None
        value += share * (other - nominal)
    return value


def _bands(ensemble: Ensemble, figures: Figures, values: _Values, members: Sequence[Member]) -> dict[str, Band]:
    bands = {}
    for name, nominal in figures[ensemble.nominal.name].items():
        known = [value for value in (nominal, *values(name)) if value is not None]
        missing = [m.name for m in members if m.calibration is None or figures[m.name][name] is None]
        bands[name] = Band(
            nominal=nominal,
            low=min(known, default=None),
            high=max(known, default=None),
            missing=tuple(missing),
        )
    return bands
