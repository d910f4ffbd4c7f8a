from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from fea.actuator import ActuatorMesh, actuator_model
from fea.assembly import element_forces
from fea.contact import ContactOptions
from fea.contact_interface import ContactState
from fea.exoskeleton import ExoskeletonMesh
from fea.finger import CONTACT, OPTIONS, TPU, FingerMesh, analyse_finger, finger_lattices, finger_model
from fea.finger_path import FingerPath
from fea.geometry import FingerGeometry
from fea.lattice import build_mesh, is_conforming
from fea.load import Load
from fea.materials import load_material
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.volume_control import inflate_by_volume
from fea.workspace import workspace

ACTUATOR = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)
EXOSKELETON = ExoskeletonMesh(sector_cells=2, rest_cells=2, wall_cells=1, gap_cells=2, segment_cells=1)
MESH = FingerMesh(actuator=ACTUATOR, exoskeleton=EXOSKELETON)
PRESSURE = 6e3
SMOOTH = replace(CONTACT, friction=0.0)


@pytest.fixture(scope="module")
def slim(geometry) -> FingerGeometry:
    """Every second ring left out: half the cells, the same physics."""
    return replace(geometry, ring_count=22)


@pytest.fixture(scope="module")
def model(slim, materials):
    m = materials
    return finger_model(slim, m.silicone, m.pet, m.tpu, MESH, contact=SMOOTH)


@pytest.fixture(scope="module")
def result(model, slim):
    return analyse_finger(model, slim, FingerPath((2e3, PRESSURE)))


def test_lattices_are_bonded_on_the_cap_alone(slim):
    parts = [build_mesh(lattice) for lattice in finger_lattices(slim, MESH)]
    whole = build_mesh(*finger_lattices(slim, MESH))
    shared = len(parts[0].points_m) + len(parts[1].points_m) - len(whole.points_m)
    z = parts[0].cylindrical[:, 2]
    assert shared == np.count_nonzero(np.isclose(z, slim.actuator_length_m))
    assert is_conforming(whole)
    assert len(whole.elements) == sum(len(part.elements) for part in parts)


def test_finger_bends_towards_the_palm_and_nothing_penetrates(slim, model, result):
    assert result.status is Status.CONVERGED
    np.testing.assert_allclose(result.pressure_pa_gauge, [0.0, 2e3, PRESSURE])
    assert (np.diff(result.joint_angle_rad, axis=0) > 0.0).all()
    np.testing.assert_allclose(result.tip_angle_rad, result.joint_angle_rad.sum(axis=1))
    assert (np.diff(result.volume_m3) > 0.0).all()
    assert (np.diff(result.tip_displacement_m) > 0.0).all()
    # without contact the actuator would have left the clearance by now: it pushes, and stays outside but for a few um
    assert (result.minimum_gap_m > -0.05 * slim.clearance_m).all()
    assert result.contact_force_n[0] == 0.0
    assert result.contact_force_n[-1] > 0.0
    assert result.minimum_gap_m[-1] < model.contact.options.law.distance_m


def test_moment_of_the_thrust_bends_the_flexure(model, slim, result, exoskeleton):
    """Section of the middle joint: thrust p A_eff - T on the end plate, its lever, and the flexure's stiffness."""
    thrust, moment = tpu_section(model.solid, slim, result.u_m, joint=1)
    # ideal rings: the pressure acts on the rings' circle; the silicone takes part of it
    ideal = PRESSURE * np.pi * slim.ring_radius_m**2
    assert 0.3 * ideal < thrust < ideal
    # thrust acts near the actuator's axis, less what the actuator itself takes in bending
    assert slim.actuator_inner_radius_m < moment / thrust < slim.tube_outer_radius_m
    flexure = (exoskeleton.moment_n_m[0, :2] / exoskeleton.angle_rad[0, :2]).mean()
    # the thrust's tension and the actuator inside keep the curved strip from flattening: stiffer than on its own
    assert flexure < moment / result.joint_angle_rad[-1, 1] < 1.6 * flexure


