"""Variations by trials: nearer to the best place, within the budget, and cheap where they are worse."""

import numpy as np
import pytest

from softhand_sim.grasp.choice.grasp_file import KeptGrasp
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.refine import PARENTS, TriedGrasp, refined

BEST = np.array([0.012, -0.008, 0.10])
TRIALS = 20


def away_m(plan):
    return float(np.linalg.norm(np.array(plan.wrist_pose[:3]) - BEST))


def holds(plan, number):
    """The nearer, the more trials."""
    return away_m(plan) < 0.001 * (number + 1)


def begin(plan):
    return TriedGrasp(kept=KeptGrasp(plan=plan), lost=tuple(k for k in range(TRIALS) if not holds(plan, k)))


START = begin(GraspPlan(wrist_pose=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0), retreat=(0.0, 0.0, 1.0)))


def run(budget, seed=0):
    asked = []

    def counted(plan, number):
        asked.append((plan, number))
        return holds(plan, number)

    best = refined([START], counted, trials=TRIALS, budget=budget, rng=np.random.default_rng(seed))
    return best, asked


def test_more_trials_get_nearer():
    lost = [len(run(budget)[0][0].lost) for budget in (0, 100, 1000)]
    assert lost[0] == len(START.lost) == 14
    assert lost[0] > lost[1] > lost[2]


def test_losses_are_those_of_the_grasp_that_is_returned():
    best, _ = run(300)
    assert len(best) <= PARENTS
    for one in best:
        assert one == begin(one.kept.plan)


def test_the_budget_is_kept_and_a_worse_variation_given_up_early():
    _, asked = run(200)
    assert 200 <= len(asked) < 200 + TRIALS
    plans = list(dict.fromkeys(plan for plan, _ in asked))
    worse = [plan for plan in plans if away_m(plan) > 0.014]
    # one that loses all that its parent loses is asked no more than that
    assert worse
    assert all(sum(plan is one for one, _ in asked) <= len(START.lost) for plan in worse)


def test_nothing_is_varied_that_loses_nothing():
    perfect = TriedGrasp(kept=START.kept, lost=())
    assert refined([perfect], pytest.fail, trials=TRIALS, budget=100, rng=np.random.default_rng(0)) == [perfect]
