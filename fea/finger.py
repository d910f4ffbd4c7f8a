"""Analysis (iii): the complete finger, actuator inside exoskeleton with contact, under pressure."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fea.actuator import RING, SILICONE, ActuatorMesh, actuator_lattice, chamber_cavity
from fea.arrays import F64, I64
from fea.assembly import SolidModel
from fea.cost import NO_COST, Cost
from fea.exoskeleton import ExoskeletonMesh, exoskeleton_lattice, section_motions
from fea.finger_path import FingerPath
from fea.friction import Together, accumulated_slip_m
from fea.gap_law import ByRegion, NoSeparation, Unilateral
from fea.geometry import FingerGeometry
from fea.lattice import VOID, Lattice, SolidMesh, build_mesh, free_faces, symmetry_nodes
from fea.load import Load
from fea.materials import Material
from fea.meshes import linear_mesh
from fea.newton import NewtonOptions, Status
from fea.path import Sweep, follow
from fea.segment_contact import SegmentOptions
from fea.surface_contact import AnyOptions, AnySurfaces, surface_contact
from fea.tip_wall import TipWall

TPU = 2
FORMULATIONS = ("P1", "P2")
PRESSURES_PA_GAUGE = tuple(1e3 * p for p in (2, 5, 10, 15, 22.5, 30, 37.5, 45, 52.5, 60, 67.5, 75, 80))

FRICTION = 0.3
"""Choice: Coulomb's coefficient of silicone on printed TPU; no measured value was found."""
CONTACT = SegmentOptions(law=Unilateral(stiffness_pa=1e5, distance_m=0.1e-3), reach_m=1.5e-3, friction=FRICTION)
"""Choices: the surfaces begin to push at half the clearance and touch at 100 kPa; within reach is what may meet in one
load step."""

FIRST_STEP_PA, LARGEST_STEP_PA = 1.5e3, 8e3
"""Choices: steps of 8 kPa take 7 to 11 iterations with friction (measured); the first ones meet the contact."""
WEIGHED_BY_PA = 4e3
"""Choice: pressure by which the whole weight acts; friction, which would remember the way, hardly holds there."""


@dataclass(frozen=True, kw_only=True)
class FingerMesh:
    """Cells of both parts; ``actuator.theta_cells`` is not used: the angles are the exoskeleton's."""

    actuator: ActuatorMesh
    exoskeleton: ExoskeletonMesh


OPTIONS = NewtonOptions(
    relative_tolerance=1e-4, max_iterations=16, patience=5, first_step=FIRST_STEP_PA, largest_step=LARGEST_STEP_PA
)

_ACTUATOR = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=2, cap_cells=1, core_cells=1)
MESHES = {
    "coarse": FingerMesh(
        actuator=_ACTUATOR,
        exoskeleton=ExoskeletonMesh(sector_cells=1, rest_cells=2, wall_cells=1, gap_cells=3, segment_cells=2),
    ),
    "calibration": FingerMesh(
        actuator=replace(_ACTUATOR, inner_cells=2),
        exoskeleton=ExoskeletonMesh(sector_cells=2, rest_cells=3, wall_cells=1, gap_cells=4, segment_cells=4),
    ),
    # mean of the cells' longest edges 0.9 mm (rings), 0.9 (silicone) and 2.1 (TPU): Alves et al., section 3.2, have
    # elements of at most 1, 1.5 and 2.5 mm
    "reference": FingerMesh(
        actuator=replace(_ACTUATOR, inner_cells=2),
        exoskeleton=ExoskeletonMesh(sector_cells=5, rest_cells=10, wall_cells=2, gap_cells=6, segment_cells=9),
    ),
}
"""Choice: two cells a ring gap; 38,000, 80,000 and 256,000 degrees of freedom. At 2 kPa the second cell a
ring gap raises the angle by 6.6 %, a third and fourth by another 0.6 %. At 75 kPa coarse bends 10 % less than
reference, calibration 0.1 %.
"""


