"""The finger by hand against numerical integrals, energies and the calibrated finger."""

from math import cos, pi

import numpy as np
import pytest
from scipy.integrate import dblquad, quad
from scipy.optimize import minimize

from softhand_sim.fidelity.closed_form import ClosedFormFinger, Strip

DISTANCE_M = 40e-3


@pytest.fixture(scope="module")
def flat(calibration):
    return ClosedFormFinger.of(calibration, Strip.FLAT)


def test_the_curved_strip_s_moment_is_the_sector_s_integral(calibration):
    g = calibration.geometry
    finger = ClosedFormFinger.of(calibration, Strip.CURVED)
    inner = g["actuator_outer_radius_m"] + g["clearance_m"]
    outer, half = inner + g["flexure_thickness_m"], g["sector_half_angle_rad"]

    def integral(power):
        # in mm, so that the integrator's absolute tolerance means something
        value, _ = dblquad(lambda t, r: r * (r * cos(t)) ** power, 1e3 * inner, 1e3 * outer, -half, half)
        return value

    area, first, second = integral(0), integral(1), integral(2)
    assert 1e3 * finger.arm_m == pytest.approx(first / area, rel=1e-9)
    shear = 2.0 * (0.210e6 + 0.525e6)  # C10 + C01 of the paper's set 3
    stiffness = 3.0 * shear * 1e-12 * (second - first**2 / area) / g["gap_length_m"]
    assert finger.stiffness_n_m_per_rad == pytest.approx(stiffness, rel=1e-9)


def test_the_wall_s_tension_is_the_slope_of_the_ring_tube_s_energy(flat):
    wall = flat.wall

    def energy(axial):
        def ring(radius):
            hoop = np.sqrt(wall.ring_m**2 - (wall.ring_m**2 - radius**2) / axial) / radius
            stretches = np.array([axial, hoop, 1.0 / (axial * hoop)])
            pairs = zip(wall.coefficients_pa, wall.exponents, strict=True)
            return 2.0 * pi * radius * sum(c * (stretches**a - 1.0).sum() for c, a in pairs)

        return quad(ring, wall.inner_m, wall.outer_m, epsabs=0.0, epsrel=1e-12)[0]

    h = 1e-5
    for axial in (1.1, 1.3):
        slope = (energy(axial + h) - energy(axial - h)) / (2.0 * h)
        assert wall.tension_n((axial - 1.0) * wall.length_m) == pytest.approx(slope, rel=1e-6)
    assert wall.tension_n(1e-7 * wall.length_m) / 1e-7 == pytest.approx(wall.stiffness_n, rel=1e-5)


def test_the_blocked_force_is_what_the_energy_falls_by_as_the_wall_recedes(flat):
    """Least potential energy with the tip on the wall, over the wall's distance: dE/dx = -F."""

    def least(distance):
        def potential(q):
            d = flat.arm_m * q.sum()
            wall = 0.5 * flat.wall.stiffness_n / flat.wall.length_m * d**2
            bent = 0.5 * flat.stiffness_n_m_per_rad * (q @ q)
            return 1e3 * (bent + wall - 75e3 * flat.area_m2 * d)

        on_wall = {
            "type": "eq",
            "fun": lambda q: 1e2 * (flat.tip_m(q, flat.radius_m)[0] - flat.radius_m - distance),
        }
        found = minimize(potential, np.full(3, 0.25), constraints=[on_wall], method="SLSQP", options={"ftol": 1e-13})
        return 1e-3 * float(found.fun)

    h = 1e-3
    force = (least(DISTANCE_M - h) - least(DISTANCE_M + h)) / (2.0 * h)
    assert flat.blocked_force_n(75e3, DISTANCE_M) == pytest.approx(force, rel=1e-3)
    assert flat.blocked_force_n(20e3, DISTANCE_M) == 0.0


def test_the_two_strips_bracket_the_calibrated_joints(calibration, flat):
    curved = ClosedFormFinger.of(calibration, Strip.CURVED)
    finite = ClosedFormFinger.of(calibration, Strip.FLAT, finite=True)
    for pressure in (20e3, 50e3, 75e3):
        tip = np.radians(calibration.angle_for_pressure(pressure))
        low, high = (3.0 * f.joint_angle_rad(pressure) for f in (curved, finite))
        assert low < 3.0 * flat.joint_angle_rad(pressure) < high < tip
    assert 3.0 * finite.joint_angle_rad(75e3) == pytest.approx(tip, rel=0.2)


def test_the_tip_of_a_straight_finger_is_its_end(calibration, flat):
    assert flat.tip_m(np.zeros(3)) == pytest.approx([0.0, calibration.finger.length_m], abs=1e-15)
    assert flat.tip_m(np.zeros(3), flat.radius_m)[0] == pytest.approx(calibration.finger.outer_radius_m)
