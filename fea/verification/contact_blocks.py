"""Two blocks, one above the other, and a driver that moves the upper one's top face along a path.

Shared by the contact problems. The blocks' facets do not match: the grids differ and may be turned.
"""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64, Bool
from fea.assembly import SolidModel
from fea.contact import ContactOptions
from fea.friction import advance, begin, solve_step
from fea.gap_law import Unilateral
from fea.lattice import SolidMesh, free_faces
from fea.laws import Law
from fea.load import Load
from fea.meshes import rectangle, sweep, union
from fea.newton import NewtonOptions
from fea.segment_contact import SegmentOptions
from fea.surface_contact import AnyOptions, AnySurfaces, surface_contact
from fea.workspace import workspace

CONTACTS = ("segments", "barrier")


def settings(
    contact: str, *, distance_m: float, stiffness_pa: float, reach_m: float = 1e-3, friction: float = 0.0
) -> AnyOptions:
    """Return the settings of a contact of the one or the other kind that begins to push at a distance."""
    if contact == "barrier":
        return ContactOptions(
            activation_distance_m=distance_m, stiffness_pa=stiffness_pa, friction=friction, count_once=True
        )
    law = Unilateral(stiffness_pa=stiffness_pa, distance_m=distance_m)
    return SegmentOptions(law=law, reach_m=reach_m, friction=friction)


@dataclass(frozen=True, kw_only=True)
class Block:
    """A square block: side, height, cells along each and the angle that it is turned by about z."""

    side_m: float
    height_m: float
    cells: int
    layers: int
    turned_deg: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Pair:
    """Model of the two blocks, their contact, and masks [n_nodes] of the upper block and of its top face."""

    model: SolidModel
    contact: AnySurfaces
    upper: Bool
    top: Bool


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """A converged step: displacement of the top face [3], force on it [3] and nodal displacements."""

    moved_m: F64
    force_n: F64
    u_m: F64
    iterations: int


def block_pair(
    lower: Block, upper: Block, law: Law, contact: AnyOptions, *, gap_m: float, sides_free: bool = False
) -> Pair:
    """Build the pair; the lower face of the one and the top face of the other keep their place.

    ``sides_free``: they keep only their height, and each block one node against turning and drifting.
    """
    start = lower.height_m + gap_m
    meshes = [_block(b, z) for b, z in ((lower, 0.0), (upper, start))]
    mesh = union(*meshes)
    z = mesh.points_m[:, 2]
    above = z > 0.5 * (lower.height_m + start)
    top = np.isclose(z, start + upper.height_m, rtol=0.0, atol=1e-9)
    fixed = np.zeros((len(z), 3), dtype=bool)
    fixed[top | (z == 0.0), slice(2, 3) if sides_free else slice(None)] = True
    if sides_free:
        for end in (top, z == 0.0):
            nodes = np.flatnonzero(end)
            x, y = mesh.points_m[nodes, :2].T
            fixed[nodes[np.argmin(x**2 + y**2)], :2] = True
            fixed[nodes[np.argmax(x - 1e-3 * np.abs(y))], 1] = True
    model = SolidModel(mesh=mesh, laws={0: law, 1: law}, fixed=fixed)
    first = free_faces(mesh, lambda c: np.abs(c[..., 2] - lower.height_m) < 1e-9)
    second = free_faces(mesh, lambda c: np.abs(c[..., 2] - start) < 1e-9)
    return Pair(model=model, contact=surface_contact(mesh, first, second, contact), upper=above, top=top)


def drive(pair: Pair, path_m: F64, *, tolerance: float = 1e-6, load: Load | None = None) -> list[State]:
    """Move the top face through positions [n, 3] under a constant load; a step that fails is halved up to four times.

    Raises
    ------
    RuntimeError
        If equilibrium is not reached.
    """
    model, work, load = pair.model, workspace(pair.model), load or Load()
    options = NewtonOptions(relative_tolerance=tolerance, max_iterations=40, step_cap_m=1.0)
    u, at = np.zeros_like(model.mesh.points_m), np.zeros(3)
    contact = begin(pair.contact, u)
    rate = np.zeros_like(u)
    states: list[State] = []
    for target in path_m:
        iterations, share = 0, 1.0
        while not np.array_equal(at, target):
            aim = target if share == 1.0 else at + share * (target - at)
            way = aim - at
            guess = _guess(pair, u, way, rate)
            outcome = solve_step(work, guess, load, options, contact=contact)
            iterations += outcome.iterations
            if not outcome.converged:
                share *= 0.5
                if share < 1.0 / 16.0:
                    raise RuntimeError(f"no equilibrium at {aim} m: {outcome.status.value}")
                continue
            rate = (outcome.u_m - u) / float(np.linalg.norm(way))
            u, at, share = outcome.u_m, aim, 1.0
            contact = advance(contact, u)
        state = model.evaluate(u, load, tangent=False)
        assert state is not None
        force = state.reaction_n[pair.top].sum(axis=0)
        states.append(State(moved_m=target, force_n=force, u_m=u, iterations=iterations))
    work.close()
    return states


def _guess(pair: Pair, u_m: F64, way_m: F64, rate: F64) -> F64:
    """Go on as in the last step where that is in the same direction and free, else shear the upper block alone."""
    step = rate * float(np.linalg.norm(way_m))
    if np.allclose(step[pair.top], way_m, rtol=0.0, atol=1e-9 * float(np.linalg.norm(way_m))):
        guess = u_m + step
        if pair.contact.step_bound(u_m, guess) == 1.0:
            return guess
    z = pair.model.mesh.points_m[:, 2]
    low, high = z[pair.upper].min(), z.max()
    share = np.where(pair.upper, (z - low) / (high - low), 0.0)
    return np.asarray(u_m + share[:, None] * way_m)


def _block(block: Block, bottom_m: float) -> SolidMesh:
    half, angle = 0.5 * block.side_m, np.deg2rad(block.turned_deg)
    turn = np.array([[np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    grid = np.linspace(-half, half, block.cells + 1)
    heights = bottom_m + np.linspace(0.0, block.height_m, block.layers + 1)
    return sweep(rectangle(grid, grid), heights, lambda x: x @ turn)
