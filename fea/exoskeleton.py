"""Analysis (ii): the exoskeleton clamped at its base, with self-weight and a dead load at the distal joint."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fea.arrays import F64, Bool
from fea.assembly import SolidModel
from fea.cost import NO_COST, Cost
from fea.geometry import FingerGeometry
from fea.inputs import check_loads
from fea.lattice import VOID, Lattice, SolidMesh, build_mesh, split, symmetry_nodes
from fea.load import Load
from fea.materials import Material
from fea.newton import NewtonOptions, Status
from fea.path import Sweep, follow

TPU = 0
LOADS_N = (0.07, 0.16, 0.27, 0.40, 0.56)
"""Vertical loads at the distal joint: Alves et al., experiments of section 3.2."""
GRAVITY_M_S2 = 9.80665


@dataclass(frozen=True, kw_only=True)
class ExoskeletonMesh:
    """Cells of the exoskeleton's lattice."""

    sector_cells: int = 3
    rest_cells: int = 4
    wall_cells: int = 2
    gap_cells: int = 5
    segment_cells: int = 4

    def __post_init__(self) -> None:
        for name in ("sector_cells", "rest_cells", "wall_cells", "gap_cells", "segment_cells"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} = {getattr(self, name)} must be at least 1")


@dataclass(frozen=True, kw_only=True, eq=False)
class ExoskeletonResult:
    """Rows over the loads that converged; the first row is self-weight alone.

    Attributes
    ----------
    load_n : array [n]
        Load at the distal joint of the whole finger, in the direction of flexion.
    tip_deflection_m : array [n]
        Displacement of the end plate's outer centre in the load's direction.
    angle_rad, moment_n_m, lengthening_m : arrays [n, 3]
        Joint rotations, bending moments (whole finger, deformed configuration) and lengthening of the actuator's axis
        across each gap, taken as an arc of constant curvature that meets the tube's sections at right angles.
    status, iterations, dofs, elements, cost
        How the solve ended, its size and its cost.
    """

    load_n: F64
    tip_deflection_m: F64
    angle_rad: F64
    moment_n_m: F64
    lengthening_m: F64
    status: Status
    iterations: int
    dofs: int
    elements: int
    cost: Cost = NO_COST


