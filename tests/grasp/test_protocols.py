"""Protocols as files, and the physics of their phases."""

import dataclasses

import numpy as np
import pytest

from assets import asset_path
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.phases.mark import Mark
from softhand_sim.grasp.phases.push import Push
from softhand_sim.grasp.phases.shake import Shake
from softhand_sim.grasp.phases.turn import Turn
from softhand_sim.grasp.protocol import Offsets
from softhand_sim.grasp.protocol_file import load_protocol, protocol_names
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome, Thresholds
from softhand_sim.objects.catalogue import make_object


def with_phases(*phases, close_s=2.5):
    return dataclasses.replace(load_protocol(), phases=phases, close_s=close_s)


def test_the_four_protocols_are_shipped_and_the_paper_s_is_the_default():
    assert {"paper", "six_forces", "assessment", "shake"} <= set(protocol_names())
    assert load_protocol() == load_protocol("paper")
    assert load_protocol().lift_m == 0.15


def test_six_forces_are_those_of_the_stated_rule():
    protocol = load_protocol("six_forces")
    pushes = [phase for phase in protocol.phases if isinstance(phase, Push)]
    assert sorted((p.x, p.y, p.z) for p in pushes) == sorted(
        tuple(sign * axis) for axis in np.eye(3) for sign in (1.0, -1.0)
    )
    assert all(p.acceleration_m_per_s2 == 10.0 and p.duration_s == 2.0 and not p.weightless for p in pushes)
    assert protocol.thresholds.slip_m == 0.05
    assert protocol.thresholds.tilt_rad == pytest.approx(np.radians(15.0))
    assert protocol.thresholds.at_any_time
    other = load_protocol("six_forces_weightless")
    assert (other.mass_kg, other.friction) == (0.1, 0.6)
    assert all(p.weightless for p in other.phases if isinstance(p, Push))


