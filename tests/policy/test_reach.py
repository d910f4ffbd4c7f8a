"""Decisions of a policy: all zero is the script, the environment and a trial carry out the same, limits hold."""

import dataclasses
from typing import ClassVar

import numpy as np
import pytest

from envs.reach import APPROACH_M, LiftSpec, ReachEnv
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object
from softhand_sim.policy.network import Network
from softhand_sim.policy.policy_file import Policy
from softhand_sim.policy.reach import ACTIONS, Reach, ReachSpec

SPEC = ReachSpec(decisions=8, approach_decisions=3)


def constant(action, spec=SPEC):
    """Return a policy that always does the same."""
    zero = np.zeros((ACTIONS, spec.features))
    return Policy(network=Network(weights=(zero,), biases=(np.asarray(action, dtype=float),)), spec=spec)


class Spy(Policy):
    """A policy that always does the same and notes what it saw."""

    seen: ClassVar[list] = []

    def act(self, features):
        self.seen.append(features)
        return super().act(features)


@pytest.fixture(scope="module")
def setup(calibration):
    protocol = load_protocol("paper")
    still = dataclasses.replace(protocol.offsets, position_m=0.0, yaw_rad=0.0)
    protocol = dataclasses.replace(protocol, approach_m=APPROACH_M, offsets=still)
    return prepare(make_object("apple"), calibration, protocol=protocol)


def reach_of(setup, spec=SPEC):
    highest = float(setup.calibration.curve.pressure_pa_gauge[-1])
    return Reach(spec=spec, plan=setup.plan, script_pa_gauge=np.full(3, 75e3), highest_pa_gauge=highest)


def test_no_action_is_the_script(setup):
    reach = reach_of(setup)
    steps = [reach.decide(np.zeros(ACTIONS)) for _ in range(SPEC.decisions)]
    assert reach.over
    for target, _ in steps:
        np.testing.assert_allclose(target, setup.plan.wrist_pose, atol=1e-9)
    pressures = np.array([pressure for _, pressure in steps])
    assert (pressures[:3] == 0.0).all()
    assert (pressures[3:] == 75e3).all()


def test_actions_move_in_the_palms_frame_and_add_up_to_a_limit(setup):
    reach = reach_of(setup)
    # the apple's palm stands upright: its z, out of it, points along the approach
    forward = np.eye(ACTIONS)[2]
    places = np.array([reach.decide(forward)[0][:3] for _ in range(4)])
    way = (places - np.array(setup.plan.wrist_pose[:3])) @ -np.array(setup.plan.retreat)
    # two whole steps, the third up to the limit
    np.testing.assert_allclose(way / way[0], np.minimum([1.0, 2.0, 3.0, 3.0], SPEC.reach_m / SPEC.step_m), atol=1e-9)
    assert way[0] > 0.9 * SPEC.step_m
    short = reach_of(setup)
    sideways = np.array([short.decide(np.eye(ACTIONS)[0])[0][:3] for _ in range(1)])
    short.step = SPEC.approach_decisions
    assert np.linalg.norm(short.decide(np.eye(ACTIONS)[0])[0][:3] - sideways) == pytest.approx(
        SPEC.closing_share * SPEC.across_share * SPEC.step_m
    )
    open_, full = (reach_of(setup).decide(share * np.ones(ACTIONS))[1] for share in (-1.0, 5.0))
    assert (open_ == 0.0).all()
    np.testing.assert_allclose(full, SPEC.pressure_share * reach.highest_pa_gauge)


def test_features_tell_place_turn_air_and_time(setup):
    reach = reach_of(setup)
    reach.decide(np.zeros(ACTIONS))
    for opened in ([1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 1]):
        reach.see(np.array([40e3, 0.0, 0.0]), np.array(opened, dtype=float))
    pose = setup.plan.standoff(0.05)
    pose[3] += 0.1
    seen = reach.features(pose)
    assert seen.shape == (SPEC.features,)
    assert seen[0] == pytest.approx(40e3 / reach.highest_pa_gauge)
    np.testing.assert_array_equal(seen[3:9], [1, 0, 0, 0, 0, 0.5])
    assert np.linalg.norm(seen[9:12]) == pytest.approx(0.05 / SPEC.reach_m)
    assert np.linalg.norm(seen[12:15]) == pytest.approx(0.1 / SPEC.turn_rad)
    np.testing.assert_array_equal(seen[19:], np.eye(SPEC.decisions)[1])


def test_a_policy_that_does_nothing_holds_what_the_script_holds(setup):
    by_policy = run_trial(dataclasses.replace(setup, policy=constant(np.zeros(ACTIONS))), 0)
    assert by_policy.outcome is Outcome.HELD
    # a reach that backs off holds nothing
    away = run_trial(dataclasses.replace(setup, policy=constant(-np.eye(ACTIONS)[2])), 0)
    assert away.outcome is Outcome.MISSED


def test_environment_and_trial_carry_out_the_same(setup):
    action = np.array([0.05, -0.05, 0.05, 0.02, 0.02, -0.02, -0.2, 0.1, 0.0])
    trial = {}
    spy = Spy(**vars(constant(action)))

    def watch(simulation):
        if not trial and simulation.data.time >= SPEC.decisions * SPEC.decision_s - 1e-6:
            trial["wrist"] = simulation.wrist_reference.copy()
            trial["set"] = simulation.set_pressure_pa_gauge
            trial["place"] = simulation.data.body("object").xpos.copy()

    run_trial(dataclasses.replace(setup, policy=spy), 0, watch)
    env = ReachEnv(spec=SPEC, lift=LiftSpec(height_m=1e-3, hold_s=0.0), objects="apple", randomization="none")
    seen = [env.reset(seed=0)[0]]
    for _ in range(SPEC.decisions):
        now, _, over, _, _ = env.step(action)
        seen.append(now)
    assert over
    by_trial, by_env = np.array(spy.seen), np.array(seen[:-1])
    # near a set pressure the valves' pulses follow the noise
    np.testing.assert_allclose(by_trial[:, :3], by_env[:, :3], atol=0.05)
    np.testing.assert_allclose(by_trial[:, 3:9].sum(axis=0), by_env[:, 3:9].sum(axis=0), atol=0.5)
    np.testing.assert_allclose(by_trial[:, 9:], by_env[:, 9:], atol=5e-3)
    assert by_trial[:, 3:9].max() > 0.9
    simulation = env.env.episode.here.simulation
    np.testing.assert_allclose(simulation.wrist_reference, trial["wrist"], atol=1e-9)
    np.testing.assert_allclose(simulation.set_pressure_pa_gauge, trial["set"], atol=1e-6)
    # sensors' noise differs
    np.testing.assert_allclose(simulation.data.body("object").xpos, trial["place"], atol=2e-3)


def test_bad_layouts_are_refused_by_name():
    for name, value in (("decisions", 0), ("decision_s", 0.41), ("approach_decisions", 11), ("reach_m", 0.0)):
        with pytest.raises(ValueError, match=name):
            ReachSpec(**{name: value})
