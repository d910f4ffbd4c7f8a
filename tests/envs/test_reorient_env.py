"""SoftHandReorient-v0: solved by pressing either end of the bar, and by nothing less."""

import math

import numpy as np
import pytest

import envs
from envs.errors import BadOptionError


def press_ends(env, seed, target_rad=None):
    """Let the finger at the end that must come nearer press harder; return the last info.

    The index turns the bar clockwise, middle, ring and little the other way.
    """
    options = {} if target_rad is None else {"target_yaw_rad": target_rad}
    _, info = env.reset(seed=seed, options=options)
    action = np.full(3, -1.0)
    for _ in range(200):
        if abs(info["error_rad"]) > math.radians(2.0):
            nearer, other = (1, 2) if info["error_rad"] < 0.0 else (2, 1)
            action[nearer] += 0.03
            action[other] -= 0.06
        action = np.clip(action, -1.0, 1.0)
        *_, terminated, _, info = env.step(action)
        if terminated or info["is_success"]:
            break
    return info


@pytest.mark.parametrize("target_deg", [-15.0, -8.0, 8.0, 15.0])
def test_pressing_one_end_then_the_other_reaches_the_target(made, target_deg):
    info = press_ends(made(envs.REORIENT_ENV_ID), seed=1, target_rad=math.radians(target_deg))
    assert info["is_success"]
    assert abs(info["error_rad"]) <= math.radians(3.0)


@pytest.mark.parametrize(("pressure", "most"), [(-1.0, 0), (0.5, 1)])
def test_neither_rest_nor_a_grasp_turns_it_both_ways(made, pressure, most):
    """Fingers that close alike turn the bar in passing, but one way only: three of them press beyond its centre."""
    env = made(envs.REORIENT_ENV_ID)
    solved = 0
    for target in (-0.2, 0.2):
        env.reset(seed=1, options={"target_yaw_rad": target})
        infos = [env.step(np.full(3, pressure))[4] for _ in range(150)]
        solved += any(info["is_success"] for info in infos)
    assert solved <= most


def test_targets_are_far_from_the_start_and_within_reach(made):
    env = made(envs.REORIENT_ENV_ID)
    errors, targets = [], []
    for seed in range(60):
        seen, info = env.reset(seed=seed)
        errors.append(info["error_rad"])
        targets.append(seen[-1])
        assert info["error_rad"] == pytest.approx(seen[-1] - info["object_yaw_rad"])
    assert np.abs(errors).min() >= math.radians(6.0) - 1e-9
    assert np.abs(targets).max() <= math.radians(15.0)
    assert 15 < np.sum(np.array(errors) > 0.0) < 45


def test_a_bar_that_tips_over_ends_the_episode(made):
    env = made(envs.REORIENT_ENV_ID)
    env.reset(seed=1)
    world = env.episode.here
    address = world.object_qpos
    world.simulation.data.qpos[address + 3 : address + 7] = (math.cos(0.4), math.sin(0.4), 0.0, 0.0)
    *_, terminated, _, info = env.step(np.full(3, -1.0))
    assert terminated
    assert not info["is_success"]


def test_the_wrist_moves_but_does_not_turn(made):
    env = made(envs.REORIENT_ENV_ID, wrist=True)
    assert env.action_space.shape == (6,)
    start, _ = env.reset(seed=0)
    for _ in range(10):
        seen = env.step([-1, -1, -1, 0, 1, 1])[0]
    moved = seen[9:15] - start[9:15]
    assert moved[1:3] == pytest.approx([0.4 * 0.1 / math.sqrt(2.0)] * 2, abs=3e-3)
    assert np.abs(moved[[0, 3, 4, 5]]).max() < 2e-3


def test_goals_are_turns(made):
    env = made(envs.REORIENT_ENV_ID, observation_mode="goal")
    env.reset(seed=0)
    angle = np.radians([0.0, 2.9, 3.1, 358.0, 180.0])
    achieved = np.column_stack([np.cos(angle), np.sin(angle)])
    desired = np.tile([1.0, 0.0], (5, 1))
    assert env.compute_reward(achieved, desired, {}).tolist() == [0.0, 0.0, -1.0, 0.0, -1.0]


@pytest.mark.parametrize("target", [4.0, float("nan"), "left"])
def test_bad_targets_are_named(made, target):
    with pytest.raises(BadOptionError, match="target_yaw_rad"):
        made(envs.REORIENT_ENV_ID).reset(seed=0, options={"target_yaw_rad": target})