def test_a_protocol_of_one_s_own_is_one_file(tmp_path):
    path = tmp_path / "twice.toml"
    text = asset_path("protocols", "paper.toml").read_text(encoding="utf-8")
    path.write_text(text + '\n[[phase]]\ndo = "lift"\nheight_m = 0.05\n', encoding="utf-8")
    protocol = load_protocol(path)
    assert protocol.name == "twice"
    assert protocol.lift_m == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('do = "lift"', 'do = "juggle"', r"phase 1: do is 'juggle', allowed .*hold.*lift"),
        ("height_m = 0.15", "height_m = -1", r"phase 1 \(lift\): height_m"),
        ("height_m = 0.15", "depth_m = 1", r"phase 1 \(lift\): unknown keys \['depth_m'\]"),
        ("duration_s = 3.0", "duration_s = nan", r"phase 2 \(hold\): duration_s"),
        ("duration_s = 3.0", "needs_object = true", r"phase 2 \(hold\): unknown keys"),
        ("close_s = 2.5", 'close_s = "long"', "close_s is 'long'"),
        ("close_s = 2.5", "", r"missing keys \['close_s'\]"),
        ("position_m = 0.010", "position_m = -0.1", "offsets: position_m"),
        ("slip_m = 0.010", "slip_m = 0", "thresholds: slip_m"),
        ("slip_m = 0.010", "at_any_time = 1", "thresholds: at_any_time"),
        ('do = "lift"\nheight_m = 0.15', 'do = "hold"\nduration_s = 1', "at least one must be a lift"),
        ("[offsets]", "[offsets", "not a TOML file"),
    ],
)
def test_wrong_protocol_is_refused_by_name(tmp_path, old, new, message):
    text = asset_path("protocols", "paper.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ValueError, match=message) as caught:
        load_protocol(path)
    assert str(path) in str(caught.value)


def test_unknown_name_and_missing_file(tmp_path):
    with pytest.raises(ValueError, match=r"'dance'.*paper"):
        load_protocol("dance")
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml"):
        load_protocol(tmp_path / "nowhere.toml")


def test_stated_offsets_come_one_after_the_other():
    offsets = load_protocol("assessment").offsets
    rng = np.random.default_rng(0)
    drawn = [offsets.draw(rng, seed) for seed in range(6)]
    assert [pair[:2] for pair in drawn] == [*offsets.stated_m, offsets.stated_m[0]]
    assert all(yaw == 0.0 for _, _, yaw in drawn)
    with pytest.raises(ValueError, match="stated_m"):
        Offsets(stated_m=((0.0, 0.5),))


def test_a_push_is_mass_times_acceleration_and_a_weightless_one_lifts_the_weight(calibration):
    """A free object, the hand far above: constant acceleration, x = a t^2 / 2."""
    model = make_object("puzzle_cube").with_overrides(friction=0.0)
    protocol = with_phases(Lift(height_m=0.05), close_s=0.05)
    for weightless in (False, True):
        push = Push(x=3.0, acceleration_m_per_s2=2.0, duration_s=0.4, weightless=weightless, needs_object=False)
        setup = prepare(model, calibration, protocol=dataclasses.replace(protocol, phases=(*protocol.phases, push)))
        plan = dataclasses.replace(setup.plan, wrist_pose=(-0.3, 0.0, 0.4, 0.0, 0.0, 0.0), set_angle_deg=(0.0,) * 3)
        path = []

        def watch(simulation, path=path):
            force = simulation.data.xfrc_applied[simulation.model.body("object").id]
            speed = simulation.data.qvel[simulation.model.joint("object_joint").dofadr[0]]
            path.append((simulation.data.time, force[0], force[2], speed))

        run_trial(dataclasses.replace(setup, plan=plan), 0, watch)
        time, force, up, speed = np.array(path).T
        pushed = force > 0.0
        assert pushed.sum() == pytest.approx(20, abs=1)
        assert force[pushed] == pytest.approx(model.mass_kg * 2.0)
        assert up[pushed] == pytest.approx(model.mass_kg * 9.81 if weightless else 0.0, abs=1e-12)
        rate = np.polyfit(time[pushed], speed[pushed], 1)[0]
        assert rate == pytest.approx(2.0, rel=1e-3)
        assert force[-1] == 0.0


def test_a_shake_has_the_stated_acceleration_and_ends_where_it_began(calibration):
    shake = Shake(y=1.0, acceleration_m_per_s2=5.0, frequency_hz=3.0, swings=6, needs_object=False)
    setup = prepare(
        make_object("golf_ball"), calibration, protocol=with_phases(Lift(height_m=0.05), shake, close_s=0.05)
    )
    path = []

    def watch(simulation):
        path.append((simulation.data.time, *simulation.data.xpos[simulation.index.palm_body]))

    run_trial(setup, 0, watch)
    time, x, y, z = np.array(path).T
    swinging = slice(np.flatnonzero(np.abs(y - y[0]) > 1e-4)[0], None)
    assert np.ptp(x[swinging]) < 1e-4
    assert np.ptp(z[swinging]) < 1e-3
    # 2 A from turn to turn with A = a / w^2, in the middle of the swings
    middle = slice(swinging.start + 17, swinging.start + 84)
    assert np.ptp(y[middle]) == pytest.approx(2.0 * 5.0 / (2.0 * np.pi * 3.0) ** 2, rel=0.03)
    acceleration = np.gradient(np.gradient(y, time), time)[middle]
    assert np.abs(acceleration).max() == pytest.approx(5.0, rel=0.06)
    assert y[-1] == pytest.approx(y[0], abs=2e-4)


def test_a_turn_keeps_a_held_object_and_a_dropped_one_ends_the_trial(calibration):
    protocol = with_phases(Lift(height_m=0.1), Turn(pitch_rad=0.5), Hold(duration_s=0.5))
    held = run_trial(prepare(make_object("mug"), calibration, protocol=protocol), 0)
    assert held.outcome is Outcome.HELD
    assert held.phases_run == 3
    lost = run_trial(prepare(make_object("cracker_box"), calibration, protocol=protocol), 0)
    assert lost.outcome is Outcome.MISSED
    assert lost.phases_run == 1
    assert lost.simulated_s < held.simulated_s


def test_a_protocol_s_mass_and_friction_hold_for_every_object(calibration):
    setup = prepare(make_object("soup_can"), calibration, protocol=load_protocol("six_forces_weightless"))
    assert (setup.model.mass_kg, setup.model.friction) == (0.1, 0.6)
    assert setup.scene.model.body_mass[setup.scene.model.body("object").id] == pytest.approx(0.1)


def test_pushes_harder_than_the_grip_take_the_mug_away(calibration):
    gentle, rough = (
        with_phases(Lift(height_m=0.1), Push(z=-1.0, acceleration_m_per_s2=a, duration_s=0.5)) for a in (1.0, 100.0)
    )
    mug = make_object("mug")
    assert run_trial(prepare(mug, calibration, protocol=gentle), 0).outcome is Outcome.HELD
    lost = run_trial(prepare(mug, calibration, protocol=rough), 0)
    assert lost.outcome is Outcome.DROPPED
    assert lost.contacts == 0


def test_slip_at_any_time_is_not_forgiven_by_coming_back(calibration):
    protocol = with_phases(
        Lift(height_m=0.1), Mark(), Push(y=1.0, acceleration_m_per_s2=4.0, duration_s=0.3), Hold(duration_s=0.5)
    )
    mug = make_object("mug")
    seen = run_trial(prepare(mug, calibration, protocol=protocol), 0)
    assert seen.worst_slip_m > 1.5 * seen.slip_m
    between = Thresholds(slip_m=0.5 * (seen.slip_m + seen.worst_slip_m))
    for at_any_time, outcome in ((False, Outcome.HELD), (True, Outcome.SLIPPED)):
        limits = dataclasses.replace(between, at_any_time=at_any_time)
        same = prepare(mug, calibration, protocol=dataclasses.replace(protocol, thresholds=limits))
        assert run_trial(same, 0).outcome is outcome


@pytest.mark.parametrize(
    ("phase", "values", "message"),
    [
        (Push, {"acceleration_m_per_s2": 1.0, "duration_s": 1.0}, "x, y, z"),
        (Push, {"x": float("nan"), "acceleration_m_per_s2": 1.0, "duration_s": 1.0}, "x, y, z"),
        (Shake, {"x": 1.0, "acceleration_m_per_s2": 5.0, "frequency_hz": 0.5, "swings": 3}, "frequency_hz: 0.5"),
        (Shake, {"x": 1.0, "acceleration_m_per_s2": 5.0, "frequency_hz": 3.0, "swings": 2.5}, "swings"),
        (Turn, {"pitch_rad": 4.0}, "pitch_rad"),
    ],
)
def test_impossible_phases_are_refused(phase, values, message):
    with pytest.raises(ValueError, match=message):
        phase(**values)
