"""The catalogue in two halves: one that choices may be made on, one that is only reported."""

from collections.abc import Iterable, Sequence

from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome

DEVELOPMENT, REPORT = "development", "report"


def half(names: Iterable[str], which: str) -> list[str]:
    """Return the names of one half: of the sorted names the first, third, ... are for development.

    Raises
    ------
    ValueError
        If `which` is neither half's name.
    """
    if which not in (DEVELOPMENT, REPORT):
        raise ValueError(f"half: {which!r} must be {DEVELOPMENT} or {REPORT}")
    return sorted(names)[which == REPORT :: 2]


def held_in_halves(results: Sequence[TrialResult], catalogue: Iterable[str]) -> str:
    """Return in a line what was held of each half; empty unless all of the catalogue was tried."""
    names = set(catalogue)
    if not names <= {result.object for result in results}:
        return ""
    parts = []
    for which in (DEVELOPMENT, REPORT):
        own = [result for result in results if result.object in half(names, which)]
        held = sum(result.outcome is Outcome.HELD for result in own)
        parts.append(f"{which} half: {held} of {len(own)} held ({held / len(own):.0%})")
    return "; ".join(parts)
