"""Saved and restored in mid-episode: goes on bit for bit."""

import pickle

import numpy as np
import pytest
from rollouts import go_on, rollout

import envs
from envs.errors import BadStateError

LEAK = {"finger": "ring", "sonic_conductance_m3_per_s_pa": 1e-11}


@pytest.mark.parametrize("effects", ["ideal", "bench", "full"])
def test_a_restored_state_goes_on_bit_for_bit(made, effects):
    """With contact, moving valves and a leak; also after other episodes, in a new environment, and pickled."""
    env = made(effects=effects, randomization="none" if effects == "ideal" else "domain")
    options = {"mass_kg": 0.1} if effects == "ideal" else {"mass_kg": 0.1, "leak": LEAK, "valve_flow_ratio": 1.3}
    env.reset(seed=4, options=options)
    for k in range(60):
        env.step([-1.0 if k < 13 else 0.9] * 3 + [0.0, 0.0, -1.0 if k < 13 else 0.0, 0.0, 0.0, 0.0])
    assert env.episode.here.touching()
    state = env.save()
    draws = env.np_random.bit_generator.state
    env.action_space.seed(1)
    first = go_on(env, 25)

    def again(other):
        other.load(state)
        assert other.np_random.bit_generator.state == draws
        other.action_space.seed(1)
        return go_on(other, 25)

    assert np.array_equal(first, again(env))
    rollout(env, 9, 10)
    assert np.array_equal(first, again(env))
    state = pickle.loads(pickle.dumps(state))  # as between processes
    fresh = envs.SoftHandGraspEnv(effects=effects, randomization="none" if effects == "ideal" else "domain")
    assert np.array_equal(first, again(fresh))


def test_a_state_knows_what_it_belongs_to(made):
    env = made()
    env.reset(seed=0)
    other = made(objects=("apple", "lemon"), randomization="domain")
    with pytest.raises(BadStateError, match="lemon"):
        other.load(env.save())


def test_the_next_episode_after_a_restored_state_is_the_same_too(made):
    env = made(randomization="domain")
    env.reset(seed=8)
    state = env.save()
    following = env.reset()[0]
    env.load(state)
    assert np.array_equal(env.reset()[0], following)
