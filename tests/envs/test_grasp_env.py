"""SoftHandGrasp-v0: the Gymnasium contract, determinism, refusals, and that its task can be solved."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import envs
from softhand_sim.render import RenderUnavailableError


@pytest.fixture
def env():
    made = gymnasium.make(envs.GRASP_ENV_ID)
    yield made
    made.close()


def has_gl() -> bool:
    probe = gymnasium.make(envs.GRASP_ENV_ID, render_mode="rgb_array")
    probe.reset(seed=0)
    try:
        probe.render()
    except RenderUnavailableError:
        return False
    finally:
        probe.close()
    return True


def test_gymnasium_checker_passes_without_a_warning():
    can_draw = has_gl()
    made = gymnasium.make(envs.GRASP_ENV_ID, render_mode="rgb_array" if can_draw else None)
    check_env(made.unwrapped, skip_render_check=not can_draw)
    if can_draw:
        made.reset(seed=0)
        picture = made.render()
        assert picture.shape == (480, 640, 3)
        assert picture.std() > 10.0
    made.close()


def test_same_seed_same_episode(env):
    def episode(seed):
        env.action_space.seed(1)
        seen = [env.reset(seed=seed)[0]]
        for _ in range(20):
            observation, reward, *_ = env.step(env.action_space.sample())
            seen.append(np.append(observation, reward))
        return np.concatenate(seen)

    assert np.array_equal(episode(7), episode(7))
    assert not np.array_equal(episode(7), episode(8))


def test_the_scripted_grasp_solves_the_task(env):
    """Down 50 mm, close, lift 150 mm, hold: success, and a better return than doing nothing."""
    actions = [(-1.0, -1.0)] * 10 + [(0.875, 0.0)] * 50 + [(0.875, 1.0)] * 30 + [(0.875, 0.0)] * 40

    def total(script):
        env.reset(seed=0)
        reward_sum, successes = 0.0, []
        for pressure, up in script:
            action = np.zeros(9)
            action[:3], action[5] = pressure, up
            _, reward, terminated, _, info = env.step(action)
            assert not terminated
            reward_sum += reward
            successes.append(info["is_success"])
        return reward_sum, successes

    grasp_return, successes = total(actions)
    idle_return, none = total([(-1.0, 0.0)] * len(actions))
    assert successes[-1]
    assert not any(successes[:90])
    assert not any(none)
    assert grasp_return > 2.0 * idle_return


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (np.zeros(3), r"shape \(3,\) must be \(9,\)"),
        (np.full(9, np.nan), r"action\[0\]: nan"),
        (np.array([0, 0, 0, 0, 1.5, 0, 0, 0, 0]), r"action\[4\]: 1.5"),
    ],
)
def test_bad_actions_are_named_and_change_nothing(env, action, message):
    raw = env.unwrapped
    raw.reset(seed=0)
    with pytest.raises(ValueError, match=message):
        raw.step(action)
    after_refusal = raw.step(np.zeros(9))[0]
    raw.reset(seed=0)
    assert np.array_equal(after_refusal, raw.step(np.zeros(9))[0])


def test_bad_options_are_named(env):
    with pytest.raises(ValueError, match="'colour'"):
        env.reset(seed=0, options={"colour": "red"})
    with pytest.raises(ValueError, match="finite"):
        env.reset(seed=0, options={"object_yaw_rad": float("nan")})
    with pytest.raises(ValueError, match="human_being"):
        gymnasium.make(envs.GRASP_ENV_ID, object_name="human_being")


def test_options_fix_the_object(env):
    env.reset(seed=3, options={"object_offset_m": (0.02, -0.01), "object_yaw_rad": 0.0})
    raw = env.unwrapped
    assert raw._simulation.data.body("object").xpos[:2] == pytest.approx([0.02, -0.01])
