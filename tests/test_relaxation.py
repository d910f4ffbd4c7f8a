"""Relaxation of the wall: closed forms, dissipation, and the finger's creep to its calibrated angle."""

import numpy as np
import pytest

from softhand_sim.calibration import TendonCalibration
from softhand_sim.characterize import Bench
from softhand_sim.losses import Losses
from softhand_sim.relaxation import CONDITIONED_SILICONE, MaxwellBranch, Relaxation

WALL = TendonCalibration(stiffness_n_per_m=200.0, stiffness_n_per_m2=0.0, stiffness_n_per_m3=0.0)
BRANCHES = (MaxwellBranch(stiffness_ratio=0.1, time_s=0.5), MaxwellBranch(stiffness_ratio=0.05, time_s=4.0))


def test_force_of_a_held_step_is_the_prony_series():
    relaxation, flow = Relaxation.of(WALL, BRANCHES), np.zeros((2, 1))
    held, dt = np.array([0.01]), 2e-3
    for k in range(1, 2001):
        flow, force = relaxation.step(flow, held, dt)
        if k in (1, 250, 2000):
            t = k * dt
            series = 200.0 * 0.01 * (0.1 * np.exp(-t / 0.5) + 0.05 * np.exp(-t / 4.0))
            assert force[0] == pytest.approx(-series, rel=1e-9)


def test_loss_of_an_oscillation_is_that_of_the_maxwell_model():
    """Work a cycle pi k a^2 w t / (1 + (w t)^2), for each branch."""
    relaxation, flow, dt, a, w = Relaxation.of(WALL, BRANCHES), np.zeros((2, 1)), 5e-4, 1e-3, 2.0 * np.pi
    time = np.arange(0.0, 20.0, dt)
    path = a * np.sin(w * time)
    force = np.empty_like(path)
    for k, d in enumerate(path):
        flow, f = relaxation.step(flow, np.array([d]), dt)
        force[k] = f[0]
    last = time >= 19.0 - dt
    work = -np.trapezoid(force[last], path[last])
    wt = w * relaxation.time_s
    assert work == pytest.approx(
        float((np.pi * relaxation.stiffness_n_per_m * a**2 * wt / (1 + wt**2)).sum()), rel=2e-3
    )


def test_a_finger_creeps_to_its_calibrated_angle(calibration):
    """At constant pressure the angle rises, by less and less, to where a finger without relaxation stands."""
    creeping, plain = Bench(calibration, relaxation=CONDITIONED_SILICONE), Bench(calibration).go_to(50e3)
    for k in range(500):
        creeping.step(50e3 * (k + 1) / 500)
    angles = []
    for _ in range(4):
        for _ in range(2500):
            creeping.step(50e3)
        angles.append(creeping.read().tip_angle_deg)
    assert (np.diff(angles) > 0.0).all()
    assert (np.diff(angles, 2) < 0.0).all()
    assert plain.tip_angle_deg - 0.5 < angles[-1] < plain.tip_angle_deg


def test_absent_effects_have_no_state_and_no_force(calibration):
    nothing = Losses(sliding=None, relaxation=None)
    state = nothing.rest(np.array([1e-3, 2e-3]))
    assert state.flow_m.shape == (0, 2)
    after, force = nothing.step(state, np.array([5e-3, 6e-3]), np.ones(2), np.full(2, 5e4), 2e-3)
    assert not force.any()
    assert after.slip_m is state.slip_m
    assert Losses.of(calibration).relaxation is None


def test_bad_branches_are_named():
    with pytest.raises(ValueError, match=r"time_s = 0\.0"):
        MaxwellBranch(stiffness_ratio=0.1, time_s=0.0)
    with pytest.raises(ValueError, match=r"stiffness_ratio = -0\.1"):
        MaxwellBranch(stiffness_ratio=-0.1, time_s=1.0)
    with pytest.raises(ValueError, match="branches"):
        Relaxation.of(WALL, ())
