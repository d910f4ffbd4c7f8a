"""The swing of a released finger against a closed form, and what damping does to it."""

from dataclasses import replace

import numpy as np
import pytest

from softhand_sim.characterize.ring_down import first_mode, ring_down


def damped(calibration, share):
    joints = tuple(replace(j, damping_n_m_s_per_rad=share * j.damping_n_m_s_per_rad) for j in calibration.joints)
    return replace(calibration, joints=joints)


def test_first_mode_of_a_light_finger_is_that_of_rayleigh(calibration):
    """Without dashpots it does not decay, and its frequency is below that of its deflection under a tip load."""
    rate, frequency = first_mode(damped(calibration, 0.0))
    assert abs(rate) < 1e-6 * frequency
    light, _ = first_mode(damped(calibration, 1e-2)), None
    assert light[0] == pytest.approx(1e-2 * first_mode(calibration)[0], rel=0.1)
    # a rod on a single joint as soft as the three in a row under the same moment: Rayleigh's upper bound
    finger, joints = calibration.finger, calibration.joints
    beyond = finger.length_m - finger.joint_position_m[0]
    inertia = finger.mass_kg / finger.length_m * beyond**3 / 3.0
    arm = np.array([joint.offset_m for joint in joints])
    single = joints[0].stiffness_n_m_per_rad + calibration.tendon.stiffness_n_per_m * arm[0] ** 2
    assert frequency < np.sqrt(single / inertia)
    assert frequency > 0.7 * np.sqrt(single / inertia)


def test_less_damping_swings_longer_and_the_engine_keeps_the_mode(calibration):
    settled = []
    for share in (1.0, 0.4):
        report = ring_down(damped(calibration, share))
        assert report.holds, [str(check) for check in report.checks]
        settled.append(report.figures["swings"][0]["settling_time_s"])
    assert settled[1] > 1.5 * settled[0]


def test_friction_keeps_some_of_what_was_let_go_under_pressure_alone(calibration):
    rest, pressed = ring_down(calibration).figures["swings"]
    assert abs(rest["left_deg"]) < 1e-3
    assert 0.01 < pressed["left_deg"] < 0.5