def exoskeleton_lattice(geometry: FingerGeometry, mesh: ExoskeletonMesh) -> Lattice:
    """Tube with three gaps of which only the thickened palm sector remains, closed by the end plate."""
    g = geometry
    inner, outer = g.tube_inner_radius_m, g.tube_outer_radius_m
    edges, cells = [0.0, inner, outer], [2, mesh.wall_cells]
    if g.flexure_thickness_m > g.tube_wall_m:
        edges.append(inner + g.flexure_thickness_m)
        cells.append(max(1, mesh.wall_cells // 2))
    r = split(edges, cells)
    theta = split([0.0, g.sector_half_angle_rad, np.pi], [mesh.sector_cells, mesh.rest_cells])
    z_edges = [0.0]
    z_cells: list[int] = []
    for start in g.gap_start_m:
        z_edges += [start, start + g.gap_length_m]
        z_cells += [2 if len(z_cells) == 0 else mesh.segment_cells, mesh.gap_cells]
    z = split([*z_edges, g.actuator_length_m, g.finger_length_m], [*z_cells, mesh.segment_cells, 1])
    middle = [0.5 * (e[1:] + e[:-1]) for e in (r, theta, z)]
    R, T, Z = np.meshgrid(*middle, indexing="ij")
    in_gap = np.zeros_like(R, dtype=bool)
    for start in g.gap_start_m:
        in_gap |= (start < Z) & (start + g.gap_length_m > Z)
    plate = g.actuator_length_m < Z
    tube = (inner < R) & (outer > R) & ~in_gap
    flexure = (inner < R) & in_gap & (g.sector_half_angle_rad > T)
    solid = tube | flexure | (plate & (outer > R))
    return Lattice(r_m=r, theta_rad=theta, z_m=z, material=np.where(solid, TPU, VOID).astype(np.int64))


def exoskeleton_model(geometry: FingerGeometry, tpu: Material, mesh: ExoskeletonMesh) -> SolidModel:
    """Build the half model, clamped on the base plane z = 0."""
    solid = build_mesh(exoskeleton_lattice(geometry, mesh))
    fixed = np.zeros((len(solid.points_m), 3), dtype=bool)
    fixed[symmetry_nodes(solid), 1] = True
    fixed[solid.cylindrical[:, 2] == 0.0] = True
    return SolidModel(mesh=solid, laws={TPU: tpu.law}, fixed=fixed)


def analyse_exoskeleton(
    model: SolidModel,
    geometry: FingerGeometry,
    tpu: Material,
    *,
    loads_n: tuple[float, ...] = LOADS_N,
    options: NewtonOptions | None = None,
    progress: Callable[[], None] = lambda: None,
    sweep: Sweep | None = None,
) -> ExoskeletonResult:
    """Load the exoskeleton in the closing direction (+x; choice: the paper's figure is not available).

    The load is spread as a dead body force over the flexure of the distal joint; self-weight acts the same way.
    """
    check_loads(loads_n)
    down = np.array([1.0, 0.0, 0.0])
    weight = model.gravity_force({TPU: tpu.density_kg_m3}, GRAVITY_M_S2 * down)
    unit = _distal_unit_force(model, geometry) * down
    rows: list[list[float]] = []

    # parameter 0..1 brings in self-weight, 1 + F the load F [N]; half of each acts on the half model
    def load_at(s: float) -> Load:
        return Load(force_n=min(s, 1.0) * weight + max(s - 1.0, 0.0) * unit)

    def record(s: float, u_m: F64) -> None:
        force = load_at(s).force_n
        assert force is not None
        rows.append([s - 1.0, *_measure(model, geometry, u_m, force)])
        progress()

    targets = [1.0, *(1.0 + f for f in loads_n)]
    # choice: halves of the load steps and a wide cap take the fewest iterations; extrapolation took a third more
    halves = [0.5 * (a + b) for a, b in zip([0.0, *targets[:-1]], targets, strict=True)]
    settings = options or NewtonOptions(step_cap_m=20e-3, max_iterations=12)
    outcome = follow(
        model,
        load_at,
        sorted([*halves, *targets]),
        settings,
        on_target=lambda s, u: record(s, u) if s in targets else None,
        sweep=sweep,
    )
    table = np.array(rows).reshape(-1, 11)
    return ExoskeletonResult(
        load_n=np.round(table[:, 0], 9),
        tip_deflection_m=table[:, 1],
        angle_rad=table[:, 2:5],
        moment_n_m=table[:, 5:8],
        lengthening_m=table[:, 8:11],
        status=outcome.status,
        iterations=outcome.iterations,
        dofs=len(model.free),
        elements=len(model.mesh.elements),
        cost=outcome.cost,
    )


def _distal_unit_force(model: SolidModel, geometry: FingerGeometry) -> F64:
    """Nodal shares [n_nodes, 1] of half a newton spread over the distal flexure."""
    z = model.mesh.cylindrical[model.mesh.elements, 2].mean(axis=1)
    start = geometry.gap_start_m[2]
    inside = (z > start) & (z < start + geometry.gap_length_m)
    loaded = np.where(inside, model.weights.sum(axis=1), 0.0)
    share = np.zeros((len(model.mesh.points_m), 1))
    # choice: mid-edge nodes carry the element's share (vertex weights of the 10-node tetrahedron are negative)
    np.add.at(share, model.mesh.elements[:, 4:], (loaded[:, None, None] / 6.0) * np.ones((1, 6, 1)))
    return np.asarray(0.5 * share / share.sum())


def _measure(model: SolidModel, geometry: FingerGeometry, u_m: F64, force_n: F64) -> list[float]:
    """Tip deflection, three angles, three moments, three lengthenings."""
    solid, g = model.mesh, geometry
    r, _, z = solid.cylindrical.T
    x = solid.points_m + u_m
    motions = section_motions(solid, geometry, u_m)
    theta = np.diff([motion[0] for motion in motions])
    lengthening, moment = [], []
    for k, start in enumerate(g.gap_start_m):
        near = _moved(motions[k], np.array([0.0, start]))
        far = _moved(motions[k + 1], np.array([0.0, start + g.gap_length_m]))
        half = 0.5 * theta[k]
        chord = float(np.linalg.norm(far - near))
        lengthening.append(chord * half / np.sin(half) - g.gap_length_m if abs(half) > 1e-9 else chord - g.gap_length_m)
        moment.append(_moment(solid.points_m, x, force_n, _hinge(g, k, solid.cylindrical), g.joint_position_m[k]))
    tip = int(np.argmin(r + np.abs(z - g.finger_length_m)))
    return [float(u_m[tip, 0]), *(float(t) for t in theta), *moment, *lengthening]


def section_motions(solid: SolidMesh, geometry: FingerGeometry, u_m: F64) -> list[tuple[float, F64, F64]]:
    """Return rotation [rad] (positive in flexion), reference and moved centre [m] (x, z) of the tube's four sections.

    The first is the clamped base; differences of the rotations are the joint angles, the last one is the tip angle.
    """
    g = geometry
    r, _, z = solid.cylindrical.T
    tube = (r >= g.tube_inner_radius_m - 1e-9) & (r <= g.tube_outer_radius_m + 1e-9)
    ends = [*g.gap_start_m[1:], g.actuator_length_m]
    motions = [(0.0, np.zeros(2), np.zeros(2))]
    for start, end in zip(g.gap_start_m, ends, strict=True):
        section = tube & (z >= start + g.gap_length_m - 1e-9) & (z <= end + 1e-9)
        motions.append(_rigid_motion(solid.points_m, solid.points_m + u_m, section))
    return motions


def _hinge(geometry: FingerGeometry, joint: int, cylindrical: F64) -> Bool:
    """Nodes of the flexure near the middle of a gap, whose mean stands for the hinge."""
    z = cylindrical[:, 2]
    near = np.abs(z - geometry.joint_position_m[joint]) <= 0.26 * geometry.gap_length_m
    return np.asarray(near)


def _moment(points: F64, x: F64, force: F64, hinge: Bool, position: float) -> float:
    """Moment about +y of the whole finger's load beyond the hinge, positive in flexion [N m]."""
    centre = x[hinge].mean(axis=0)
    beyond = points[:, 2] > position
    arm = x[beyond] - centre
    f = force[beyond]
    return 2.0 * float((arm[:, 2] * f[:, 0] - arm[:, 0] * f[:, 2]).sum())


def _rigid_motion(points: F64, x: F64, nodes: Bool) -> tuple[float, F64, F64]:
    """Best-fit rigid motion in the xz plane: rotation (positive in flexion), reference and moved centre."""
    a, b = points[nodes][:, [0, 2]], x[nodes][:, [0, 2]]
    ca, cb = a.mean(axis=0), b.mean(axis=0)
    a, b = a - ca, b - cb
    cos = float((a * b).sum())
    sin = float((a[:, 1] * b[:, 0] - a[:, 0] * b[:, 1]).sum())
    return float(np.arctan2(sin, cos)), ca, cb


def _moved(motion: tuple[float, F64, F64], point: F64) -> F64:
    angle, ca, cb = motion
    d = point - ca
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(cb + np.array([c * d[0] + s * d[1], -s * d[0] + c * d[1]]))
