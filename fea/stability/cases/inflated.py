"""Inflated walls: nearly incompressible, past a limit point, thin, reinforced by stiff rings, turned inside out."""

from dataclasses import replace

import numpy as np

from fea.actuator import ActuatorMesh, actuator_model
from fea.arrays import F64
from fea.assembly import SolidModel
from fea.calibration import load_materials
from fea.cavity import Cavity
from fea.geometry import FingerGeometry
from fea.lattice import free_faces
from fea.laws import IsochoricOgden, StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.path import follow
from fea.rubber import neo_hookean
from fea.stability.case import SolidCase, SolidFinding, judged
from fea.verification.balloon import balloon
from fea.verification.common import Problem, pressures, symmetry_planes
from fea.verification.inflation import INNER_M, OUTER_M, closed_form_pressure, sphere_mesh
from fea.workspace import workspace

SHEAR_PA = 1e5
RINGS = 8


def nearly_incompressible() -> SolidFinding:
    """Poisson's ratio of 0.49995, K / mu = 1e4: a sphere under 60 kPa against the closed form."""
    nu = 0.49995
    bulk = SHEAR_PA * 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))
    law = neo_hookean(SHEAR_PA, bulk)
    mesh = sphere_mesh(3, 3)
    faces = free_faces(mesh, lambda c: np.isclose(c[..., 2], INNER_M))
    problem = Problem(mesh=mesh, law=law, fixed=symmetry_planes(mesh), cavity_faces=faces)
    u, _, used = problem.equilibrium("P2/P0", pressures(0.6e5, 4))
    inner = np.isclose(used.cylindrical[:, 2], INNER_M)
    stretch = float(np.linalg.norm((used.points_m + u)[inner], axis=1).mean()) / INNER_M
    exact = closed_form_pressure(law, stretch, OUTER_M / INNER_M, 3)
    return judged("pressure at the same stretch, relative error, <= 0.002", abs(0.6e5 / exact - 1.0), 2e-3)


def past_the_limit_point() -> SolidFinding:
    """Run: a balloon blown to eight times its volume: the pressure rises, turns and falls."""
    path, closed, _ = balloon([1.3, 1.7, 2.2, 3.0, 4.0, 6.0, 8.0], cells=2)
    if path.status is not Status.CONVERGED or path.limit is None:
        return judged("pressures along the path", 1.0, 0.0, typed=path.status.value)
    return judged(
        "pressures along the path, relative error, <= 0.01",
        float(np.abs(path.pressure_pa_gauge / closed - 1.0).max()),
        0.01,
    )


def burst() -> SolidFinding:
    """Run: a pressure 1.3 times the most that a balloon bears: there is no equilibrium, and none may be reported."""
    mesh = sphere_mesh(2, 2, 1.4 * INNER_M)
    cavity = Cavity(free_faces(mesh, lambda c: np.isclose(c[..., 2], INNER_M)), len(mesh.points_m))
    model = SolidModel(mesh=mesh, laws={0: neo_hookean(SHEAR_PA, 5e8)}, fixed=symmetry_planes(mesh), cavity=cavity)
    path, _, _ = balloon([1.3, 1.7, 2.2, 3.0], cells=2, stop_at_limit=True)
    most = path.pressure_pa_gauge.max() if path.limit is None else path.limit.pressure_pa_gauge
    load = Load(pressure_pa_gauge=1.3 * float(most))
    outcome = solve_equilibrium(workspace(model), np.zeros_like(mesh.points_m), load, NewtonOptions(), balanced=Load())
    typed = "" if outcome.converged else outcome.status.value
    return judged("no equilibrium reported", 1.0, 0.0, typed=typed)


def _actuator(ring_pa: float | None = None) -> SolidModel:
    """Return a slim actuator of eight rings, of PET or of Young's modulus ``ring_pa``."""
    base = FingerGeometry()
    length = RINGS * base.ring_pitch_m + base.cap_thickness_m
    geometry = replace(
        base, ring_count=RINGS, actuator_length_m=length, gap_start_m=(2.1e-3, 4.3e-3, 6.5e-3), gap_length_m=1e-4
    )
    materials = load_materials()
    pet = materials.pet
    if ring_pa is not None:
        pet = replace(pet, law=StVenantKirchhoff(young_modulus_pa=ring_pa, poisson_ratio=0.3))
    mesh = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)
    return actuator_model(geometry, materials.silicone, pet, mesh)


