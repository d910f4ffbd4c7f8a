"""stable-baselines3's contract for every environment, action mode and observation mode (needs the extra `learn`)."""

import gymnasium
import pytest
from stable_baselines3.common.env_checker import check_env

import envs
from envs.reach import ReachEnv

ACTIONS = [(mode, wrist) for mode in ("pressure", "angle", "valve") for wrist in (True, False)]


@pytest.mark.parametrize("env_id", [envs.GRASP_ENV_ID, envs.REORIENT_ENV_ID])
@pytest.mark.parametrize("observation_mode", ["hardware", "state", "goal"])
@pytest.mark.parametrize(("action_mode", "wrist"), ACTIONS)
def test_the_checker_finds_nothing(env_id, action_mode, wrist, observation_mode):
    # warnings are errors here (pyproject.toml)
    env = gymnasium.make(env_id, action_mode=action_mode, wrist=wrist, observation_mode=observation_mode)
    check_env(env.unwrapped, warn=True, skip_render_check=True)


@pytest.mark.parametrize("env_id", [envs.GRASP_ENV_ID, envs.REORIENT_ENV_ID])
def test_the_checker_finds_nothing_with_pictures(env_id):
    env = gymnasium.make(env_id, camera=(48, 64), render_mode="rgb_array")
    check_env(env.unwrapped, warn=True)
    env.close()


@pytest.mark.parametrize("privileged", [True, False])
def test_the_checker_finds_nothing_in_decisions(privileged):
    check_env(ReachEnv(privileged=privileged), warn=True)
