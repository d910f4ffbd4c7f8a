from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from tests_fea_helpers import tube_model

from fea.actuator import ActuatorMesh, actuator_model, analyse_actuator
from fea.lattice import Lattice
from fea.load import Load
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.workspace import workspace

COARSE = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=2, cap_cells=1, core_cells=1)


def short(geometry, rings: int):
    length = rings * geometry.ring_pitch_m + geometry.cap_thickness_m
    # the exoskeleton's gaps play no part here; they only have to fit
    gaps = (2.1e-3, 4.3e-3, 6.5e-3)
    return replace(geometry, ring_count=rings, actuator_length_m=length, gap_start_m=gaps, gap_length_m=1e-4)


def ideal_ring_elongation(geometry, law, pressure: float) -> float:
    """Closed form of the fact sheet: p r_w^2 = (r_o^2 - r_i^2) sum mu_k (l^(a_k - 1) - l^(-a_k - 1))."""
    area = geometry.actuator_outer_radius_m**2 - geometry.actuator_inner_radius_m**2
    terms = [(c * a, a) for c, a in zip(law.coefficients_pa, law.exponents, strict=True)]

    def excess(stretch: float) -> float:
        wall = sum(mu * (stretch ** (a - 1) - stretch ** (-a - 1)) for mu, a in terms)
        return area * wall - pressure * geometry.ring_radius_m**2

    return brentq(excess, 1.0, 3.0) - 1.0


def exact_ring_elongation(geometry, law, pressure: float) -> float:
    """Rings of no width in a thick wall: incompressibility turns the hoop stretch away from 1 off the ring radius.

    p pi r_w^2 = d/dl of the integral of 2 pi R W(l, t, 1 / (l t)) with R^2 t^2 = r_w^2 - (r_w^2 - R^2) / l.
    """
    g = geometry
    R, h = np.linspace(g.actuator_inner_radius_m, g.actuator_outer_radius_m, 401), 1e-5

    def energy(stretch: float) -> float:
        hoop = np.sqrt(g.ring_radius_m**2 - (g.ring_radius_m**2 - R**2) / stretch) / R
        F = np.zeros((len(R), 3, 3))
        F[:, 0, 0], F[:, 1, 1], F[:, 2, 2] = stretch, hoop, 1.0 / (stretch * hoop)
        return float(np.trapezoid(2.0 * np.pi * R * law.energy(F), R))

    def excess(stretch: float) -> float:
        return (energy(stretch + h) - energy(stretch - h)) / (2 * h) - pressure * np.pi * g.ring_radius_m**2

    return brentq(excess, 1.0, 3.0) - 1.0


def cell_elongations(geometry, materials, scale: float, pressures: list[float]) -> list[float]:
    """Free elongation of one ring pitch between two planes, ring section and pitch scaled together."""
    g = geometry
    width, pitch, half = scale * g.ring_width_m, scale * g.ring_pitch_m, 0.5 * scale * g.ring_height_m
    inner = np.linspace(g.actuator_inner_radius_m, g.ring_radius_m - half, 4)
    outer = np.linspace(g.ring_radius_m + half, g.actuator_outer_radius_m, 3)
    r = np.concatenate([inner, outer])
    z = np.array([0.0, 0.25 * (pitch - width), 0.5 * (pitch - width)])
    z = np.concatenate([z, pitch - z[::-1]])
    material = np.zeros((len(r) - 1, 3, len(z) - 1), dtype=np.int64)
    material[3, :, 2] = 1
    lattice = Lattice(r_m=r, theta_rad=np.linspace(0, np.pi, 4), z_m=z, material=material)
    model = tube_model(lattice, {0: materials.silicone.law, 1: materials.pet.law})
    height = model.mesh.cylindrical[:, 2]
    top = height == height.max()
    options = NewtonOptions(step_cap_m=1e-3)
    u, stretch, found = np.zeros_like(model.mesh.points_m), 0.0, []

    def axial_force(elongation: float, pressure: float) -> float:
        nonlocal u, stretch
        start = u.copy()
        start[:, 2] += (elongation - stretch) * height
        outcome = solve_equilibrium(workspace(model), start, Load(pressure_pa_gauge=pressure), options)
        assert outcome.converged
        u, stretch = outcome.u_m, elongation
        # the cavity's load on the end plane is part of the reaction: zero means that the closed end is free
        return float(model.evaluate(u, Load(pressure_pa_gauge=pressure)).reaction_n[top, 2].sum())

    guess = 0.0
    for pressure in pressures:
        a, b = guess, guess + 0.02
        fa, fb = axial_force(a, pressure), axial_force(b, pressure)
        while abs(b - a) > 1e-6:
            # small steps of the secant keep each solve close to the last
            a, b, fa = b, b - float(np.clip(fb * (b - a) / (fb - fa), -0.02, 0.02)), fb
            fb = axial_force(b, pressure)
        guess = b
        found.append(b)
    return found


