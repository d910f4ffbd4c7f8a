"""The weight as a load: closed forms of a cantilever and of the finger's own mass, and what the base has to carry."""

from dataclasses import replace

import numpy as np
import pytest

from fea.actuator import ActuatorMesh
from fea.assembly import SolidModel
from fea.exoskeleton import ExoskeletonMesh
from fea.finger import CONTACT, FingerMesh, analyse_finger, finger_model, finger_weight
from fea.finger_path import FingerPath
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.study import FingerCase
from fea.workspace import workspace

ACTUATOR = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)
EXOSKELETON = ExoskeletonMesh(sector_cells=2, rest_cells=2, wall_cells=1, gap_cells=2, segment_cells=1)
MESH = FingerMesh(actuator=ACTUATOR, exoskeleton=EXOSKELETON)


def test_cantilever_sags_under_its_own_weight_as_timoshenko_has_it():
    """Tip of a clamped bar: q L^4 / (8 E I) + q L^2 / (2 k G A), k = 5/6 (Timoshenko's beam)."""
    young, length, side, density, gravity = 1e6, 20e-3, 2e-3, 1000.0, 0.01
    edges = np.linspace(0.0, side, 3)
    mesh = sweep(rectangle(edges, edges), np.linspace(0.0, length, 21))
    fixed = np.zeros((len(mesh.points_m), 3), dtype=bool)
    fixed[mesh.points_m[:, 2] == 0.0] = True
    law = StVenantKirchhoff(young_modulus_pa=young, poisson_ratio=0.0)
    bar = SolidModel(mesh=mesh, laws={0: law}, fixed=fixed)
    weight = bar.gravity_force({0: density}, np.array([gravity, 0.0, 0.0]))
    outcome = solve_equilibrium(
        workspace(bar), np.zeros_like(mesh.points_m), Load(force_n=weight), NewtonOptions(relative_tolerance=1e-9)
    )
    assert outcome.status is Status.CONVERGED
    sag = outcome.u_m[mesh.points_m[:, 2] == length, 0].mean()
    q, area, inertia = density * gravity * side**2, side**2, side**4 / 12.0
    exact = q * length**4 / (8.0 * young * inertia) + q * length**2 / (2.0 * 5.0 / 6.0 * 0.5 * young * area)
    assert sag == pytest.approx(exact, rel=5e-3)


@pytest.fixture(scope="module")
def slim(geometry):
    return replace(geometry, ring_count=22)


@pytest.fixture(scope="module")
def model(slim, materials):
    m = materials
    return finger_model(slim, m.silicone, m.pet, m.tpu, MESH, contact=replace(CONTACT, friction=0.0))


def test_weight_is_that_of_the_parts_and_pulls_at_their_centre(model, slim, materials):
    g, m = slim, materials
    ring = 2.0 * np.pi * g.ring_radius_m * g.ring_width_m * g.ring_height_m * g.ring_count
    wall = np.pi * (g.actuator_outer_radius_m**2 - g.actuator_inner_radius_m**2) * g.chamber_length_m - ring
    cap = np.pi * g.actuator_outer_radius_m**2 * g.cap_thickness_m
    tube = np.pi * (g.tube_outer_radius_m**2 - g.tube_inner_radius_m**2)
    gaps = len(g.gap_start_m) * g.gap_length_m
    flexure = g.sector_half_angle_rad * (
        (g.tube_inner_radius_m + g.flexure_thickness_m) ** 2 - g.tube_inner_radius_m**2
    )
    shell = tube * (g.actuator_length_m - gaps) + flexure * gaps + np.pi * g.tube_outer_radius_m**2 * g.end_plate_m
    mass = m.pet.density_kg_m3 * ring + m.silicone.density_kg_m3 * (wall + cap) + m.tpu.density_kg_m3 * shell
    across, along = 2.0, -9.0
    force = finger_weight(model, m.silicone, m.pet, m.tpu, (across, along))
    # the half model has half of it; faceted circles are not quite round
    assert 2.0 * force.sum(axis=0) == pytest.approx([mass * across, 0.0, mass * along], rel=3e-3, abs=1e-12)
    # the centre of mass lies a little past the middle: the gaps are nearer to the base, cap and plate at the tip
    height = float(force[:, 2] @ model.solid.mesh.points_m[:, 2]) / float(force[:, 2].sum())
    assert 0.5 * g.finger_length_m < height < 0.53 * g.finger_length_m


def test_base_carries_the_weight_and_the_tip_goes_with_it(model, slim, materials):
    m, pressure = materials, 4e3
    weight = finger_weight(model, m.silicone, m.pet, m.tpu, (-9.81, 0.0))
    heavy = analyse_finger(model, slim, FingerPath((pressure,)), weight_n=weight)
    assert heavy.status is Status.CONVERGED
    # 4 kPa bend a weightless finger by 4 degrees; the weight takes more than that back, most of it at the base
    assert heavy.tip_angle_rad[-1] < 0.0
    assert heavy.joint_angle_rad[-1, 0] < heavy.joint_angle_rad[-1, 1] < 0.0
    load = Load(pressure_pa_gauge=pressure, force_n=weight)
    state = model.solid.evaluate(heavy.u_m, load, tangent=False)
    base = model.solid.mesh.cylindrical[:, 2] == 0.0
    assert state.reaction_n[base, 0].sum() == pytest.approx(-weight[:, 0].sum(), rel=1e-3)


@pytest.mark.parametrize("gravity", [(9.81,), (0.0, 150.0), (float("nan"), 0.0)])
def test_gravity_that_cannot_be_is_refused(gravity):
    with pytest.raises(ValueError, match="gravity_m_per_s2"):
        FingerCase(gravity_m_per_s2=gravity)
