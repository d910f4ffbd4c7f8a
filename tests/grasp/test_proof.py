"""Full trials have the last word between a searched grasp and the scripted one."""

from dataclasses import replace

import pytest

from softhand_sim.grasp import proof
from softhand_sim.grasp.choice.grasp_file import KeptGrasp, rounded
from softhand_sim.grasp.proof import FIRST_SEED, TRIALS, lost_trials, proven
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.refine import TriedGrasp
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.objects.catalogue import make_object

BALL = make_object("tennis_ball")


@pytest.fixture
def elsewhere():
    """A grasp a decimetre above the ball."""
    plan = rounded(plan_grasp(BALL))
    x, y, z, *turn = plan.wrist_pose
    return KeptGrasp(plan=replace(plan, wrist_pose=(x, y, z + 0.1, *turn)), score=1.2, closings=100)


def test_a_grasp_that_closes_on_air_loses_against_the_scripted_one(monkeypatch, calibration, elsewhere):
    monkeypatch.setattr(proof, "TRIALS", 2)
    result = proven([elsewhere], BALL, calibration, load_protocol())
    assert (result.found_held, result.scripted_held) == (0, 2)
    assert result.kept == KeptGrasp(plan=rounded(plan_grasp(BALL)), closings=100)


@pytest.mark.parametrize(("found", "scripted", "stays"), [(20, 19, True), (18, 18, True), (17, 18, False)])
def test_the_found_grasp_stays_unless_the_scripted_one_holds_more(
    monkeypatch, calibration, elsewhere, found, scripted, stays
):
    counts = {elsewhere.plan: found, rounded(plan_grasp(BALL)): scripted}
    monkeypatch.setattr(proof, "lost_trials", lambda setup, trials: tuple(trials)[counts[setup.plan] :])
    assert (proven([elsewhere], BALL, calibration, load_protocol()).kept is elsewhere) == stays


def test_trials_are_those_of_their_own_seeds(monkeypatch, calibration):
    seen = []
    monkeypatch.setattr(proof, "run_trial", lambda setup, seed: seen.append(seed) or run_trial(setup, 0))
    setup = prepare(BALL, calibration, plan=plan_grasp(BALL))
    assert lost_trials(setup, range(2)) == ()
    assert seen == [FIRST_SEED, FIRST_SEED + 1]
    assert TRIALS >= 10


def test_full_trials_pick_among_several_found_grasps(monkeypatch, calibration, elsewhere):
    """Those that hold most in the heats get all trials; of equals the better score is kept."""
    found = [
        replace(elsewhere, plan=replace(elsewhere.plan, wrist_pose=(0.0, 0.0, 0.2 + 0.01 * k, 0.0, 0.0, 0.0)))
        for k in range(proof.FINALISTS + 2)
    ]
    # how many of the first, and of the later trials each of them holds; the scripted grasp none
    shares = dict(zip((one.plan for one in found), [(1, 14), (4, 9), (5, 9), (4, 10), *[(3, 3)] * 4], strict=True))
    tried = []

    def lost(setup, trials):
        tried.append(len(trials))
        return tuple(trials)[shares.get(setup.plan, (0, 0))[trials.start > 0] :]

    monkeypatch.setattr(proof, "lost_trials", lost)
    result = proven(found, BALL, calibration, load_protocol())
    assert result.kept is found[2]
    assert (result.found_held, result.scripted_held) == (14, 0)
    later = TRIALS - proof.HEATS
    assert sum(tried) == result.trials == len(found) * proof.HEATS + proof.FINALISTS * later + TRIALS


def test_a_refined_grasp_is_kept_only_if_other_trials_agree(monkeypatch, calibration, elsewhere):
    """Held in all of the trials that it was varied in, by luck or not: as many others say which."""
    monkeypatch.setattr(proof, "TRIALS", 4)
    x, y, z, *turn = elsewhere.plan.wrist_pose
    lucky = replace(elsewhere, plan=replace(elsewhere.plan, wrist_pose=(x + 0.01, y, z, *turn)))
    monkeypatch.setattr(proof, "refined", lambda *_, **__: [TriedGrasp(kept=lucky, lost=())])
    for later, kept in ((0, lucky), (4, elsewhere)):
        losses = {elsewhere.plan: 1, lucky.plan: later}
        monkeypatch.setattr(proof, "lost_trials", lambda setup, t: tuple(t)[: losses.get(setup.plan, 4)])  # noqa: B023
        result = proven([elsewhere], BALL, calibration, load_protocol(), refine=8)
        assert result.kept is kept
        assert result.trials == 4 + 4 + 4 + 2 * 4