def test_regions_without_separation_hold_the_actuator_in_the_sections_alone(slim, materials, model, result):
    m = materials
    held = finger_model(slim, m.silicone, m.pet, m.tpu, MESH, contact=SMOOTH, no_separation=True)
    u = analyse_finger(held, slim, FingerPath((2e3, PRESSURE)))
    assert u.status is Status.CONVERGED
    region = held.contact.options.law.region

    def farthest(model, u_m, in_section):
        contact = model.contact.following(u_m)
        chosen = region[contact.face] == in_section
        return contact.gaps_m(u_m)[chosen].max()

    assert farthest(held, u.u_m, 1) < 1.2 * slim.clearance_m
    assert farthest(model, result.u_m, 1) > 1.3 * slim.clearance_m
    # what is held need not take up the clearance before it bends the tube
    assert 1.0 < u.tip_angle_rad[-1] / result.tip_angle_rad[-1] < 1.4
    with pytest.raises(ValueError, match="regions need segments"):
        finger_model(slim, m.silicone, m.pet, m.tpu, MESH, contact=ContactOptions(), no_separation=True)


@pytest.fixture(scope="module")
def linear(slim, materials):
    m = materials
    return finger_model(slim, m.silicone, m.pet, m.tpu, MESH, contact=SMOOTH, formulation="P1")


@pytest.fixture(scope="module")
def linear_result(linear, slim):
    return analyse_finger(linear, slim, FingerPath((2e3, PRESSURE)))


@pytest.mark.parametrize("names", [("model", "result"), ("linear", "linear_result")])
def test_every_force_is_balanced_at_equilibrium(names, request):
    """Contact has no resultant of its own, and the supports' reactions are all that is left of pressure and stress."""
    model, result = (request.getfixturevalue(name) for name in names)
    load = Load(pressure_pa_gauge=PRESSURE)
    state = model.solid.evaluate(result.u_m, load, tangent=False)
    touch = model.contact.evaluate(result.u_m).force_n
    np.testing.assert_allclose(touch.sum(axis=0), 0.0, atol=1e-9 * np.abs(touch).sum())
    free = np.zeros(touch.size, dtype=bool)
    free[model.solid.free] = True
    residual = (state.reaction_n - touch).ravel()[free]
    scale = max(np.linalg.norm(force) for force in (state.reaction_n, state.internal_n, state.external_n))
    assert np.linalg.norm(residual) < OPTIONS.relative_tolerance * scale


def test_linear_elements_lock_where_the_silicone_is_nearly_incompressible(
    slim, materials, linear, linear_result, result
):
    assert len(linear.solid.mesh.points_m) < 0.2 * len(result.u_m)
    assert linear_result.status is Status.CONVERGED
    angle = linear_result.tip_angle_rad
    assert (np.diff(angle) > 0.0).all()
    assert angle[-1] < 0.2 * result.tip_angle_rad[-1]
    soft = load_material("ecoflex_00_50", volumetric="d1_literal")
    other = finger_model(slim, soft, materials.pet, materials.tpu, MESH, contact=SMOOTH, formulation="P1")
    # compressible silicone bends quadratic elements 3 % less (measured), linear ones several times more
    assert analyse_finger(other, slim, FingerPath((2e3,))).tip_angle_rad[-1] > 3.0 * angle[1]


def test_chamber_of_linear_elements_is_bounded_by_chords(slim, linear_result, result):
    width = np.diff(finger_lattices(slim, MESH)[0].theta_rad)
    # both halves of the polygon's area times the length
    chords = slim.actuator_inner_radius_m**2 * np.sin(width).sum() * slim.chamber_length_m
    assert linear_result.volume_m3[0] == pytest.approx(chords, rel=1e-9)
    circle = np.pi * slim.actuator_inner_radius_m**2 * slim.chamber_length_m
    assert chords < 0.9 * circle
    assert result.volume_m3[0] == pytest.approx(circle, rel=3e-3)


