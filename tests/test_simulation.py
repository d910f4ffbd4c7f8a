"""Engine, gas and wrist together."""

import numpy as np
import pytest

from softhand_sim.elements import FINGERS
from softhand_sim.grasp.contacts import ContactMap
from softhand_sim.grasp.record import Recorder
from softhand_sim.hand.scene import EngineSettings, build_scene
from softhand_sim.losses import Losses
from softhand_sim.simulation import HandSimulation, default_pneumatics
from softhand_sim.wrist import limited_step


@pytest.fixture
def simulation(calibration):
    scene = build_scene(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))
    made = HandSimulation(model=scene.model, calibration=calibration, pneumatics=default_pneumatics(calibration))
    made.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
    return made


def run(simulation, seconds):
    for _ in range(round(seconds / simulation.dt)):
        simulation.step()


def test_chamber_volume_is_the_calibration_s_at_the_tendon_s_length(simulation, calibration):
    simulation.set_pressure_pa_gauge = np.array([30e3, 50e3, 70e3])
    run(simulation, 3.0)
    angles = simulation.data.qpos[simulation.index.joint_qpos]
    own = [calibration.chamber.volume_m3_at(calibration.elongation_m(tuple(row))) for row in angles]
    # the engine's tendon lengths are those of the step's start
    assert simulation.chamber_volumes_m3() == pytest.approx(own, rel=1e-4)
    assert min(own) > calibration.chamber.volume_m3_at(0.0)


def test_sliding_friction_opposes_the_motion_within_its_bound(simulation, calibration):
    law, index = calibration.sliding, simulation.index

    def force_and_bound():
        pressure = simulation.data.ctrl[index.pressure_ctrl]
        bend = np.abs(simulation.data.qpos[index.joint_qpos]).sum(axis=1)
        area = np.array([calibration.chamber.area_m2_at(d) for d in simulation.elongations_m()])
        return simulation.data.ctrl[index.loss_ctrl].copy(), law.coefficient_per_rad * bend * pressure * area

    simulation.set_pressure_pa_gauge = np.full(3, 70e3)
    run(simulation, 1.6)
    closing, bound = force_and_bound()
    assert (closing < -0.5 * bound).all()
    assert (closing >= -1.02 * bound).all()
    simulation.set_pressure_pa_gauge = np.full(3, 40e3)
    run(simulation, 3.0)
    opening, bound = force_and_bound()
    assert (opening > 0.5 * bound).all()
    assert (opening <= 1.02 * bound).all()


def test_shut_valves_keep_the_gas_when_a_finger_is_bent(simulation):
    """Isothermal gas: pV of an element is constant while its finger is pushed, here by the joints' own coordinates."""
    simulation.set_pressure_pa_gauge = np.full(3, 40e3)
    run(simulation, 3.0)
    while any(valve for command in simulation.gas.valves for valve in command):
        simulation.step()
    before = simulation.gas
    element = simulation.pneumatics.elements[1]
    assert element.compliance_m3_per_pa > 0.0
    index = FINGERS.index("index")

    def product():
        pressure = simulation.gas.pressure_pa_abs[1]
        bulging = element.compliance_m3_per_pa * (pressure - element.ambient_pa_abs)
        return pressure * (simulation.chamber_volumes_m3()[index] + element.dead_volume_m3 + bulging)

    kept = product()
    simulation.data.qpos[simulation.index.joint_qpos[index]] += 0.2
    simulation.data.qvel[:] = 0.0
    simulation.step()
    assert simulation.gas.mass_kg == before.mass_kg
    simulation.gas = simulation.pneumatics.step(
        simulation.gas, simulation.chamber_volumes_m3(), simulation.set_pressure_pa_gauge, 1e-6
    )
    assert product() == pytest.approx(kept, rel=1e-3)
    assert simulation.gas.pressure_pa_abs[1] < before.pressure_pa_abs[1]


def test_set_angle_is_reached_through_valves_and_gas(simulation, calibration):
    """Closed loop: each finger ends within one valve pulse (2 kPa) below the angle that was asked for."""
    pressure = calibration.pressure_for_angle(60.0)
    simulation.set_pressure_pa_gauge = np.full(3, pressure)
    run(simulation, 4.0)
    angle = np.degrees(simulation.tip_angles_rad())
    assert (angle <= 60.0 + 1.0).all()
    assert (angle >= calibration.angle_for_pressure(pressure - 2.5e3) - 0.5).all()