def _loaded(model: SolidModel, load_pa: float, steps: int) -> tuple[Status, F64]:
    """Return how loading in equal steps ended, those that fail cut in half, and the displacements [n_nodes, 3]."""
    options = NewtonOptions(relative_tolerance=1e-6, max_iterations=40)
    outcome = follow(
        model,
        lambda share: Load(pressure_pa_gauge=share * load_pa),
        [(k + 1.0) / steps for k in range(steps)],
        options,
        on_target=lambda *_: None,
    )
    return outcome.status, outcome.u_m


def _tube() -> SolidModel:
    """Return a quarter of a tube with a wall of 2 mm around a sheet of rings at 5 mm, between two planes that slide."""
    r, theta, height = np.linspace(4e-3, 6e-3, 3), np.linspace(0.0, 0.5 * np.pi, 4), 2e-3

    def position(x: F64) -> F64:
        flat = x[:, 0] * np.stack([np.cos(x[:, 1]), np.sin(x[:, 1])])
        return np.column_stack([*np.where(np.abs(flat) < 1e-14, 0.0, flat), x[:, 2]])

    mesh = sweep(rectangle(r, theta), np.linspace(0.0, height, 3), position)
    fixed, z = symmetry_planes(mesh), mesh.cylindrical[:, 2]
    # rings at every other node plane: the silicone bulges between them
    fixed[np.isclose(mesh.cylindrical[:, 0], 5e-3) & np.isclose(z % 2e-3, 0.0, atol=1e-9), :2] = True
    fixed[np.isclose(z, height), 2] = True
    cavity = Cavity(free_faces(mesh, lambda c: np.isclose(c[..., 0], 4e-3)), len(z))
    return SolidModel(mesh=mesh, laws={0: load_materials().silicone.law}, fixed=fixed, cavity=cavity)


def in_one_step() -> SolidFinding:
    """80 kPa in one step on a wall of 2 mm between rings: the same state as in four steps."""
    ends = []
    for steps in (1, 4):
        status, u = _loaded(_tube(), 80e3, steps)
        if status is not Status.CONVERGED:
            return judged("the same state as in four steps", 1.0, 0.0, typed=f"{steps} steps: {status.value}")
        ends.append(u)
    off = float(np.abs(ends[0] - ends[1]).max() / np.abs(ends[1]).max())
    return judged("displacement against four steps, share of the largest, <= 1e-3", off, 1e-3)


def stiff_rings() -> SolidFinding:
    """Rings of 10,000 times the silicone's modulus and of 100,000: the wall lengthens alike."""
    silicone = load_materials().silicone.law
    assert isinstance(silicone, IsochoricOgden)
    lengths = []
    for factor in (1e4, 1e5):
        ring_pa = factor * 3.0 * silicone.shear_modulus_pa
        status, u = _loaded(_actuator(ring_pa), 5e3, 1)
        if status is not Status.CONVERGED:
            return judged("lengthening", 1.0, 0.0, typed=status.value)
        lengths.append(float(u[:, 2].max()))
    return judged(
        "lengthening with rings ten times stiffer, relative, <= 0.01", abs(lengths[1] / lengths[0] - 1.0), 0.01
    )


def inverted_start() -> SolidFinding:
    """Run: a start with one node pushed through the opposite face: an inverted element is named, not solved with."""
    mesh = sphere_mesh(2, 2)
    law = neo_hookean(SHEAR_PA, 5e8)
    model = SolidModel(mesh=mesh, laws={0: law}, fixed=symmetry_planes(mesh))
    u = np.zeros_like(mesh.points_m)
    element = mesh.elements[0]
    corner, others = element[0], element[1:4]
    u[corner] = 2.5 * (mesh.points_m[others].mean(axis=0) - mesh.points_m[corner])
    outcome = solve_equilibrium(workspace(model), u, Load(), NewtonOptions())
    typed = outcome.status.value if outcome.status is Status.INVERTED else ""
    return judged("status of a solve that starts inverted", 0.0 if outcome.converged else 1.0, -1.0, typed=typed)


KINDS = {
    name: SolidCase(name=name, hard=hard, stability="converges, or says why not", correctness=right, run=run)
    for name, hard, right, run in (
        (
            "Poisson's ratio of 0.49995",
            "bulk over shear modulus of 10,000",
            "closed form of the thick sphere",
            nearly_incompressible,
        ),
        (
            "balloon past its limit point",
            "the tangent is singular there and negative beyond",
            "closed form on either side",
            past_the_limit_point,
        ),
        ("pressure beyond the limit point", "no equilibrium exists", "a typed status", burst),
        ("80 kPa in one step", "wall of 2 mm between rings, from rest", "the state of four steps", in_one_step),
        (
            "rings of 10,000 times the silicone",
            "stiffness jumps within an element's neighbour",
            "rings hold their radius",
            stiff_rings,
        ),
        ("inverted start", "an element is turned inside out", "a typed status", inverted_start),
    )
}