def test_unknown_formulation_is_refused(slim, materials):
    with pytest.raises(ValueError, match="formulation = 'P3' must be one of P1, P2"):
        finger_model(slim, materials.silicone, materials.pet, materials.tpu, MESH, formulation="P3")


def test_contact_that_never_touches_changes_nothing(slim, materials):
    class Nothing:
        def evaluate(self, u_m, *, project=True):  # noqa: ARG002 - the protocol's signature
            size = u_m.size
            return ContactState(force_n=np.zeros_like(u_m), hessian=sp.csr_array((size, size)))

        def energy(self, _):
            return 0.0

        def force_n(self, u_m):
            return np.zeros_like(u_m)

        def held(self, _):
            return self

        def step_bound(self, *_):
            return 1.0

    actuator = actuator_model(slim, materials.silicone, materials.pet, ACTUATOR)
    zero, load = np.zeros_like(actuator.mesh.points_m), Load(pressure_pa_gauge=1e3)
    with_it, without = (
        solve_equilibrium(workspace(actuator), zero, load, NewtonOptions(), contact=contact)
        for contact in (Nothing(), None)
    )
    assert without.converged
    assert with_it.iterations == without.iterations
    np.testing.assert_allclose(with_it.u_m, without.u_m, atol=1e-9 * np.abs(without.u_m).max())


def tpu_section(solid, geometry, u_m, joint: int) -> tuple[float, float]:
    """Pull [N] and flexion moment [N m] of the whole finger's flexure in the middle of a gap, about its nodes' mean."""
    mesh, cut = solid.mesh, geometry.joint_position_m[joint]
    beyond = np.flatnonzero((mesh.material == TPU) & (mesh.cylindrical[mesh.elements, 2].mean(axis=1) > cut))
    nodes = mesh.elements[beyond]
    force, _ = element_forces(solid.laws[TPU], u_m[nodes], solid.gradients[beyond], solid.weights[beyond])
    internal = np.zeros_like(u_m)
    np.add.at(internal, nodes, force)
    section = np.isclose(mesh.cylindrical[:, 2], cut) & np.isin(np.arange(len(u_m)), nodes)
    f, x = 2.0 * internal[section], (mesh.points_m + u_m)[section]
    arm = x - x.mean(axis=0)
    # internal force of the part beyond = pull of the part before it on the cut, with the sign turned
    pull = np.linalg.norm(f.sum(axis=0))
    moment = -(arm[:, 2] * f[:, 0] - arm[:, 0] * f[:, 2]).sum()
    return float(pull), float(abs(moment))


def test_friction_alone_parts_the_branches(slim, materials):
    """Without friction the way back is the way there; with it the gas gives back less work than it did."""
    rows = {}
    for mu in (0.0, 0.8):
        contact = replace(CONTACT, friction=mu)
        m = finger_model(slim, materials.silicone, materials.pet, materials.tpu, MESH, contact=contact)
        options = replace(OPTIONS, relative_tolerance=1e-6)
        rows[mu] = analyse_finger(m, slim, FingerPath((4e3, 8e3, 12e3), unload=True), options=options)
        assert rows[mu].status is Status.CONVERGED
        assert rows[mu].branch == ("loading",) * 4 + ("unloading",) * 3
    free, rough = rows[0.0], rows[0.8]
    assert free.tip_angle_rad[4] == pytest.approx(free.tip_angle_rad[2], rel=1e-5)
    assert abs(free.tip_angle_rad[6]) < 1e-5 * free.tip_angle_rad[3]
    assert rough.tip_angle_rad[3] < free.tip_angle_rad[3]
    parted = {mu: np.abs(r.joint_angle_rad[4] - r.joint_angle_rad[2]).max() for mu, r in rows.items()}
    assert parted[0.8] > 20.0 * parted[0.0]
    work = {mu: float(np.trapezoid(r.pressure_pa_gauge, r.volume_m3)) for mu, r in rows.items()}
    assert work[0.8] > 20.0 * abs(work[0.0])
    assert (rough.slip_m[2:5] > 0.0).all()
    assert (rough.contact_pressure_pa[2:5] > 0.0).all()


