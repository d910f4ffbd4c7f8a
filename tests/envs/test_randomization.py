"""Draws: in their ranges, fixed by options one at a time, and felt by the world."""

import dataclasses
import json

import numpy as np
import pytest
import trimesh

import envs
from envs.config import EnvConfig
from envs.draw import Drawer
from envs.randomization import DOMAIN, NONE, Randomization
from softhand_sim.calibration.pad import load_pad_evidence
from softhand_sim.effects import BENCH
from softhand_sim.objects.loader import load_mesh_object
from softhand_sim.pads import SoftPads
from softhand_sim.uncertainty.ensemble import load_ensemble

LEAK = {"finger": "index", "sonic_conductance_m3_per_s_pa": 2e-11}


def test_draws_fill_their_ranges_and_no_more():
    drawer = Drawer(ranges=DOMAIN, objects=3, calibrations=2)
    draws = [drawer.draw(np.random.default_rng(seed)) for seed in range(400)]
    for values, low, high in (
        ([d.object_offset_m[0] for d in draws], -0.01, 0.01),
        ([d.object_yaw_rad for d in draws], -DOMAIN.yaw_rad, DOMAIN.yaw_rad),
        ([d.mass_ratio for d in draws], 0.8, 1.25),
        ([d.friction for d in draws], 0.5, 1.0),
        ([np.log(d.valve_flow_ratio) for d in draws], np.log(0.5), np.log(2.0)),
        ([d.sensor_offset_pa for d in draws], -3450.0, 3450.0),
    ):
        assert min(values) >= low - 1e-12
        assert max(values) <= high + 1e-12
        # even: mean and spread of 400 draws within four standard errors
        width = high - low
        assert np.mean(values) == pytest.approx(0.5 * (low + high), abs=4.0 * width / np.sqrt(12 * 400))
        assert np.std(values) == pytest.approx(width / np.sqrt(12.0), rel=0.1)
    assert {d.object for d in draws} == {0, 1, 2}
    assert {d.calibration for d in draws} == {0, 1}
    assert 0.04 < np.mean([d.leak is not None for d in draws]) < 0.16


def test_a_range_that_is_shut_leaves_the_other_draws_alone():
    open_, shut = DOMAIN, dataclasses.replace(DOMAIN, mass_ratio=(1.0, 1.0), leak_probability=0.0)
    a, b = (Drawer(ranges=r, objects=3, calibrations=2).draw(np.random.default_rng(1)) for r in (open_, shut))
    assert dataclasses.replace(a, mass_ratio=1.0, leak=None) == b


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("mass_ratio", (2.0, 1.0)),
        ("friction", (-0.1, 1.0)),
        ("leak_probability", 1.5),
        ("valve_flow_ratio", (0.0, 1.0)),
        ("position_m", float("nan")),
        ("mass_ratio", (1.0,)),
    ],
)
def test_bad_ranges_are_named(name, value):
    with pytest.raises(ValueError, match=name):
        Randomization(**{name: value})


def test_each_option_fixes_its_quantity_and_leaves_the_rest(made):
    env = made(objects=("apple", "lemon"), randomization="domain")
    drawn = env.reset(seed=11)[1]
    values = {
        "object": "lemon" if drawn["object"] == "apple" else "apple",
        "object_offset_m": (0.02, -0.01),
        "object_yaw_rad": 0.3,
        "mass_kg": 0.2,
        "friction": 0.4,
        "leak": LEAK,
        "valve_flow_ratio": 1.5,
        "sensor_offset_pa": -1000.0,
    }
    for name, value in values.items():
        info = env.reset(seed=11, options={name: value})[1]
        told = "index" if name == "leak" else value
        assert np.array_equal(info[name], told)
        # the other object has a mass of its own
        same = set(values) - {name} - ({"mass_kg"} if name == "object" else set())
        for other in same:
            assert np.array_equal(info[other], drawn[other])


def test_mass_and_friction_reach_the_engine_and_go_back(made):
    env = made(randomization="none")
    model = lambda: env.episode.here.model  # noqa: E731
    env.reset(seed=0)
    body = env.episode.here.body
    own = slice(first := int(model().joint("object_joint").dofadr[0]), first + 6)
    before = {name: np.array(getattr(model(), name)) for name in ("body_inertia", "dof_invweight0", "body_subtreemass")}
    env.reset(seed=0, options={"mass_kg": 0.136, "friction": 0.3})
    assert model().body_mass[body] == 0.136
    # twice the apple's 68 g: twice the inertia, half the inverse inertia seen by constraints
    assert model().body_inertia[body] == pytest.approx(2.0 * before["body_inertia"][body])
    assert model().dof_invweight0[own] == pytest.approx(0.5 * before["dof_invweight0"][own])
    touching = model().geom_bodyid == body
    assert set(model().geom_friction[touching & (model().geom_contype > 0), 0]) == {0.3}
    env.reset(seed=0)
    for name, value in before.items():
        assert np.array_equal(getattr(model(), name), value)


