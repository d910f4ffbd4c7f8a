"""Guards in environments: each is provoked and typed, ordinary episodes stay far from all, limits can be changed."""

import itertools

import numpy as np
import pytest

import envs
from envs.guarding import LOOK_S
from envs.script import ScriptedGrasp
from softhand_sim.calibration import JOINTS
from softhand_sim.elements import FINGERS
from softhand_sim.guards.limits import Guards

DOWN = [-1.0, -1.0, -1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0]
# the rolled and pitched fist bends a finger backward on the table
BENT = [1.0, 1.0, 1.0, 0.0, 0.0, -1.0, 0.0, -1.0, 1.0]
CLOSE = [0.9, 0.9, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
FILL = [1, 0, 1, 0, 1, 0]
NONE = Guards(energy_j=None, penetration_m=None, past_stop_rad=None, past_pressure_pa=None)


def negative_damping(model):
    for finger, joint in itertools.product(FINGERS, JOINTS):
        model.dof_damping[model.joint(f"{finger}_{joint}").dofadr] = -2e-5


def far_too_stiff(model):
    model.dof_damping[:] = -1e3


def soft_contacts(model):
    model.geom_solref[:, 0] = 0.2


def unchanged(_model):
    pass


def until_it_ends(env, actions, change=unchanged):
    """Return the info of the step that ended the episode, and the steps; the last info, None without an end."""
    env.reset(seed=0)
    model = env.episode.here.model
    before = {name: np.array(getattr(model, name)) for name in ("dof_damping", "geom_solref")}
    change(model)
    try:
        for k, action in enumerate(actions):
            *_, terminated, truncated, info = env.step(action)
            assert not truncated
            if terminated:
                return info, k + 1
    finally:
        for name, values in before.items():
            getattr(model, name)[...] = values
    return info, None


PROVOKED = {
    "negative damping": ("UNBALANCED", "energy_excess_j", {}, [CLOSE] * 100, negative_damping),
    "springs too stiff for the step": ("DIVERGED", "", {}, [CLOSE] * 10, far_too_stiff),
    "soft contacts": ("PENETRATED", "penetration_m", {}, [DOWN] * 12 + [CLOSE] * 100, soft_contacts),
    "fingers pushed into the table": ("EXTRAPOLATED", "past_stop_rad", {}, [BENT] * 30, unchanged),
    "valves left open": (
        "EXTRAPOLATED", "past_pressure_pa", {"action_mode": "valve", "wrist": False}, [FILL] * 50, unchanged,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PROVOKED)
def test_each_guard_ends_an_episode_with_its_outcome(made, name):
    outcome, quantity, arguments, actions, change = PROVOKED[name]
    info, steps = until_it_ends(made(randomization="none", **arguments), actions, change)
    assert steps is not None
    assert info["outcome"] == outcome
    assert quantity in info["alarm"]
    assert info["diverged"] == (outcome == "DIVERGED")


def test_without_guards_it_goes_on_and_only_tells_what_is_beyond_the_calibration(made):
    arguments = {"randomization": "none", "action_mode": "valve", "wrist": False}
    info, steps = until_it_ends(made(guards=None, **arguments), [FILL] * 50)
    assert steps is None
    assert (info["outcome"], info["alarm"], info["beyond_calibration"]) == ("", "", True)


def test_each_limit_can_be_taken_away(made):
    info, _ = until_it_ends(made(guards=NONE, randomization="none"), [BENT] * 30)
    assert (info["outcome"], info["beyond_calibration"]) == ("", True)
    # divergence has no limit
    info, steps = until_it_ends(made(guards=NONE, randomization="none"), [CLOSE] * 10, far_too_stiff)
    assert steps is not None
    assert info["outcome"] == "DIVERGED"


def test_with_a_goal_an_alarm_is_told_and_ends_nothing(made):
    """An early end would save the -1 of every step to come."""
    info, steps = until_it_ends(made(observation_mode="goal", randomization="none"), [BENT] * 30)
    assert steps is None
    assert info["outcome"] == "EXTRAPOLATED"


@pytest.mark.parametrize("period_s", [0.02, LOOK_S, 0.08])
def test_the_scripted_grasp_stays_far_from_all(made, period_s):
    """The wrist starts and stops; periods longer than a look are looked into."""
    tight = Guards(energy_j=1e-3, penetration_m=1e-3, past_stop_rad=0.05, past_pressure_pa=1e3)
    env = made(guards=tight, control_period_s=period_s, objects="lemon")
    env.reset(seed=0)
    script = ScriptedGrasp(env.episode)
    for _ in range(round(8.0 / period_s)):
        *_, terminated, _, info = env.step(script.act())
        assert (terminated, info["alarm"]) == (False, "")
    assert info["object_height_m"] > 0.1


def test_a_saved_episode_goes_on_with_its_energy_book_and_alarm(made):
    env = made(guards=Guards(energy_j=8e-3), randomization="none")
    actions = np.random.default_rng(4).uniform(-1.0, 1.0, (70, 9))
    env.reset(seed=0)
    states, told, books = [], [], []
    for action in actions:
        states.append(env.save())
        told.append(env.step(action)[4]["alarm"])
        books.append(env.episode.guarding.book()["scalars"])
    first = next(k for k, text in enumerate(told) if text)
    held = [k for k in range(1, first) if books[k - 1][0] > 0.0 and books[k][0] > books[k - 1][0]]
    assert held
    for k in (held[-1], first, first + 1):
        env.load(states[k])
        assert env.step(actions[k])[4]["alarm"] == told[k]
        assert np.array_equal(env.episode.guarding.book()["scalars"], books[k])


def test_the_energy_limit_follows_the_wrists_speed():
    limit = [envs.SoftHandGraspEnv(**given).episode.spec.guards.energy_j for given in (
        {"wrist": False}, {}, {"wrist_speed_m_per_s": 0.05}, {"wrist_speed_m_per_s": 0.5},
    )]  # fmt: skip
    assert limit == pytest.approx([0.010, 0.100, 0.100, 2.5])


def test_unknown_guards_are_refused():
    with pytest.raises(ValueError, match="guards = 'some': must be one of default"):
        envs.SoftHandGraspEnv(guards="some")