def test_elongation_lies_below_the_ideal_rings_and_approaches_them_as_gaps_shrink(geometry, materials):
    pressures = [1e4, 2e4, 3e4, 4e4]
    ideal = np.array([ideal_ring_elongation(geometry, materials.silicone.law, p) for p in pressures])
    full = np.array(cell_elongations(geometry, materials, 1.0, pressures)) / ideal
    assert ((full > 0.70) & (full < 1.0)).all()
    # what remains as the gaps shrink is the hoop strain of the thick wall, which the closed form leaves out
    exact = np.array([exact_ring_elongation(geometry, materials.silicone.law, p) for p in pressures])
    assert ((exact / ideal > 0.85) & (exact / ideal < 0.95)).all()
    half = np.array(cell_elongations(geometry, materials, 0.5, pressures)) / ideal
    quarter = np.array(cell_elongations(geometry, materials, 0.25, pressures)) / ideal
    assert (half - full > 0.03).all()
    assert (quarter - half > 0.01).all()
    assert (quarter < exact / ideal).all()
    assert (quarter > 0.88 * exact / ideal).all()


def test_rings_stop_the_radial_growth(geometry, materials):
    g = short(geometry, 8)
    growth = {}
    for rings in (True, False):
        model = actuator_model(g, materials.silicone, materials.pet, COARSE, rings=rings)
        result = analyse_actuator(model, g, [5e3, 1e4])
        assert result.status is Status.CONVERGED
        growth[rings] = result.radial_growth_m
        if rings:
            assert (np.diff(result.volume_m3) > 0.0).all()
            assert result.thrust_area_m2 == pytest.approx(np.full(3, np.pi * g.ring_radius_m**2), rel=0.35)
    assert (growth[False][1:] > 0.0).all()
    assert (np.abs(growth[True][1:]) < 0.1 * growth[False][1:]).all()


def test_thrust_area_is_the_force_of_a_blocked_tip(geometry, materials):
    """The reduction's area, from one linear solve, against the reaction of an actuator whose cap is held."""
    g = short(geometry, 4)
    model = actuator_model(g, materials.silicone, materials.pet, COARSE)
    area = analyse_actuator(model, g, [1e3]).thrust_area_m2[0]  # of the unloaded state
    top = np.isclose(model.mesh.cylindrical[:, 2], g.actuator_length_m)
    held = np.zeros_like(model.mesh.points_m, dtype=bool)
    held.reshape(-1)[np.setdiff1d(np.arange(held.size), model.free)] = True
    held[top, 2] = True
    blocked = type(model)(mesh=model.mesh, laws=model.laws, fixed=held, cavity=model.cavity)
    load = Load(pressure_pa_gauge=10.0)
    outcome = solve_equilibrium(workspace(blocked), np.zeros_like(model.mesh.points_m), load, NewtonOptions())
    force = -2.0 * float(blocked.evaluate(outcome.u_m, load).reaction_n[top, 2].sum())
    assert force / 10.0 == pytest.approx(area, rel=2e-3)


@pytest.mark.parametrize("pressures", [[], [0.0], [2e3, 1e3], [-1e3]])
def test_bad_pressures_are_refused(geometry, materials, pressures):
    model = actuator_model(short(geometry, 4), materials.silicone, materials.pet, COARSE)
    with pytest.raises(ValueError, match="pressures_pa_gauge"):
        analyse_actuator(model, geometry, pressures)
