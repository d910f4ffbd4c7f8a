"""Vector environments: the same as so many single ones, autoreset as Gymnasium defines it, refusals by name."""

import dataclasses

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import envs
from assets import asset_path
from envs.config import EnvConfig
from envs.draw import Draw
from envs.errors import BadActionError, BadOptionError
from envs.infos import columns
from envs.randomization import DOMAIN
from envs.world import WorldPool
from softhand_sim.render import RenderUnavailableError

WORLDS, STEPS = 3, 30
LEAKY = dataclasses.replace(DOMAIN, leak_probability=0.5)
SOFTER = asset_path("calibration/ensemble/actuator-wall-minus.json")
GAS = {
    "leak": {"finger": "index", "sonic_conductance_m3_per_s_pa": 2e-11},
    "valve_flow_ratio": 0.7,
    "sensor_offset_pa": 2000.0,
}


def both(env_id, **arguments):
    """Return a vector environment on the engine's threads and one made of single environments."""
    mode = arguments.pop("autoreset_mode", AutoresetMode.NEXT_STEP)
    common = {"num_envs": WORLDS, "max_episode_steps": STEPS, **arguments}
    ours = gymnasium.make_vec(env_id, threads=2, autoreset_mode=mode, **common)
    single = {"vectorization_mode": "sync", "vector_kwargs": {"autoreset_mode": mode}}
    return ours, gymnasium.make_vec(env_id, **single, **common)


def assert_same(one, other):
    """Compare observations, rewards, flags and infos, bit for bit."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            assert_same(one[key], other[key])
    elif isinstance(one, np.ndarray) and one.dtype == object:
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    else:
        assert np.array_equal(np.asarray(one), np.asarray(other))


def closing(space, rng):
    """Return actions (n, a) that close the hand around what lies there, each world's a little different."""
    actions = rng.uniform(-0.2, 0.2, space.shape)
    actions[:, :3] += 0.7
    return actions.astype(np.float32)


@pytest.mark.parametrize(
    ("env_id", "arguments"),
    [
        (envs.GRASP_ENV_ID, {"randomization": LEAKY, "objects": ["apple", "lemon"], "calibrations": [None, SOFTER]}),
        (envs.GRASP_ENV_ID, {"effects": "full", "observation_mode": "hardware", "action_mode": "angle"}),
        (envs.REORIENT_ENV_ID, {"observation_mode": "goal"}),
        (envs.REORIENT_ENV_ID, {"autoreset_mode": AutoresetMode.SAME_STEP}),
        (envs.REORIENT_ENV_ID, {"effects": "ideal", "wrist": True}),
        (envs.REORIENT_ENV_ID, {"options": GAS, "effects": "full"}),
    ],
)
def test_results_are_those_of_single_environments_bit_for_bit(env_id, arguments):
    """Over resets: episodes end by truncation after 30 steps."""
    options = arguments.pop("options", None)
    ours, singles = both(env_id, **arguments)
    assert ours.observation_space == singles.observation_space
    assert ours.action_space == singles.action_space
    begun = [vector.reset(seed=5, options=options) for vector in (ours, singles)]
    for one, other in zip(*begun, strict=True):
        assert_same(one, other)
    rng = np.random.default_rng(0)
    truncations = 0
    for _ in range(2 * STEPS + 10):
        actions = closing(ours.action_space, rng)
        one, other = ours.step(actions), singles.step(actions)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
        truncations += one[3].sum()
    assert truncations == 2 * WORLDS
    ours.close()
    singles.close()


def test_worlds_draw_their_own():
    vector = envs.SoftHandGraspVectorEnv(
        num_envs=WORLDS, objects=["apple", "lemon"], calibrations=[None, SOFTER], randomization=LEAKY, threads=1
    )
    seen = []
    for seed in range(0, 40, 10):
        seen.append(vector.reset(seed=seed)[1])
        here = [episode.here for episode in vector.episodes]
        assert len({id(world) for world in here}) == WORLDS
        for episode, world in zip(vector.episodes, here, strict=True):
            draw = episode.draw
            assert world.index == (draw.object, draw.calibration)
            assert world.simulation.pneumatics.leaks == (() if draw.leak is None else (draw.leak,))
    for name in ("object", "calibration", "leak", "valve_flow_ratio"):
        assert any(len(set(infos[name].tolist())) > 1 for infos in seen)
    vector.close()


def test_a_world_that_is_left_serves_the_next_that_wants_it(monkeypatch):
    monkeypatch.setattr("envs.world.MOST_SCENES", 1)
    pool = WorldPool(EnvConfig(objects=["apple", "lemon"]).scenes())
    apple, lemon = Draw(object=0), Draw(object=1)
    first = pool.exchange(None, apple)
    other = pool.exchange(None, apple)
    assert other is not first
    assert pool.exchange(first, apple) is first
    second = pool.exchange(first, lemon)
    assert second.object.name == "lemon"
    assert pool.exchange(other, apple) is other
    assert pool.exchange(second, apple) is first
    # the latest idle one alone is kept: the lemon, then the apple
    assert pool.exchange(first, lemon) is second
    assert pool.exchange(other, lemon) is not second


def pictures_or_told(vector, seed):
    """Return the cameras' first pictures, or the error of a machine that cannot draw."""
    try:
        return vector.reset(seed=seed)[0]["camera"]
    except RenderUnavailableError as error:
        return str(error)


