"""A hard case of the solid: a name, what makes it hard, two criteria, and a run. It has no time step."""

import math
from collections.abc import Callable
from dataclasses import dataclass

OUTCOMES = ("finite", "typed", "diverged", "wrong")


@dataclass(frozen=True, kw_only=True)
class SolidFinding:
    """What a run came to.

    Attributes
    ----------
    outcome : str
        One of ``OUTCOMES``: finite within its criteria; a typed status or a refusal; not finite; or finite, outside
        its criteria and silent about it.
    criterion : str
        What was measured, and what is allowed.
    figure : float
        Its value; 0 where nothing finite was measured.
    detail : str
        The status, or why it is wrong.
    """

    outcome: str
    criterion: str
    figure: float
    detail: str = ""


@dataclass(frozen=True, kw_only=True)
class SolidCase:
    """One case; a frozen value. ``name`` as on the command line, ``hard`` what makes it hard, the criteria in words."""

    name: str
    hard: str
    stability: str
    correctness: str
    run: Callable[[], SolidFinding]


def judged(criterion: str, figure: float, limit: float, *, typed: str = "", detail: str = "") -> SolidFinding:
    """Return the finding for a figure that may be at most ``limit``, or for a typed end."""
    known = figure if math.isfinite(figure) else 0.0
    if typed:
        return SolidFinding(outcome="typed", criterion=criterion, figure=known, detail=typed)
    if not math.isfinite(figure):
        return SolidFinding(outcome="diverged", criterion=criterion, figure=0.0, detail=detail)
    outcome = "finite" if figure <= limit else "wrong"
    return SolidFinding(outcome=outcome, criterion=criterion, figure=figure, detail=detail)
