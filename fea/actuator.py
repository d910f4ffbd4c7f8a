"""Analysis (i): the actuator alone, base fixed, 44 bonded rings, pressure on the chamber walls."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, Bool
from fea.assembly import SolidModel
from fea.cavity import Cavity
from fea.cost import NO_COST, Cost
from fea.geometry import FingerGeometry
from fea.inputs import check_pressures
from fea.lattice import VOID, Lattice, SolidMesh, build_mesh, free_faces, split, symmetry_nodes
from fea.linear_solver import SymmetricSolver
from fea.load import Load
from fea.materials import Material
from fea.newton import NewtonOptions, Status
from fea.path import Sweep, follow

SILICONE, RING = 0, 1


@dataclass(frozen=True, kw_only=True)
class ActuatorMesh:
    """Cells of the actuator's lattice: angle, inner layer, each gap between rings, cap, chamber radius."""

    theta_cells: int = 4
    inner_cells: int = 2
    gap_cells: int = 2
    cap_cells: int = 2
    core_cells: int = 2

    def __post_init__(self) -> None:
        for name in ("theta_cells", "inner_cells", "gap_cells", "cap_cells", "core_cells"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} = {getattr(self, name)} must be at least 1")
        if self.theta_cells < 3:
            raise ValueError(f"theta_cells = {self.theta_cells} must be at least 3")


@dataclass(frozen=True, kw_only=True, eq=False)
class ActuatorResult:
    """Arrays over the pressures that converged, starting with the unloaded state.

    Attributes
    ----------
    lengthening_m, elongation : arrays [n]
        Displacement of the cap, and its ratio to the chamber's length (the cap itself does not stretch).
    volume_m3 : array [n]
        Volume of the whole chamber.
    thrust_area_m2 : array [n]
        dV/d(lengthening) at constant pressure: the change of thrust with pressure at a blocked tip. It is smaller than
        the slope of V along the free path, where silicone also bulges between the rings because the pressure rises;
        that part of V does no work on the finger.
    radial_growth_m : array [n]
        Mean over the outer surface at mid-length, two pitches long.
    max_stretch : array [n]
        Largest principal stretch of the silicone.
    """

    pressure_pa_gauge: F64
    elongation: F64
    lengthening_m: F64
    volume_m3: F64
    radial_growth_m: F64
    max_stretch: F64
    thrust_area_m2: F64
    status: Status
    iterations: int
    dofs: int
    elements: int
    cost: Cost = NO_COST


