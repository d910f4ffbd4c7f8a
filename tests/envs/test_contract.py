"""Gymnasium's contract for every environment and mode, refusals by name, and rollouts that repeat."""

import hashlib
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.utils.passive_env_checker import env_render_passive_checker
from rollouts import rollout

import envs
from envs.config import DEFAULT_ENGINE
from envs.errors import BadActionError, BadOptionError
from envs.script import ScriptedGrasp
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.render import RenderUnavailableError

ACTIONS = [(mode, wrist) for mode in ("pressure", "angle", "valve") for wrist in (True, False)]


def test_every_registered_environment_is_checked():
    ours = {spec.id for spec in gymnasium.registry.values() if str(spec.entry_point).startswith("envs.")}
    assert ours == {envs.GRASP_ENV_ID, envs.REORIENT_ENV_ID}


@pytest.mark.parametrize("env_id", [envs.GRASP_ENV_ID, envs.REORIENT_ENV_ID])
@pytest.mark.parametrize("observation_mode", ["hardware", "state", "goal"])
@pytest.mark.parametrize(("action_mode", "wrist"), ACTIONS)
def test_gymnasiums_checker_finds_nothing(made, env_id, action_mode, wrist, observation_mode):
    # pictures are checked below: a window needs a screen
    env = made(env_id, action_mode=action_mode, wrist=wrist, observation_mode=observation_mode)
    check_env(env, skip_render_check=True)


def drawn_or_told(**arguments):
    """Return the first observation and a picture, or the error of a machine that cannot draw."""
    env = gymnasium.make(envs.GRASP_ENV_ID, **arguments)
    try:
        seen = env.reset(seed=0)[0]
        if env.render_mode is not None:
            env_render_passive_checker(env.unwrapped)
        return seen, env.render() if env.render_mode is not None else None
    except RenderUnavailableError as error:
        return str(error)
    finally:
        env.close()


def test_pictures_show_the_scene_and_depth_is_in_metres():
    told = [drawn_or_told(render_mode=mode) for mode in ("rgb_array", "depth_array")]
    told.append(drawn_or_told(camera=(48, 64)))
    if isinstance(told[0], str):
        assert all("libegl1" in error for error in told)
        return
    (_, picture), (_, depth), (seen, _) = told
    assert picture.shape == (480, 640, 3)
    assert picture.std() > 10.0
    assert depth.shape == (480, 640)
    # camera `front` stands 0.64 m from the object, and the hand is a little nearer
    assert 0.4 < depth.min() < 0.64
    assert seen["camera"].shape == (48, 64, 3)
    assert seen["camera"].std() > 5.0


def test_a_window_without_a_screen_is_refused_with_what_to_do(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert "rgb_array" in drawn_or_told(render_mode="human")


SCRIPT = """
import hashlib, sys
import gymnasium, envs
sys.path.insert(0, sys.argv[1])
from rollouts import rollout
env = gymnasium.make(envs.GRASP_ENV_ID, randomization="domain").unwrapped
print(hashlib.sha256(rollout(env, 5, 25).tobytes()).hexdigest())
"""


def test_a_seed_gives_the_same_rollout_in_another_process(made):
    env = made(randomization="domain")
    mine = rollout(env, 5, 25)
    assert np.array_equal(mine, rollout(env, 5, 25))
    assert not np.array_equal(mine, rollout(env, 6, 25))
    command = [sys.executable, "-c", SCRIPT, str(Path(__file__).parent)]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert told.strip() == hashlib.sha256(mine.tobytes()).hexdigest()


@pytest.mark.parametrize(
    ("mode", "action", "message"),
    [
        ("pressure", np.zeros(3), r"shape \(3,\) must be \(9,\)"),
        ("pressure", np.full(9, np.nan), r"action\[0\]: nan"),
        ("pressure", np.array([0, 0, 0, 0, 1.5, 0, 0, 0, 0]), r"action\[4\]: 1.5 must be a number in \[-1, 1\]"),
        ("pressure", "close", "'close' must be 9 numbers"),
        ("valve", np.full(12, -1.01), r"action\[0\]: -1.01"),
    ],
)
def test_bad_actions_are_named_and_change_nothing(made, mode, action, message):
    env = made(action_mode=mode)
    still = np.zeros(env.action_space.shape)
    env.reset(seed=0)
    with pytest.raises(BadActionError, match=message):
        env.step(action)
    after_refusal = env.step(still)[0]
    env.reset(seed=0)
    assert np.array_equal(after_refusal, env.step(still)[0])


def test_half_open_valves_are_refused(made):
    env = made(action_mode="valve", wrist=False)
    env.reset(seed=0)
    with pytest.raises(BadActionError, match=r"action\[2\]: 0.5 must be 0 or 1"):
        env.step([0, 1, 0.5, 0, 0, 0])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"colour": "red"}, "'colour'"),
        ({"object_yaw_rad": float("nan")}, "object_yaw_rad = nan"),
        ({"object_offset_m": 3}, "object_offset_m = 3: must be two numbers"),
        ({"object": "pear"}, r"object = 'pear': must be one of \['apple'\]"),
        ({"calibration": 1}, r"calibration = 1: must be one of \[0\]"),
        ({"mass_kg": -0.1}, "mass_kg = -0.1"),
        ({"leak": {"finger": "toe", "sonic_conductance_m3_per_s_pa": 1e-11}}, "toe"),
        ({"goal_position_m": (0.0, 2.0, 0.0)}, "goal_position_m"),
    ],
)
def test_bad_options_are_named_and_the_next_reset_works(made, options, message):
    env = made()
    with pytest.raises(BadOptionError, match=message):
        env.reset(seed=0, options=options)
    assert env.observation_space.contains(env.reset(seed=0)[0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"objects": "human_being"}, "human_being"),
        ({"objects": ["apple", "apple"]}, "different names"),
        ({"action_mode": "torque"}, "action_mode = 'torque': must be one of pressure, angle, valve"),
        ({"observation_mode": "all"}, "observation_mode"),
        ({"randomization": "much"}, "randomization = 'much'"),
        ({"effects": "some"}, "effects = 'some'"),
        ({"effects": "ideal", "action_mode": "valve"}, "need gas dynamics"),
        ({"control_period_s": 0.05}, "multiple of the controller's period"),
        ({"wrist_speed_m_per_s": 3.0}, "wrist_speed_m_per_s = 3.0"),
        ({"camera": (0, 10)}, "camera"),
        ({"render_mode": "ascii"}, "render_mode"),
    ],
)
def test_bad_arguments_are_named_before_anything_is_built(arguments, message):
    with pytest.raises(ValueError, match=message):
        envs.SoftHandGraspEnv(**arguments)


