"""A grasp made better by full trials: variations that hold in more of the same trials take its place."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from softhand_sim.grasp.choice.grasp_file import KeptGrasp, rounded
from softhand_sim.grasp.choice.search import varied
from softhand_sim.grasp.plan import GraspPlan

PARENTS = 3
"""Choice: grasps that are varied in turn; the nearest good place is not always the best."""
NARROWEST, WIDEST = 0.15, 0.8
"""Choices: spread of variations, in shares of the search's own."""


@dataclass(frozen=True, kw_only=True)
class TriedGrasp:
    """A grasp, and which trials it loses, of as many as all others had."""

    kept: KeptGrasp
    lost: tuple[int, ...]


def refined(
    tried: list[TriedGrasp],
    holds: Callable[[GraspPlan, int], bool],
    *,
    trials: int,
    budget: int,
    rng: np.random.Generator,
) -> list[TriedGrasp]:
    """Vary the best grasps; a variation that loses fewer trials takes its parent's place.

    A variation begins with the trials that its parent loses, and is given up when it cannot lose fewer any more: most
    of them cost few trials.

    Parameters
    ----------
    tried: grasps to begin with.
    holds: whether a grasp holds in the trial of a number below `trials`.
    trials: that decide.
    budget: trials to spend; the last variation may take a few more.
    rng: draws the variations.

    Returns
    -------
    The best `PARENTS` grasps, best first.
    """
    best = sorted(tried, key=lambda one: len(one.lost))[:PARENTS]
    spent, turn = 0, 0
    while spent < budget and best[0].lost:
        place = turn % len(best)
        parent, turn = best[place], turn + 1
        spread = float(np.exp(rng.uniform(np.log(NARROWEST), np.log(WIDEST))))
        plan = rounded(varied(parent.kept.plan, rng, spread))
        order = [*parent.lost, *(k for k in range(trials) if k not in parent.lost)]
        lost: list[int] = []
        for k in order:
            spent += 1
            if not holds(plan, k):
                lost.append(k)
                if len(lost) >= len(parent.lost):
                    break
        else:
            best[place] = TriedGrasp(kept=replace(parent.kept, plan=plan), lost=tuple(sorted(lost)))
            best.sort(key=lambda one: len(one.lost))
    return best