def test_wrist_moves_at_the_paper_s_speed_and_arrives(simulation):
    target = np.array([0.06, -0.08, 0.3, 0.0, 0.0, 0.5])
    simulation.wrist_target = target
    qpos = simulation.index.wrist_qpos
    run(simulation, 0.5)
    start = simulation.data.qpos[qpos].copy()
    run(simulation, 0.2)
    moved = np.linalg.norm((simulation.data.qpos[qpos] - start)[:3])
    assert moved == pytest.approx(0.1 * 0.2, rel=0.02)
    run(simulation, 1.0)
    assert simulation.wrist_arrived
    assert simulation.data.qpos[qpos] == pytest.approx(target, abs=1e-3)


def test_limited_step_never_passes_its_limits_nor_the_target():
    current, target = np.zeros(6), np.array([3e-4, 4e-4, 0.0, 0.5, -0.5, 1e-4])
    step = limited_step(current, target, 2e-4, 1e-3)
    assert step == pytest.approx([1.2e-4, 1.6e-4, 0.0, 1e-3, -1e-3, 1e-4])
    assert np.array_equal(limited_step(target, target, 2e-4, 1e-3), target)


def test_recorded_creep_is_that_of_the_second_half(calibration):
    contacts = ContactMap.of(build_scene(calibration).model)
    recorder = Recorder(object_body=0, rest_height_m=0.0, contacts=contacts)
    for time in np.arange(0.0, 3.0, 0.02):
        settling = 1e-3 * np.exp(-time / 0.05)
        recorder.hold_time_s.append(float(time))
        recorder.hold_position_m.append(np.array([settling, 0.0, -5e-5 * time]))
    assert recorder.creep_m_per_s() == pytest.approx(5e-5, rel=1e-3)


def test_deepest_contact_of_the_object_is_found(calibration):
    def ball(root):
        body = root.worldbody.add("body", name="object")
        body.add("freejoint")
        body.add("geom", type="sphere", size=(0.02,))

    scene = build_scene(calibration, add_object=ball)
    simulation = HandSimulation(model=scene.model, calibration=calibration, pneumatics=default_pneumatics(calibration))
    simulation.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
    recorder = Recorder.of(simulation, 0.02)
    recorder.sample(simulation)
    # the ball's centre lies in the table's plane: it is one radius deep
    assert recorder.deepest_m == pytest.approx(0.02, rel=1e-6)


def test_steps_at_one_go_are_single_steps_to_the_bit(calibration):
    """With and without something to do between the engine's steps; the wrist moves at first."""
    scene = build_scene(calibration)
    nothing = Losses(sliding=None, relaxation=None)
    for pneumatics, losses in ((None, nothing), (default_pneumatics(calibration), None)):
        ends = []
        for at_once in (False, True):
            simulation = HandSimulation(
                model=scene.model, calibration=calibration, pneumatics=pneumatics, losses=losses
            )
            simulation.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
            simulation.wrist_target = np.array([0.01, 0.0, 0.3, 0.0, 0.0, 0.1])
            simulation.set_pressure_pa_gauge = np.array([50e3, 60e3, 70e3])
            for steps in (7, 200, 33, 10):
                if at_once:
                    simulation.advance(steps)
                else:
                    for _ in range(steps):
                        simulation.step()
            watched = simulation.range_watch
            ends.append((simulation.data.time, simulation.data.qpos.tobytes(), watched.extremes.tobytes()))
        assert ends[0] == ends[1]


def test_recorded_pressures_at_one_go_repeat_a_run_to_the_bit_and_leave_the_gas_alone(simulation):
    def start():
        simulation.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
        simulation.set_pressure_pa_gauge = np.array([50e3, 60e3, 70e3])

    start()
    pressures = []
    for _ in range(60):
        simulation.step()
        pressures.append(simulation.data.ctrl[simulation.index.pressure_ctrl].copy())
    end = simulation.data.qpos.tobytes()
    start()
    gas = simulation.gas
    simulation.play_pressures(iter(pressures))
    for steps in (1, 9, 20, 30):
        simulation.advance(steps)
    assert simulation.data.qpos.tobytes() == end
    assert simulation.gas == gas
    simulation.play_pressures(None)
    simulation.advance(10)
    assert simulation.gas.mass_kg != gas.mass_kg
