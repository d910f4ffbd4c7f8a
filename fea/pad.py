"""Stiffness of a phalanx's palm side: a rigid sphere pressed into the tube's wall, with the actuator behind it.

A local model, since the wall's dent decays within a tube's radius: one section of the tube, the distal one with its
end plate or the middle one, held on its whole faces at the joints' gaps, where the flexures begin; behind it a length
of the actuator with its rings, held on its cut faces, as the rest of it and the cap hold it. What the section does as a
rigid body belongs to the joints of the surrogate and is not in here. Choices: no friction; no pressure in the chamber.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fea.actuator import RING, SILICONE, ActuatorMesh, actuator_lattice
from fea.arrays import F64, I64
from fea.assembly import SolidModel
from fea.calibration import Materials
from fea.contact_interface import Contact
from fea.finger import CONTACT, TPU
from fea.friction import Together
from fea.geometry import FingerGeometry
from fea.indenter import SphereIndenter
from fea.lattice import VOID, Lattice, SolidMesh, build_mesh, free_faces, split, symmetry_nodes
from fea.load import Load
from fea.newton import NewtonOptions, solve_equilibrium
from fea.surface_contact import surface_contact
from fea.workspace import workspace

SPHERE_RADIUS_M = 10e-3
"""Choice: between the handle of a mug and a fruit; the dent of a thin tube hardly knows it."""
DEPTHS_M = tuple(1e-3 * d for d in (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0))
SECTIONS = ("middle", "distal")
PITCHES = 7
"""Choice: rings' pitches of actuator behind the contact, 14 mm: more than the dent's length."""
_PRESSED_HALF_M, _PRESSED_RAD = 4e-3, np.deg2rad(36.0)
_OPTIONS = NewtonOptions(relative_tolerance=1e-5, max_iterations=40, step_cap_m=2e-3)


@dataclass(frozen=True, kw_only=True)
class PadMesh:
    """Cells of the pressed part of the wall (half its length, its angle), of the rest, and of the thickness."""

    pressed_z_cells: int = 4
    pressed_theta_cells: int = 5
    rest_theta_cells: int = 5
    wall_cells: int = 2

    def __post_init__(self) -> None:
        for name in ("pressed_z_cells", "pressed_theta_cells", "rest_theta_cells", "wall_cells"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} = {getattr(self, name)} must be at least 1")


@dataclass(frozen=True, kw_only=True, eq=False)
class PadResult:
    """Depth of the sphere [m] and force of the whole finger on it [N], (n,), from nothing on; size of the model."""

    section: str
    depth_m: F64
    force_n: F64
    dofs: int
    iterations: int


def pad_lattices(geometry: FingerGeometry, section: str, mesh: PadMesh) -> tuple[Lattice, Lattice, float]:
    """Return the lattices of actuator and tube of a section, and the place of the sphere along the finger [m].

    Raises
    ------
    ValueError
        If there is no such section.
    """
    if section not in SECTIONS:
        raise ValueError(f"section = {section!r} must be one of {', '.join(SECTIONS)}")
    g = geometry
    joint = 1 if section == "middle" else 2
    start = g.gap_start_m[joint] + g.gap_length_m
    end = g.gap_start_m[2] if section == "middle" else g.actuator_length_m
    middle = 0.5 * (start + end)
    side = 0.5 * (end - start) - _PRESSED_HALF_M
    if side <= 0.0:
        raise ValueError(f"gap_start_m: the {section} section is shorter than {2e3 * _PRESSED_HALF_M:g} mm")
    around = max(1, round(side / 2.5e-3))
    edges = [start, middle - _PRESSED_HALF_M, middle + _PRESSED_HALF_M, end]
    cells = [around, 2 * mesh.pressed_z_cells, around]
    if section == "distal":
        edges, cells = [*edges, g.finger_length_m], [*cells, 1]
    z = split(edges, cells)
    theta = split([0.0, _PRESSED_RAD, np.pi], [mesh.pressed_theta_cells, mesh.rest_theta_cells])
    r = split([0.0, g.tube_inner_radius_m, g.tube_outer_radius_m], [2, mesh.wall_cells])
    wall = 0.5 * (r[1:] + r[:-1]) > g.tube_inner_radius_m
    plate = 0.5 * (z[1:] + z[:-1]) > g.actuator_length_m
    solid = np.broadcast_to((wall[:, None] | plate[None, :])[:, None, :], (len(r) - 1, len(theta) - 1, len(z) - 1))
    tube = Lattice(r_m=r, theta_rad=theta, z_m=z, material=np.where(solid, TPU, VOID).astype(np.int64))
    return _actuator_part(g, theta, middle), tube, middle


def _actuator_part(geometry: FingerGeometry, theta_rad: F64, middle_m: float) -> Lattice:
    """Return some pitches of the actuator about a place along it, ending midway between two rings; its chamber only."""
    g = geometry
    cells = len(theta_rad) - 1
    whole = actuator_lattice(g, ActuatorMesh(theta_cells=cells, inner_cells=1, gap_cells=2, cap_cells=1, core_cells=1))
    last = int(g.chamber_length_m / g.ring_pitch_m)
    first = min(max(0, round(middle_m / g.ring_pitch_m - 0.5 * PITCHES)), last - PITCHES)
    ends = [int(np.argmin(np.abs(whole.z_m - g.ring_pitch_m * k))) for k in (first, first + PITCHES)]
    return replace(
        whole,
        theta_rad=theta_rad,
        z_m=whole.z_m[ends[0] : ends[1] + 1],
        material=whole.material[:, :, ends[0] : ends[1]],
    )


def press(
    geometry: FingerGeometry,
    materials: Materials,
    section: str,
    *,
    mesh: PadMesh | None = None,
    depths_m: Sequence[float] = DEPTHS_M,
    sphere_radius_m: float = SPHERE_RADIUS_M,
    actuator: bool = True,
    progress: Callable[[], None] = lambda: None,
) -> PadResult:
    """Press the sphere to increasing depths below where it first touches; return the forces.

    Raises
    ------
    ValueError
        If the section does not exist, the depths do not increase from above 0, or there is no equilibrium at one.
    """
    if not depths_m or depths_m[0] <= 0.0 or (np.diff(depths_m) <= 0.0).any():
        raise ValueError(f"depths_m = {list(depths_m)} must increase, from above 0")
    inner, tube, middle = pad_lattices(geometry, section, mesh or PadMesh())
    body = build_mesh(*([inner, tube] if actuator else [tube]))
    laws = {SILICONE: materials.silicone.law, RING: materials.pet.law, TPU: materials.tpu.law}
    model = SolidModel(mesh=body, laws=dict(laws), fixed=_held(body, geometry, tube, inner))
    outer = _cylinder(body, geometry.tube_outer_radius_m)
    behind = _behind(body, geometry) if actuator else None
    u, work = np.zeros_like(body.points_m), workspace(model)
    forces, iterations = [0.0], 0
    for depth in depths_m:
        x = geometry.tube_outer_radius_m + sphere_radius_m - depth
        sphere = SphereIndenter(
            points_m=body.points_m, faces=outer, centre_m=np.array([x, 0.0, middle]), radius_m=sphere_radius_m
        )
        contact: Contact = sphere if behind is None else Together(parts=(behind, sphere))
        outcome = solve_equilibrium(work, u, Load(), _OPTIONS, contact=contact)
        if not outcome.converged:
            raise ValueError(f"{section}: no equilibrium at a depth of {1e3 * depth:g} mm: {outcome.status.value}")
        u, iterations = outcome.u_m, iterations + outcome.iterations
        behind = None if behind is None else behind.following(u)
        # the half model carries half of it
        forces.append(-2.0 * float(sphere.force_n(u)[:, 0].sum()))
        progress()
    work.close()
    return PadResult(
        section=section,
        depth_m=np.array([0.0, *depths_m]),
        force_n=np.array(forces),
        dofs=len(model.free),
        iterations=iterations,
    )


def _held(body: SolidMesh, geometry: FingerGeometry, tube: Lattice, inner: Lattice) -> np.ndarray:
    """Return the supports [n_nodes, 3]: symmetry, the tube's faces at the gaps, the actuator's cut faces."""
    r, _, z = body.cylindrical.T
    fixed = np.zeros((len(r), 3), dtype=bool)
    fixed[symmetry_nodes(body), 1] = True
    of_tube = r >= geometry.tube_inner_radius_m - 1e-9
    at_gap = np.isclose(z, tube.z_m[0], rtol=0.0, atol=1e-9)
    if tube.z_m[-1] < geometry.finger_length_m - 1e-9:
        at_gap |= np.isclose(z, tube.z_m[-1], rtol=0.0, atol=1e-9)
    cut = np.min([np.abs(z - inner.z_m[k]) for k in (0, -1)], axis=0) < 1e-9
    of_actuator = (r <= geometry.actuator_outer_radius_m + 1e-9) & (z < geometry.actuator_length_m - 1e-9)
    fixed[(of_tube & at_gap) | (of_actuator & cut)] = True
    return fixed


def _behind(body: SolidMesh, geometry: FingerGeometry) -> Contact:
    """Return the contact of the actuator's outer surface and the tube's inner one."""
    g = geometry
    first, second = _cylinder(body, g.actuator_outer_radius_m), _cylinder(body, g.tube_inner_radius_m)
    return surface_contact(body, first, second, replace(CONTACT, friction=0.0))


def _cylinder(body: SolidMesh, radius_m: float) -> I64:
    """Return the free faces at a radius."""
    return free_faces(body, lambda c: np.isclose(c[..., 0], radius_m, rtol=0.0, atol=1e-9))