@dataclass(frozen=True, kw_only=True, eq=False)
class FingerModel:
    """The solid half model and the contact between its two parts."""

    solid: SolidModel
    contact: AnySurfaces


@dataclass(frozen=True, kw_only=True, eq=False)
class FingerResult:
    """Rows over the states that converged, starting with the unloaded one; forces of the whole finger.

    Attributes
    ----------
    branch : tuple of str [n]
        ``"loading"``, ``"unloading"`` or ``"tip load"``.
    pressure_pa_gauge, tip_load_n : arrays [n]
    tip_angle_rad : array [n]
        Rotation of the distal section, positive in flexion.
    joint_angle_rad : array [n, 3]
        Rotations of the joints; their sum is the tip angle.
    tip_displacement_m : array [n]
        Displacement of the end plate's outer centre.
    volume_m3 : array [n]
        Volume of the chamber.
    minimum_gap_m : array [n]
        Smallest gap of the surfaces, ``inf`` where it exceeds the clearance; negative where they overlap.
    contact_force_n : array [n]
        Sum over the actuator's nodes of the magnitude of the contact's forces.
    contact_pressure_pa, slip_m : arrays [n]
        Largest contact pressure on the actuator, and the largest slip of one of its nodes since the row before.
    tip_force_n : array [n]
        Force on the wall in front of the tip, zero without one.
    u_m : array [n_nodes, 3]
        Displacement of the last row.
    status, iterations, dofs, elements
        How the solve ended and its size.
    """

    branch: tuple[str, ...]
    pressure_pa_gauge: F64
    tip_load_n: F64
    tip_angle_rad: F64
    joint_angle_rad: F64
    tip_displacement_m: F64
    volume_m3: F64
    minimum_gap_m: F64
    contact_force_n: F64
    contact_pressure_pa: F64
    slip_m: F64
    tip_force_n: F64
    u_m: F64
    status: Status
    iterations: int
    dofs: int
    elements: int
    cost: Cost = NO_COST


def finger_lattices(geometry: FingerGeometry, mesh: FingerMesh) -> tuple[Lattice, Lattice]:
    """Lattices of actuator and exoskeleton: equal radii where the end plate is bonded to the cap.

    Equal angles also make the facets in contact match, so that faceting does not eat the clearance.
    """
    shell = exoskeleton_lattice(geometry, mesh.exoskeleton)
    inner = actuator_lattice(geometry, replace(mesh.actuator, theta_cells=len(shell.theta_rad) - 1))
    inner = replace(inner, theta_rad=shell.theta_rad)
    r = np.concatenate([inner.r_m, shell.r_m[shell.r_m >= geometry.tube_inner_radius_m]])
    source = np.searchsorted(shell.r_m, 0.5 * (r[1:] + r[:-1])) - 1
    material = np.where(shell.material[source] == VOID, VOID, TPU).astype(np.int64)
    return inner, Lattice(r_m=r, theta_rad=shell.theta_rad, z_m=shell.z_m, material=material)