@pytest.mark.parametrize("pressure", [PRESSURE, 2.0 * PRESSURE])
def test_the_whole_load_in_one_step_ends_where_small_steps_do(model, slim, pressure):
    """The lower load was once too much: its linear step ran 30 times the load deep into the contact.

    Faces are cut in other states on the two ways, hence 1e-4.
    """
    fine = replace(OPTIONS, relative_tolerance=1e-6)
    steps = analyse_finger(model, slim, FingerPath((2e3, pressure)), options=fine)
    work, zero = workspace(model.solid), np.zeros_like(steps.u_m)
    once = solve_equilibrium(work, zero, Load(pressure_pa_gauge=pressure), fine, balanced=Load(), contact=model.contact)
    work.close()
    assert once.converged
    np.testing.assert_allclose(once.u_m, steps.u_m, atol=1e-4 * np.abs(steps.u_m).max())


def test_tip_load_and_pressure_are_reciprocal(model, slim):
    """Maxwell: what a load on the tip takes from the chamber's volume, pressure takes from the way along the load."""
    fine = replace(OPTIONS, relative_tolerance=1e-9, max_iterations=30)
    step_pa, load_n = 50.0, 2e-3
    end = model.solid.mesh.cylindrical[:, 2] >= slim.finger_length_m - 1e-9

    def state(pressures_pa, loads_n=()):
        r = analyse_finger(model, slim, FingerPath(pressures_pa, tip_loads_n=loads_n), options=fine)
        assert r.status is Status.CONVERGED
        return r, -float(r.u_m[end, 0].mean())

    (_, low_m), (_, high_m) = (state((PRESSURE + change,)) for change in (-step_pa, step_pa))
    loaded, loaded_m = state((PRESSURE,), (load_n,))
    assert loaded.branch == ("loading", "loading", "tip load")
    np.testing.assert_allclose(loaded.tip_load_n, [0.0, 0.0, load_n])
    np.testing.assert_allclose(loaded.pressure_pa_gauge, [0.0, PRESSURE, PRESSURE])
    taken = float(np.diff(loaded.volume_m3)[-1]) / load_n
    assert taken < 0.0
    assert taken == pytest.approx((high_m - low_m) / (2.0 * step_pa), rel=0.02)
    assert loaded_m > 0.5 * (low_m + high_m)


@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_volume_control_finds_the_pressure_that_gave_the_volume(slim, materials, friction):
    """With contact and friction too: the same path, told by its volumes instead of its pressures."""
    m = materials
    rough = finger_model(slim, m.silicone, m.pet, m.tpu, MESH, contact=replace(CONTACT, friction=friction))
    pressures = (2e3, 4e3, PRESSURE)
    fine = replace(OPTIONS, relative_tolerance=1e-6, first_step=np.inf)
    by_pressure = analyse_finger(rough, slim, FingerPath(pressures), options=fine)
    halves = [0.5 * v for v in by_pressure.volume_m3[1:]]
    by_volume = inflate_by_volume(rough.solid, halves, fine, contact=rough.contact)
    assert by_volume.status is Status.CONVERGED
    np.testing.assert_allclose(by_volume.pressure_pa_gauge, pressures, rtol=1e-3)
    far = np.abs(by_pressure.u_m).max()
    np.testing.assert_allclose(by_volume.u_m[-1], by_pressure.u_m, atol=2e-3 * far)
    # the slope belongs to the curve: the mean of the ends' is the chord's, but for its curvature
    chord = np.diff(pressures) / np.diff(halves)
    ends = 0.5 * (by_volume.slope_pa_per_m3[1:] + by_volume.slope_pa_per_m3[:-1])
    np.testing.assert_allclose(ends, chord, rtol=0.05)