def actuator_lattice(geometry: FingerGeometry, mesh: ActuatorMesh, *, rings: bool = True) -> Lattice:
    """Lattice of the actuator; with ``rings=False`` the ring cells are silicone."""
    g = geometry
    half = 0.5 * g.ring_height_m
    r = split(
        [0.0, g.actuator_inner_radius_m, g.ring_radius_m - half, g.ring_radius_m + half, g.actuator_outer_radius_m],
        [mesh.core_cells, mesh.inner_cells, 1, 1],
    )
    gap = g.ring_pitch_m - g.ring_width_m
    edges, cells, ring_layers = [0.0], [], []
    for k in range(g.ring_count):
        start = (k + 0.5) * g.ring_pitch_m - 0.5 * g.ring_width_m
        edges += [start, start + g.ring_width_m]
        cells += [mesh.gap_cells if k else max(1, mesh.gap_cells // 2), 1]
        ring_layers.append(sum(cells) - 1)
    edges += [g.chamber_length_m, g.actuator_length_m]
    cells += [max(1, mesh.gap_cells // 2), mesh.cap_cells]
    if gap <= 0.0:
        raise ValueError(f"ring_width_m = {g.ring_width_m} must be below the pitch {g.ring_pitch_m}")
    material = np.full((len(r) - 1, mesh.theta_cells, sum(cells)), SILICONE, dtype=np.int64)
    material[: mesh.core_cells, :, : sum(cells[:-1])] = VOID
    if rings:
        material[mesh.core_cells + mesh.inner_cells, :, ring_layers] = RING
    return Lattice(
        r_m=r, theta_rad=np.linspace(0.0, np.pi, mesh.theta_cells + 1), z_m=split(edges, cells), material=material
    )


def actuator_model(
    geometry: FingerGeometry, silicone: Material, pet: Material, mesh: ActuatorMesh, *, rings: bool = True
) -> SolidModel:
    """Build the half model: base z = 0 fixed, symmetry, chamber walls as the cavity."""
    solid = build_mesh(actuator_lattice(geometry, mesh, rings=rings))
    fixed = np.zeros((len(solid.points_m), 3), dtype=bool)
    fixed[symmetry_nodes(solid), 1] = True
    fixed[solid.cylindrical[:, 2] == 0.0] = True
    cavity = chamber_cavity(solid, geometry)
    laws = {SILICONE: silicone.law} | ({RING: pet.law} if rings else {})
    return SolidModel(mesh=solid, laws=dict(laws), fixed=fixed, cavity=cavity)


def chamber_cavity(solid: SolidMesh, geometry: FingerGeometry) -> Cavity:
    """Return the chamber: its wall and the cap's inner face."""
    radius, end = geometry.actuator_inner_radius_m, geometry.chamber_length_m

    def on_chamber(c: F64) -> np.ndarray:
        wall = np.isclose(c[..., 0], radius) & (c[..., 2] <= end + 1e-9)
        cap = np.isclose(c[..., 2], end) & (c[..., 0] <= radius + 1e-9)
        # a face belongs to the wall or to the cap as a whole; a mixed face has an edge in common with both
        return wall | cap

    return Cavity(free_faces(solid, on_chamber), len(solid.points_m))


def analyse_actuator(
    model: SolidModel,
    geometry: FingerGeometry,
    pressures_pa_gauge: list[float],
    *,
    options: NewtonOptions | None = None,
    progress: Callable[[], None] = lambda: None,
    sweep: Sweep | None = None,
) -> ActuatorResult:
    """Inflate through increasing gauge pressures; ends early, with the status, where equilibrium is lost."""
    check_pressures(pressures_pa_gauge)
    solid, cavity = model.mesh, model.cavity
    if cavity is None:
        raise ValueError("model: an actuator needs its cavity")
    zero = np.zeros_like(solid.points_m)
    solver = SymmetricSolver()
    rows = [_measure(model, geometry, 0.0, zero, solver)]

    def record(pressure: float, u_m: F64) -> None:
        rows.append(_measure(model, geometry, pressure, u_m, solver))
        progress()

    outcome = follow(
        model,
        lambda p: Load(pressure_pa_gauge=p),
        pressures_pa_gauge,
        options or NewtonOptions(),
        on_target=record,
        sweep=sweep,
    )
    solver.close()
    pressure, lengthening, volume, growth, stretch, area = np.array(rows).T
    return ActuatorResult(
        pressure_pa_gauge=pressure,
        elongation=lengthening / geometry.chamber_length_m,
        lengthening_m=lengthening,
        volume_m3=volume,
        radial_growth_m=growth,
        max_stretch=stretch,
        thrust_area_m2=area,
        status=outcome.status,
        iterations=outcome.iterations,
        dofs=len(model.free),
        elements=len(solid.elements),
        cost=outcome.cost,
    )


def _measure(
    model: SolidModel, geometry: FingerGeometry, pressure: float, u_m: F64, solver: SymmetricSolver
) -> list[float]:
    solid: SolidMesh = model.mesh
    r, _, z = solid.cylindrical.T
    top = np.isclose(z, geometry.actuator_length_m)
    middle = 0.5 * geometry.chamber_length_m
    ring = np.isclose(r, geometry.actuator_outer_radius_m) & (np.abs(z - middle) <= geometry.ring_pitch_m)
    x = solid.points_m[ring] + u_m[ring]
    growth = np.hypot(x[:, 0], x[:, 1]) - r[ring]
    assert model.cavity is not None
    volume = 2.0 * model.cavity.volume_m3(solid.points_m + u_m)
    stretch = model.max_stretch(u_m, SILICONE)
    area = _thrust_area(model, top, u_m, pressure, solver)
    return [pressure, float(u_m[top, 2].mean()), volume, float(growth.mean()), stretch, area]


def _thrust_area(model: SolidModel, top: Bool, u_m: F64, pressure: float, solver: SymmetricSolver) -> float:
    """Return dV/d(lengthening) at constant pressure when the cap moves as one, as it does on the finger's end plate.

    One linear solve: the other nodes' answer to a unit displacement of the cap's.
    """
    state = model.evaluate(u_m, Load(pressure_pa_gauge=pressure))
    if state is None or state.tangent is None or model.cavity is None:
        raise ValueError("u_m: not an admissible state of the actuator")
    held = np.isin(model.free, 3 * np.flatnonzero(top) + 2)
    upper = sp.csr_array(state.tangent)
    rest = upper[~held]
    pull: F64 = np.asarray(rest[:, held].sum(axis=1) + upper[held][:, ~held].sum(axis=0), dtype=np.float64)
    answer = solver.solve(sp.csr_array(rest[:, ~held]), -pull)
    if answer is None:
        raise ValueError("u_m: the tangent is singular at this state")
    volume_gradient = model.cavity.derivatives(model.mesh.points_m + u_m)[0].ravel()[model.free]
    return 2.0 * float(volume_gradient[held].sum() + volume_gradient[~held] @ answer)