def finger_model(
    geometry: FingerGeometry,
    silicone: Material,
    pet: Material,
    tpu: Material,
    mesh: FingerMesh,
    *,
    contact: AnyOptions = CONTACT,
    no_separation: bool = False,
    formulation: str = "P2",
) -> FingerModel:
    """Build the half model: both parts fixed on z = 0, end plate bonded to the cap, contact everywhere else.

    With ``no_separation`` the actuator slides in the tube's sections without leaving their walls, as in six of the
    paper's ten regions of contact; at the joints it may separate. Choice, as the paper's figure is not available.

    ``formulation`` is "P2", curved ten-node tetrahedra with one dilatation each, or "P1", linear ones over the same
    vertices, which lock when nearly incompressible and whose chords make walls and chamber smaller.
    """
    if formulation not in FORMULATIONS:
        raise ValueError(f"formulation = {formulation!r} must be one of {', '.join(FORMULATIONS)}")
    body = build_mesh(*finger_lattices(geometry, mesh))
    if formulation == "P1":
        body = linear_mesh(body)
    fixed = np.zeros((len(body.points_m), 3), dtype=bool)
    fixed[symmetry_nodes(body), 1] = True
    fixed[body.cylindrical[:, 2] == 0.0] = True
    laws = {SILICONE: silicone.law, RING: pet.law, TPU: tpu.law}
    solid = SolidModel(mesh=body, laws=dict(laws), fixed=fixed, cavity=chamber_cavity(body, geometry))
    outer = free_faces(body, lambda c: np.isclose(c[..., 0], geometry.actuator_outer_radius_m, rtol=0.0, atol=1e-9))
    tube = _tube_faces(solid, geometry)
    return FingerModel(
        solid=solid,
        contact=surface_contact(
            body, outer, tube, _with_regions(contact, body, tube, geometry) if no_separation else contact
        ),
    )


def _with_regions(options: AnyOptions, mesh: SolidMesh, tube: I64, geometry: FingerGeometry) -> SegmentOptions:
    """Return settings under which the inner faces of the tube's sections hold the actuator at its clearance.

    Raises
    ------
    ValueError
        If the settings are not those of a contact over segments that may separate.
    """
    if not isinstance(options, SegmentOptions) or not isinstance(options.law, Unilateral):
        raise ValueError(f"contact = {options}: regions need segments with a unilateral law")
    law, g = options.law, geometry
    r, _, z = np.moveaxis(mesh.cylindrical[tube], -1, 0)
    inner = np.isclose(r, g.tube_inner_radius_m, rtol=0.0, atol=1e-9).all(axis=1)
    middle = z.mean(axis=1)
    in_gap = np.any([(middle > start) & (middle < start + g.gap_length_m) for start in g.gap_start_m], axis=0)
    holds = NoSeparation(stiffness_pa=law.stiffness_pa, distance_m=law.distance_m, gap_m=g.clearance_m)
    return replace(options, law=ByRegion(laws=(law, holds), region=(inner & ~in_gap).astype(np.int64)))


def finger_weight(
    model: FingerModel,
    silicone: Material,
    pet: Material,
    tpu: Material,
    gravity_m_per_s2: tuple[float, float],
) -> F64:
    """Return the nodal forces of the half model's own weight [n_nodes, 3].

    ``gravity_m_per_s2`` lies in the plane of symmetry: towards the palm side, and along the straight finger to its tip.
    """
    densities = {SILICONE: silicone.density_kg_m3, RING: pet.density_kg_m3, TPU: tpu.density_kg_m3}
    x, z = gravity_m_per_s2
    return model.solid.gravity_force(densities, np.array([x, 0.0, z]))


