"""The dm_env face: its contract, and the same numbers as underneath."""

import dm_env
import numpy as np
import pytest
from absl.testing import absltest
from dm_env import test_utils

import envs
from envs.dm import DmSoftHand
from envs.errors import BadActionError


class TestContract(test_utils.EnvironmentTestMixin, absltest.TestCase):
    """dm_env's own checks of any environment."""

    def make_object_under_test(self):
        return DmSoftHand(envs.SoftHandReorientEnv(observation_mode="goal"), time_limit_s=0.4, seed=0)


def test_steps_are_those_of_the_environment_underneath(made):
    env = made(action_mode="angle")
    face = DmSoftHand(env, time_limit_s=0.4, seed=3)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (10, 9)).astype(np.float32)
    steps = [face.reset()] + [face.step(a) for a in actions]
    seen, _ = env.reset(seed=3)
    for step, action in zip(steps, [None, *actions], strict=True):
        if action is not None:
            seen, reward, *_ = env.step(action)
            assert step.reward == reward
        for name, part in env.episode.spec.layout.where.items():
            assert np.array_equal(step.observation[name], seen[part])
    assert [s.step_type for s in steps] == [dm_env.StepType.FIRST, *[dm_env.StepType.MID] * 9, dm_env.StepType.LAST]
    assert steps[-1].discount == 1.0
    assert face.step(actions[0]).first()


def test_a_bad_action_is_named(made):
    face = DmSoftHand(made(), seed=0)
    face.reset()
    with pytest.raises(BadActionError, match=r"action\[0\]: nan"):
        face.step(np.full(9, np.nan))
