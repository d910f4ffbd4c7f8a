"""Sliding friction: bounds, closed form of a cycle, and the sign of its work."""

import numpy as np
import pytest

from softhand_sim.calibration import ChamberCalibration, SlidingCalibration
from softhand_sim.sliding import SlidingFriction, sliding_friction

CHAMBER = ChamberCalibration(volume_m3=2.5e-6, area_m2=6e-5, area_slope_m=4e-4, bulging_m3_per_pa=5e-12)
LAW = SlidingCalibration(coefficient_per_rad=0.015, stiffness_n_per_m=70.0)
FRICTION = SlidingFriction(law=LAW, chamber=CHAMBER)


def follow(elongation, bend, pressure):
    slip, forces, slips = np.zeros(1), [], []
    for d, q, p in zip(elongation, bend, pressure, strict=True):
        slip, force = FRICTION.step(slip, np.array([d]), np.array([q]), np.array([p]))
        forces.append(float(force[0]))
        slips.append(float(slip[0]))
    return np.array(forces), np.array(slips)


def test_a_cycle_at_constant_pressure_and_bend_encloses_a_parallelogram():
    """Elastic-perfectly plastic: the loop is a parallelogram of height 2 F and width s - 2 F / k."""
    sweep, pressure, bend = 5e-3, 60e3, 1.2
    chamber = ChamberCalibration(volume_m3=2.5e-6, area_m2=6e-5, area_slope_m=0.0, bulging_m3_per_pa=0.0)
    friction = SlidingFriction(law=LAW, chamber=chamber)
    bound = 0.015 * bend * pressure * 6e-5
    way = np.linspace(0.0, sweep, 4001)
    path = np.concatenate([way, way[::-1], way])
    slip, forces = np.zeros(1), []
    for d in path:
        slip, force = friction.step(slip, np.array([d]), np.array([bend]), np.array([pressure]))
        forces.append(float(force[0]))
    cycle = slice(4000, None)
    kept = -np.trapezoid(np.array(forces)[cycle], path[cycle])
    assert kept == pytest.approx(2.0 * bound * (sweep - 2.0 * bound / 70.0), rel=1e-3)
    assert np.abs(forces).max() == pytest.approx(bound)


def test_work_on_the_slip_is_never_given_back():
    """Random motion, pressures and bends: the slip only ever moves along the force on the tube."""
    rng = np.random.default_rng(0)
    elongation = 6e-3 + np.cumsum(rng.normal(scale=2e-5, size=4000))
    bend = np.abs(np.cumsum(rng.normal(scale=0.01, size=4000)))
    pressure = np.abs(np.cumsum(rng.normal(scale=500.0, size=4000)))
    force, slip = follow(elongation, bend, pressure)
    assert (-force[1:] * np.diff(slip) >= -1e-18).all()
    assert (np.abs(force) <= 0.015 * bend * pressure * (6e-5 + 4e-4 * elongation) * (1 + 1e-12)).all()
    assert (-force[1:] * np.diff(slip)).sum() > 1e-6


def test_no_pressure_or_no_bend_no_friction():
    force, slip = follow([1e-3, 4e-3, 2e-3], [0.5, 0.0, 0.5], [0.0, 50e3, 0.0])
    assert not force.any()
    assert slip.tolist() == [1e-3, 4e-3, 2e-3]


def test_a_calibration_without_friction_has_none():
    assert sliding_friction(SlidingCalibration(coefficient_per_rad=0.0, stiffness_n_per_m=0.0), CHAMBER) is None
    assert sliding_friction(LAW, CHAMBER) == FRICTION
