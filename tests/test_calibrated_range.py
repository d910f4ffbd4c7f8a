"""What leaves the calibrated range is told by name: set pressures, gas pressures, joint angles."""

import dataclasses

import numpy as np
import pytest

from softhand_sim.benchmark.report import beyond_calibration, summarise, table
from softhand_sim.calibration import JOINT_RANGE_RAD
from softhand_sim.calibration.limits import ANGLE_MARGIN_RAD, CalibratedRange, RangeWatch
from softhand_sim.elements import FINGERS
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import crashed
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.hand.scene import EngineSettings, build_scene
from softhand_sim.objects.catalogue import make_object
from softhand_sim.simulation import HandSimulation, default_pneumatics


@pytest.fixture
def simulation(calibration):
    scene = build_scene(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))
    made = HandSimulation(model=scene.model, calibration=calibration, pneumatics=default_pneumatics(calibration))
    made.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
    return made


def run(simulation, seconds):
    for _ in range(round(seconds / simulation.dt)):
        simulation.step()


def test_nothing_is_told_within_the_range(simulation):
    simulation.set_pressure_pa_gauge = np.full(3, 75e3)
    run(simulation, 2.0)
    assert simulation.range_watch.beyond() == {}


def test_a_pressure_that_the_engine_cuts_is_told(simulation, calibration):
    highest = float(calibration.curve.pressure_pa_gauge[-1])
    simulation.set_pressure_pa_gauge = np.array([0.0, highest + 20e3, 0.0])
    run(simulation, 2.0)
    beyond = simulation.range_watch.beyond()
    assert beyond["index_set_pressure_pa_gauge"] == highest + 20e3
    # the gas really is there, and the engine lets no more than the calibrated pressure act
    gas = simulation.pneumatics.finger_pressures_pa_gauge(simulation.gas)[FINGERS.index("index")]
    assert gas > highest + 10e3
    assert beyond["index_pressure_pa_gauge"] == pytest.approx(gas, rel=0.05)
    index, finger = simulation.index, FINGERS.index("index")
    delta = calibration.elongation_m(tuple(simulation.data.qpos[index.joint_qpos[finger]]))
    force = abs(float(simulation.data.actuator_force[index.pressure_ctrl[finger]]))
    assert force == pytest.approx(highest * calibration.chamber.area_m2_at(delta), rel=1e-3)
    assert not any(name.startswith(("thumb", "ring")) for name in beyond)


def test_a_joint_that_is_pushed_beyond_its_law_is_told(simulation, calibration):
    highest = float(np.radians(calibration.curve.joint_angle_deg[:, 1].max()))
    qpos, joint = simulation.data.qpos, simulation.index.joint_qpos[FINGERS.index("ring"), 1]
    qpos[joint] = highest + 0.2
    simulation.step()
    told = simulation.range_watch.beyond()
    assert list(told) == ["ring_middle_highest_rad"]
    assert told["ring_middle_highest_rad"] == pytest.approx(highest + 0.2, abs=0.05)
    simulation.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
    assert simulation.range_watch.beyond() == {}


def test_every_joint_has_its_own_ends(calibration):
    limits = CalibratedRange.of(calibration)
    for finger in range(len(FINGERS)):
        for joint in range(3):
            angles = np.tile(limits.joint_angle_rad, (len(FINGERS), 1))
            watch = RangeWatch(limits=limits)
            watch.look(np.zeros(3), [0.0] * 5, angles)
            assert watch.beyond() == {}
            angles[finger, joint] += 1.01 * ANGLE_MARGIN_RAD
            watch.look(np.zeros(3), [0.0] * 5, angles)
            assert list(watch.beyond().values()) == [angles[finger, joint]]
            angles[finger, joint] = -1.01 * ANGLE_MARGIN_RAD
            watch.look(np.zeros(3), [0.0] * 5, angles)
            assert len(watch.beyond()) == 2


def test_noise_at_the_range_s_end_is_no_flag_but_a_higher_set_pressure_is(calibration):
    limits = CalibratedRange.of(calibration)
    still, end = np.zeros((len(FINGERS), 3)), limits.pressure_pa_gauge
    watch = RangeWatch(limits=limits)
    watch.look(np.full(3, end), [0.0, end + 0.9e3, 0.0, 0.0, 0.0], still)
    assert watch.beyond() == {}
    watch.look(np.array([0.0, 0.0, end + 2.0]), [0.0, end + 1.1e3, 0.0, 0.0, 0.0], still)
    assert watch.beyond() == {
        "middle_ring_little_set_pressure_pa_gauge": end + 2.0,
        "index_pressure_pa_gauge": end + 1.1e3,
    }


def result(name, seed, beyond):
    nothing = crashed(make_object("apple"), load_protocol(), seed)
    return dataclasses.replace(nothing, object=name, outcome=Outcome.MISSED, beyond_calibration=beyond)


def test_the_benchmark_counts_trials_and_keeps_the_extremes():
    low, high = "index_distal_lowest_rad", "ring_middle_highest_rad"
    own = [result("can", 0, {low: -0.1}), result("can", 1, {low: -0.3, high: 0.8}), result("can", 2, {})]
    results = [*own, result("egg", 0, {})]
    assert {k: v["trials_beyond_calibration"] for k, v in summarise(results).items()} == {"can": 2, "egg": 0}
    text = beyond_calibration(results)
    assert text == f"beyond the calibrated range in 2 of 3 trials of can: {low} -0.3, {high} 0.8"
    assert beyond_calibration(results[-1:]) == ""


def test_the_table_counts_holds_that_bent_a_joint_back_to_its_stop():
    """A finger bent forward by as much, or back by less, does not count; nor does an object that was lost."""
    stop = JOINT_RANGE_RAD[0]
    rows = [{"thumb_proximal_lowest_rad": stop - 0.02}, {"thumb_proximal_lowest_rad": stop + 0.02}]
    rows += [{"thumb_proximal_highest_rad": -stop + 1.2}, {}]
    held = [dataclasses.replace(result("can", k, row), outcome=Outcome.HELD) for k, row in enumerate(rows)]
    summary = summarise([*held, result("can", 9, rows[0])])
    assert summary["can"]["held_on_stop"] == 1
    header, row = table(summary).splitlines()
    assert row[header.index("on stop") - 1 :].split()[0] == "1"