def test_unknown_arguments_are_named():
    with pytest.raises(TypeError, match="speed"):
        envs.SoftHandGraspEnv(speed=1.0)


def test_a_step_before_the_first_reset_is_refused():
    with pytest.raises(RuntimeError, match="call reset first"):
        envs.SoftHandGraspEnv().step(np.zeros(9))


def test_infos_of_a_step_are_plain_values(made):
    env = made()
    env.reset(seed=0)
    info = env.step(np.zeros(9))[4]
    assert json.loads(json.dumps(info)) == info
    assert info["engine_warnings"] == {}


@pytest.mark.parametrize("engine", [None, EngineSettings()])
def test_the_engine_is_the_environments_own_or_the_one_that_was_given(made, engine):
    env = made() if engine is None else made(engine=engine)
    env.reset(seed=0)
    option, wanted = env.episode.here.model.opt, engine or DEFAULT_ENGINE
    assert (option.timestep, option.noslip_iterations) == (wanted.timestep_s, wanted.noslip_iterations)
    assert (
        option.jacobian
        == {"dense": mujoco.mjtJacobian.mjJAC_DENSE, "sparse": mujoco.mjtJacobian.mjJAC_SPARSE}[wanted.jacobian]
    )
    assert bool(option.disableflags & mujoco.mjtDisableBit.mjDSBL_ISLAND) != wanted.islands
    assert option.tolerance == wanted.tolerance
    assert env.episode.substeps * wanted.timestep_s == pytest.approx(0.04)


def test_how_the_solver_stores_its_matrices_changes_no_action(made):
    """Over an action from the same state, all along a grasp; over seconds valves redraw what the last bits are."""
    env = made()
    plain = made(engine=replace(DEFAULT_ENGINE, jacobian="dense", islands=True, tolerance=1e-8))
    env.reset(seed=0)
    plain.reset(seed=0)
    script, off, touching = ScriptedGrasp(env.episode), [], 0
    for k in range(100):
        action, state = script.act(), env.save() if k % 5 == 0 else None
        seen = env.step(action)[0]
        if state is not None:
            plain.load(state)
            off.append(np.abs(plain.step(action)[0] - seen))
            touching += env.episode.here.touching() > 0
    where = env.episode.spec.layout.where
    assert touching > 5
    assert np.max(off, axis=0)[where["joint_angle_rad"]].max() < 1e-4
    assert np.max(off, axis=0)[where["object_position_in_palm_m"]].max() < 1e-5


@pytest.mark.parametrize("mode", ["hardware", "state", "goal"])
@pytest.mark.parametrize("env_id", [envs.GRASP_ENV_ID, envs.REORIENT_ENV_ID])
def test_compiled_observations_are_the_plain_ones(made, env_id, mode):
    env = made(env_id, observation_mode=mode)
    rng = np.random.default_rng(0)
    env.reset(seed=0)
    for _ in range(5):
        env.step(rng.uniform(-1.0, 1.0, env.action_space.shape))
        episode = env.episode
        plain = episode.observer.see_plainly(episode.here, episode.commanded())
        assert episode.observe() == pytest.approx(plain, rel=0.0, abs=1e-12)
