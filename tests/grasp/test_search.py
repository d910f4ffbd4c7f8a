"""The search: spends its budget, repeats, gets better with more of it, and finds a grasp that a trial confirms."""

import numpy as np
import pytest

from softhand_sim.grasp.choice import search
from softhand_sim.grasp.choice.closing import LOADS
from softhand_sim.grasp.choice.search import SMALLEST_BUDGET, score, search_grasp, varied
from softhand_sim.grasp.plan import GraspPlan, palm_axes
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

BEST = np.array([0.02, -0.01, 0.10])


class Hill:
    """Instead of closings: the load falls with the distance from one place, and with the displacement."""

    def load_factors(self, plans, offsets, haste):  # noqa: ARG002
        away = np.array([np.linalg.norm(np.array(plan.wrist_pose[:3]) - BEST) for plan in plans])
        drift = np.array([np.hypot(x, y) for x, y, _ in offsets])
        return 0.99 - 10.0 * away[:, None] - 5.0 * drift[None, :]


def found(monkeypatch, calibration, budget, seed=0):
    monkeypatch.setattr(search, "closing_of", lambda *_: Hill())
    return search_grasp(make_object("apple"), calibration, protocol=load_protocol(), budget=budget, seed=seed)


def test_a_larger_budget_gets_nearer_to_the_best_place(monkeypatch, calibration):
    results = [found(monkeypatch, calibration, budget) for budget in (SMALLEST_BUDGET, 400, 4000)]
    scores = [result.grasps[0].score for result in results]
    assert scores == sorted(scores)
    assert np.linalg.norm(np.array(results[-1].grasps[0].plan.wrist_pose[:3]) - BEST) < 0.004
    # the last round takes one grasp at least, each block of candidates all of it
    for result, budget in zip(results, (SMALLEST_BUDGET, 400, 4000), strict=True):
        assert 0.9 * budget < result.closings <= budget + search.BLOCK + search.MANY
        assert [grasp.score for grasp in result.grasps] == sorted((g.score for g in result.grasps), reverse=True)


def test_the_same_seed_gives_the_same_grasps(monkeypatch, calibration):
    first, again, other = (found(monkeypatch, calibration, 200, seed) for seed in (0, 0, 1))
    assert first == again
    assert first.grasps[0] != other.grasps[0]


def test_score_counts_what_is_missing_five_times_as_much_as_margin():
    loads = np.array([[search.ENOUGH, search.ENOUGH], [search.ENOUGH - 0.1, search.ENOUGH + 0.1]])
    even, uneven = score(loads)
    assert even == pytest.approx(1.0)
    assert even - uneven == pytest.approx(0.5 * (0.1 - search.MARGIN_SHARE * 0.1) / search.ENOUGH)
    assert score(np.array([[LOADS[-1]]]))[0] > 1.0


def test_a_variation_stays_near():
    plan = GraspPlan(wrist_pose=(0.0, 0.0, 0.1, 3.1, 0.0, 0.0), retreat=(0.0, 0.0, 1.0))
    for seed in range(20):
        other = varied(plan, np.random.default_rng(seed))
        assert np.linalg.norm(np.subtract(other.wrist_pose[:3], plan.wrist_pose[:3])) < 0.04
        turn = palm_axes(plan.wrist_pose).T @ palm_axes(other.wrist_pose)
        assert np.degrees(np.arccos(0.5 * (np.trace(turn) - 1.0))) < 40.0


def test_a_searched_grasp_holds_in_a_trial(calibration):
    lemon = make_object("lemon")
    result = search_grasp(lemon, calibration, protocol=load_protocol(), budget=SMALLEST_BUDGET)
    assert result.grasps[0].score > 0.9
    assert run_trial(prepare(lemon, calibration, plan=result.grasps[0].plan), seed=0).outcome is Outcome.HELD


def test_a_budget_too_small_is_refused(calibration):
    with pytest.raises(ValueError, match="budget: 10 must be 64 or above"):
        search_grasp(make_object("apple"), calibration, protocol=load_protocol(), budget=10)