def fill_then_wait(env, options):
    """Return readings and pressures of the index [kPa] after a fill and 1.2 s with all valves shut, (30, 2)."""
    env.reset(seed=2, options=options)
    for _ in range(8):
        env.step([0, 0, 1, 0, 0, 0])
    rows = np.array([env.step([0] * 6)[0][[1, 19]] for _ in range(30)])
    return rows[1:]


@pytest.mark.parametrize(
    ("env_id", "arguments"),
    [(envs.GRASP_ENV_ID, {"objects": "mug", "randomization": "domain"}), (envs.REORIENT_ENV_ID, {})],
)
def test_the_hand_starts_clear_of_a_displaced_object(made, env_id, arguments):
    """Of these starts a third overlap where the hand would stand otherwise; what overlaps is thrown."""
    env = made(env_id, **arguments)
    usual = env.reset(seed=0, options={"object_offset_m": (0.0, 0.0), "object_yaw_rad": 0.0})[0][9:15]
    backed = 0
    for seed in range(20):
        seen = env.reset(seed=seed)[0]
        world = env.episode.here
        assert not world.contacts.of_object(world.simulation.data).size
        backed += not np.array_equal(seen[9:15], usual)
    assert 2 <= backed <= 18


def test_leak_valves_and_sensor_are_felt(made):
    env = made(action_mode="valve", wrist=False, randomization="none")
    whole = fill_then_wait(env, {})
    leaky = fill_then_wait(env, {"leak": LEAK})
    slow = fill_then_wait(env, {"valve_flow_ratio": 0.5})
    off = fill_then_wait(env, {"sensor_offset_pa": 3000.0})
    assert leaky[-1, 1] < 0.6 * leaky[0, 1]
    assert whole[-1, 1] > 0.95 * whole[0, 1]
    # choked flow into a chamber that hardly grows: half the flow, about half the pressure
    assert slow[0, 1] / whole[0, 1] == pytest.approx(0.5, abs=0.1)
    assert off[:, 1] == pytest.approx(whole[:, 1])
    # noise of half a count and steps of one
    assert np.mean(off[:, 0] - whole[:, 0]) == pytest.approx(3.0, abs=0.25)


def test_material_pairs_come_from_the_calibrations_given(made, calibration):
    softer = dataclasses.replace(
        calibration,
        joints=tuple(
            dataclasses.replace(
                j,
                stiffness_n_m_per_rad=0.8 * j.stiffness_n_m_per_rad,
                stiffness_n_m_per_rad2=0.8 * j.stiffness_n_m_per_rad2,
                stiffness_n_m_per_rad3=0.8 * j.stiffness_n_m_per_rad3,
            )
            for j in calibration.joints
        ),
    )
    env = made(calibrations=(calibration, softer), randomization=NONE, effects=BENCH)
    tips = []
    for pair in (0, 1):
        env.reset(seed=0, options={"calibration": pair})
        for _ in range(60):
            env.step([-1, 0.5, -1, 0, 0, 1, 0, 0, 0])
        tips.append(np.degrees(env.episode.here.simulation.tip_angles_rad()[1]))
    assert tips[1] > tips[0] + 5.0


def test_a_mesh_of_the_users_own_is_an_object_like_any_other(tmp_path):

    path = tmp_path / "brick.stl"
    trimesh.creation.box((0.05, 0.06, 0.04)).export(path)
    brick = load_mesh_object(path, mass_kg=0.05)
    env = envs.SoftHandGraspEnv(objects=[brick, "lemon"])
    info = env.reset(seed=0, options={"object": "brick"})[1]
    assert info["object"] == "brick"
    assert info["mass_kg"] == pytest.approx(0.05)
    env.step(np.zeros(9))


def test_the_shipped_ensemble_is_a_list_of_calibrations():

    env = envs.SoftHandReorientEnv(calibrations="ensemble")
    solved = [member for source in load_ensemble().sources for member in source.solved]
    assert env.episode.spec.drawer.calibrations == 1 + len(solved) >= 4
    assert {env.episode.spec.drawer.draw(np.random.default_rng(k)).calibration for k in range(200)} == set(
        range(1 + len(solved))
    )


def test_soft_pads_get_the_drawn_friction():
    pads = SoftPads.of(load_pad_evidence())
    env = envs.SoftHandReorientEnv(effects=dataclasses.replace(BENCH, pads=pads))
    env.reset(seed=0, options={"friction": 0.35})
    model = env.episode.here.model
    assert model.npair == 30
    assert set(model.pair_friction[:, 0]) == set(model.pair_friction[:, 1]) == {0.35}
    env.step(np.zeros(3))


def test_ranges_come_from_fields_by_name():
    ranges = Randomization(position_m=0.03, friction=(0.5, 1.0))
    as_json = json.loads(json.dumps(dataclasses.asdict(ranges)))
    assert Randomization.from_fields(as_json) == ranges
    assert EnvConfig(randomization={"position_m": 0.03}).ranges.position_m == 0.03
    with pytest.raises(ValueError, match="postion_m"):
        EnvConfig(randomization={"postion_m": 0.03})