def analyse_finger(
    model: FingerModel,
    geometry: FingerGeometry,
    path: FingerPath,
    *,
    wall: TipWall | None = None,
    weight_n: F64 | None = None,
    options: NewtonOptions | None = None,
    progress: Callable[[], None] = lambda: None,
    sweep: Sweep | None = None,
) -> FingerResult:
    """Take the finger along a path; ends early where equilibrium is lost.

    With a ``wall`` in front of the tip this is the blocked test. Tip loads are dead loads on the end plate towards the
    back of the hand, as an object pushes that the finger closes on. The weight, nodal forces of the half model
    (:func:`finger_weight`), comes in with the pressure up to ``WEIGHED_BY_PA`` and stays.
    """
    share = _end_plate_share(model.solid, geometry)
    parameters, states = [0.0], [np.zeros_like(model.solid.mesh.points_m)]
    rows = [_measure(model, geometry, states[0], states[0], wall)]

    def record(parameter: float, u_m: F64) -> None:
        parameters.append(parameter)
        rows.append(_measure(model, geometry, u_m, states[0], wall))
        states[:] = [u_m]
        progress()

    def load_at(parameter: float) -> Load:
        force = 0.5 * path.tip_load(parameter) * share if path.tip_loads_n else None
        if weight_n is not None:
            weighed = min(1.0, parameter / WEIGHED_BY_PA) * weight_n
            force = weighed if force is None else force + weighed
        return Load(pressure_pa_gauge=path.pressure(parameter), force_n=force)

    outcome = follow(
        model.solid,
        load_at,
        path.targets,
        options or OPTIONS,
        on_target=record,
        contact=model.contact if wall is None else Together(parts=(model.contact, wall)),
        sweep=sweep,
    )
    table = np.array(rows)
    return FingerResult(
        branch=tuple(path.branch(parameter) for parameter in parameters),
        pressure_pa_gauge=np.array([path.pressure(parameter) for parameter in parameters]),
        tip_load_n=np.array([path.tip_load(parameter) for parameter in parameters]),
        joint_angle_rad=table[:, 0:3],
        tip_angle_rad=table[:, 0:3].sum(axis=1),
        tip_displacement_m=table[:, 3],
        volume_m3=table[:, 4],
        minimum_gap_m=table[:, 5],
        contact_force_n=table[:, 6],
        contact_pressure_pa=table[:, 7],
        slip_m=table[:, 8],
        tip_force_n=table[:, 9],
        u_m=states[0],
        status=outcome.status,
        iterations=outcome.iterations,
        dofs=len(model.solid.free),
        elements=len(model.solid.mesh.elements),
        cost=outcome.cost,
    )


def _tube_faces(solid: SolidModel, geometry: FingerGeometry) -> I64:
    """Faces that the actuator can meet: the tube's inner surface and the walls of the gaps."""
    g = geometry

    def near(c: F64) -> np.ndarray:
        inner = np.isclose(c[..., 0], g.tube_inner_radius_m, rtol=0.0, atol=1e-9)
        edges = [e for start in g.gap_start_m for e in (start, start + g.gap_length_m)]
        wall = np.min([np.abs(c[..., 2] - e) for e in edges], axis=0) < 1e-9
        below = c[..., 2] <= g.actuator_length_m + 1e-9
        return np.asarray((inner | (wall & (c[..., 0] >= g.tube_inner_radius_m - 1e-9))) & below)

    return free_faces(solid.mesh, near)


def _end_plate_share(solid: SolidModel, geometry: FingerGeometry) -> F64:
    """Each node's share of a unit load on the end plate's outer face towards the back of the hand [n_nodes, 3]."""
    share = np.zeros_like(solid.mesh.points_m)
    nodes = np.flatnonzero(solid.mesh.cylindrical[:, 2] >= geometry.finger_length_m - 1e-9)
    share[nodes, 0] = -1.0 / len(nodes)
    return share


def _measure(
    model: FingerModel, geometry: FingerGeometry, u_m: F64, before_m: F64, wall: TipWall | None
) -> list[float]:
    mesh, cavity, contact = model.solid.mesh, model.solid.cavity, model.contact
    assert cavity is not None
    angles = np.diff([motion[0] for motion in section_motions(mesh, geometry, u_m)])
    r, _, z = mesh.cylindrical.T
    tip = int(np.argmin(r + np.abs(z - geometry.finger_length_m)))
    gap = contact.minimum_gap_m(u_m, within_m=geometry.clearance_m)
    force = contact.force_n(u_m)[contact.first_nodes]
    return [
        *(float(angle) for angle in angles),
        float(np.linalg.norm(u_m[tip])),
        2.0 * cavity.volume_m3(mesh.points_m + u_m),
        np.inf if gap is None else gap,
        2.0 * float(np.linalg.norm(force, axis=1).sum()),
        float(contact.contact_pressure_pa(u_m).max()),
        float(accumulated_slip_m(contact, [before_m, u_m]).max()),
        0.0 if wall is None else 2.0 * wall.push_n(u_m),
    ]