def test_each_world_has_its_own_picture(made):
    given = {"objects": ("apple", "lemon"), "camera": (24, 32)}
    vector = envs.SoftHandGraspVectorEnv(num_envs=2, **given)
    pictures = pictures_or_told(vector, 3)
    vector.close()
    if isinstance(pictures, str):
        assert "libegl1" in pictures
        return
    assert pictures.shape == (2, 24, 32, 3)
    assert np.array_equal(pictures[1], made(**given).reset(seed=4)[0]["camera"])
    assert pictures[0].std() > 5.0
    assert not np.array_equal(pictures[0], pictures[1])


def test_the_number_of_threads_changes_nothing():
    rows = []
    for threads in (1, 2):
        vector = envs.SoftHandReorientVectorEnv(num_envs=WORLDS, threads=threads)
        vector.reset(seed=1)
        rows.append([vector.step(np.full((WORLDS, 3), 0.5))[0] for _ in range(15)])
    assert np.array_equal(*rows)


def test_bare_valves_work_in_a_batch():
    ours, singles = both(envs.GRASP_ENV_ID, action_mode="valve", wrist=False)
    ours.reset(seed=0)
    singles.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(10):
        actions = rng.integers(0, 2, (WORLDS, 6), dtype=np.int8)
        assert_same(ours.step(actions)[0], singles.step(actions)[0])


def test_a_lost_world_ends_alone_and_starts_anew():
    vector = envs.SoftHandReorientVectorEnv(num_envs=WORLDS)
    vector.reset(seed=0)
    still = np.full((WORLDS, 3), -1.0)
    untouched = envs.SoftHandReorientVectorEnv(num_envs=WORLDS)
    untouched.reset(seed=0)
    vector.episodes[1].here.simulation.data.qpos[:9] = np.nan
    seen, _, terminated, _, infos = vector.step(still)
    expected = untouched.step(still)[0]
    assert terminated.tolist() == [False, True, False]
    assert infos["diverged"].tolist() == [False, True, False]
    assert vector.observation_space.contains(seen)
    assert np.array_equal(seen[[0, 2]], expected[[0, 2]])
    seen, rewards, terminated, _, infos = vector.step(still)
    assert rewards[1] == 0.0
    assert not terminated.any()
    assert infos["object"][1] == "foam_bar"
    for _ in range(5):
        seen, _, terminated, *_ = vector.step(still)
    assert not terminated.any()
    assert vector.observation_space.contains(seen)


def test_a_caller_may_reset_some():
    vector = envs.SoftHandReorientVectorEnv(num_envs=2, max_episode_steps=3, autoreset_mode="Disabled")
    vector.reset(seed=0)
    for _ in range(3):
        *_, truncated, _ = vector.step(np.zeros((2, 3)))
    assert truncated.all()
    with pytest.raises(RuntimeError, match=r"\[0, 1\] are over"):
        vector.step(np.zeros((2, 3)))
    seen, _ = vector.reset(options={"reset_mask": np.array([True, False])})
    assert seen[0, 64] == pytest.approx(0.0, abs=1e-3)
    with pytest.raises(RuntimeError, match=r"\[1\] are over"):
        vector.step(np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"objects": ["apple", "apple"]}, "different names"),
        ({"num_envs": 0}, "num_envs = 0"),
        ({"max_episode_steps": 0}, "max_episode_steps = 0"),
        ({"threads": -1}, "threads = -1"),
        ({"autoreset_mode": "never"}, "never"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        envs.SoftHandGraspVectorEnv(**({"num_envs": 2} | arguments))


def test_bad_actions_options_and_seeds_are_named():
    vector = envs.SoftHandReorientVectorEnv(num_envs=2)
    with pytest.raises(RuntimeError, match="call reset first"):
        vector.step(np.zeros((2, 3)))
    with pytest.raises(BadOptionError, match="colour"):
        vector.reset(options={"colour": "red"})
    with pytest.raises(BadOptionError, match="valve_flow_ratio"):
        vector.reset(options={"valve_flow_ratio": 0.0})
    with pytest.raises(ValueError, match="3 given, must be one or 2"):
        vector.reset(seed=[1, 2, 3])
    with pytest.raises(ValueError, match="reset_mask"):
        vector.reset(options={"reset_mask": np.array([False, False])})
    vector.reset(seed=0)
    before = vector.step(np.zeros((2, 3)))[0]
    vector.reset(seed=0)
    with pytest.raises(BadActionError, match=r"action\[2\]: nan"):
        vector.step(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, np.nan]]))
    assert np.array_equal(vector.step(np.zeros((2, 3)))[0], before)


def test_infos_in_columns_are_gymnasiums_own():
    """The same keys, values, types and masks, whatever of the infos differs."""
    add = SyncVectorEnv([lambda: gymnasium.make(envs.REORIENT_ENV_ID)] * 4)._add_info
    plain = {"solved": True, "outcome": "", "steps": 3, "height_m": 0.1, "warnings": {}, "place": np.zeros(3)}
    for told in (
        {},
        {k: {**plain, "height_m": 0.1 * k, "outcome": "LOST" * (k == 2)} for k in range(4)},
        {1: plain, 3: {**plain, "solved": False}},
        {0: plain, 2: {**plain, "warnings": {"BADQACC": 2}}},
        {0: plain, 1: {"final_obs": np.ones(2), "final_info": plain}},
    ):
        expected = {}
        for k, info in told.items():
            expected = add(expected, info, k)
        assert_same_infos(columns(told, 4, add), expected)


def assert_same_infos(found, expected):
    assert found.keys() == expected.keys()
    for key, value in expected.items():
        if isinstance(value, dict):
            assert_same_infos(found[key], value)
        elif value.dtype == object:
            assert [str(v) for v in found[key]] == [str(v) for v in value]
        else:
            assert (found[key].dtype, found[key].tolist()) == (value.dtype, value.tolist())
