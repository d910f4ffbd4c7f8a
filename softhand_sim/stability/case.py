"""A hard case: a name, what makes it hard, two criteria, and a run at a time step."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum


class CaseOutcome(StrEnum):
    """How a case ended.

    FINITE: within its criteria, nothing to tell.
    WARNED: the product said that the result is not to be relied on (a caveat, a flag); right or not.
    TYPED: refused by an error that names the value, or ended by a typed outcome.
    DIVERGED: not finite, and nothing said so.
    WRONG: finite, outside its criteria, and nothing said so.
    """

    FINITE = "finite"
    WARNED = "warned"
    TYPED = "typed"
    DIVERGED = "diverged"
    WRONG = "wrong"


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What a run came to.

    Attributes
    ----------
    outcome: how it ended.
    criterion: what was measured, and what is allowed.
    figure: its value; 0 where nothing finite was measured.
    detail: the typed outcome, the caveats, or why it is wrong.
    """

    outcome: CaseOutcome
    criterion: str
    figure: float
    detail: str = ""


@dataclass(frozen=True, kw_only=True)
class HardCase:
    """One case; a frozen value.

    Attributes
    ----------
    name: as on the command line.
    hard: what makes it hard.
    stability, correctness: the criteria, in words.
    run: from a time step [s] to what it came to; random numbers are fixed in the case.
    """

    name: str
    hard: str
    stability: str
    correctness: str
    run: Callable[[float], Finding]


def scene_cases(*rows: tuple[str, str, str, Callable[[float], Finding]]) -> dict[str, HardCase]:
    """Return cases of scenes by name, from name, what makes each hard, what is right, and its run."""
    stability = "finite, no warning of the engine, no energy from nowhere"
    return {
        name: HardCase(name=name, hard=hard, stability=stability, correctness=right, run=run)
        for name, hard, right, run in rows
    }


def judged(
    criterion: str,
    figure: float,
    limit: float,
    *,
    typed: str = "",
    caveats: Sequence[str] = (),
    flags: Sequence[str] = (),
    detail: str = "",
) -> Finding:
    """Return the finding for a figure that may be at most ``limit``.

    ``typed`` is the typed end, if it ended so; ``caveats`` say that the result is not verified; ``flags`` tell of it
    something that does not excuse a wrong one.
    """
    said = "; ".join((*caveats, *flags))
    if typed:
        return Finding(outcome=CaseOutcome.TYPED, criterion=criterion, figure=_finite(figure), detail=typed)
    if not math.isfinite(figure):
        outcome = CaseOutcome.WARNED if caveats else CaseOutcome.DIVERGED
        return Finding(outcome=outcome, criterion=criterion, figure=0.0, detail=said or detail)
    if caveats:
        beside = "" if figure <= limit else "outside the criterion; "
        return Finding(outcome=CaseOutcome.WARNED, criterion=criterion, figure=figure, detail=beside + said)
    good = CaseOutcome.WARNED if flags else CaseOutcome.FINITE
    outcome = good if figure <= limit else CaseOutcome.WRONG
    return Finding(outcome=outcome, criterion=criterion, figure=figure, detail=detail or said)


def refused(criterion: str, job: Callable[[], object]) -> Finding:
    """Return the finding of a job that has to be refused by a ValueError."""
    try:
        job()
    except ValueError as error:
        return Finding(outcome=CaseOutcome.TYPED, criterion=criterion, figure=0.0, detail=f"REFUSED: {error}")
    return Finding(outcome=CaseOutcome.WRONG, criterion=criterion, figure=1.0, detail="not refused")


def _finite(figure: float) -> float:
    return figure if math.isfinite(figure) else 0.0
