"""Patch tests of interfaces: two blocks under uniform pressure, bonded or in contact.

Bonded (shared nodes), two Young's moduli and no lateral contraction: u_z is linear in each block and the stress
uniform, which the elements reproduce to rounding.

In contact, with faces that do not match: integrated over segments the stress is uniform to rounding in every element.
The barrier's forces on facets are an approximate integral of the pressure, so the stress next to the interface is not,
as in any node-to-segment method (Taylor & Papadopoulos 1991); how uniform it is, is measured. Balance holds with both:
the force that one end feels reaches the other end, and so does its moment, with the barrier up to the noise on its own
positions (0.1 um of arm).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fea.arrays import F64
from fea.assembly import SolidModel, deformation
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, straight_sided, sweep
from fea.newton import NewtonOptions, solve_equilibrium
from fea.verification.common import Row
from fea.verification.contact_blocks import Block, block_pair, drive, settings
from fea.workspace import workspace

YOUNG_PA, SIDE_M, HEIGHT_M, ACTIVATION_M = 1e6, 2e-3, 1e-3, 2e-5
_STIFFNESS_PA = {"segments": 2e4, "barrier": 2e5}
"""Choice: the gap closes to about a fifth of the activation distance."""


def bonded_patch(rng: np.random.Generator, *, cells: int = 3) -> float:
    """Return the largest error of u, over the largest u, of two bonded blocks, the upper one five times as stiff.

    The vertices of the interface are moved at random within it, those inside the blocks in all directions.
    """
    grid, heights = np.linspace(0.0, 1.0, cells + 1), np.linspace(0.0, 2.0, 2 * cells + 1)
    mesh = sweep(rectangle(grid, grid), heights)
    vertices = mesh.points_m[: int(mesh.elements[:, :4].max()) + 1].copy()
    move = 0.2 / cells * rng.uniform(-1.0, 1.0, vertices.shape)
    for axis, free in enumerate((1.0, 1.0, 2.0)):
        held = np.isclose(vertices[:, axis], 0.0) | np.isclose(vertices[:, axis], free)
        if axis == 2:
            held |= np.isclose(vertices[:, axis], 1.0)
        move[held, axis] = 0.0
    mesh = straight_sided(mesh, vertices + move)
    mesh.material[:] = mesh.cylindrical[mesh.elements[:, :4], 2].mean(axis=1) > 1.0
    z = mesh.points_m[:, 2]
    fixed = np.zeros((len(z), 3), dtype=bool)
    fixed[np.isclose(z, 0.0) | np.isclose(z, 2.0), 2] = True
    for axis in (0, 1):
        fixed[np.isclose(mesh.points_m[:, axis], 0.0), axis] = True
    soft, stiff = (StVenantKirchhoff(young_modulus_pa=e * YOUNG_PA, poisson_ratio=0.0) for e in (1.0, 5.0))
    lower, upper = _stretches(-0.1, 5.0)
    exact = np.zeros_like(mesh.points_m)
    exact[:, 2] = (lower - 1.0) * np.minimum(z, 1.0) + (upper - 1.0) * np.maximum(z - 1.0, 0.0)
    start = np.where(fixed, exact, exact + 1e-3 * rng.standard_normal(exact.shape))
    model = SolidModel(mesh=mesh, laws={0: soft, 1: stiff}, fixed=fixed)
    options = NewtonOptions(relative_tolerance=1e-11, step_cap_m=1.0, max_iterations=30)
    outcome = solve_equilibrium(workspace(model), start, Load(), options)
    if not outcome.converged:
        raise RuntimeError(f"bonded patch: no equilibrium, {outcome.status.value}")
    return float(np.abs(outcome.u_m - exact).max() / np.abs(exact).max())


@dataclass(frozen=True, kw_only=True)
class ContactPatch:
    """Errors of the contact patch, all relative.

    Attributes
    ----------
    balance, moment_balance : float
        Largest difference of the forces, and of the moments over force x side, of the two ends and of the contact.
    spread_end, spread_interface : float
        Standard deviation of the axial stress over its mean, in the elements next to the ends and to the interface.
    worst : float
        Largest deviation of a component of the stress from uniaxial, over the mean axial one, at any integration point.
    dofs : int
    """

    balance: float
    moment_balance: float
    spread_end: float
    spread_interface: float
    worst: float
    dofs: int


def contact_patch(cells: tuple[int, int] = (3, 4), *, contact: str = "segments") -> ContactPatch:
    """Press two blocks of equal section, grids of ``cells`` a side, by 1 % of their height."""
    law = StVenantKirchhoff(young_modulus_pa=YOUNG_PA, poisson_ratio=0.0)
    blocks = [Block(side_m=SIDE_M, height_m=HEIGHT_M, cells=n, layers=3) for n in cells]
    options = settings(contact, distance_m=ACTIVATION_M, stiffness_pa=_STIFFNESS_PA[contact])
    gap = 1.1 * ACTIVATION_M
    pair = block_pair(blocks[0], blocks[1], law, options, gap_m=gap, sides_free=True)
    deep = 0.02 * HEIGHT_M + gap
    way = np.array([[0.0, 0.0, -s * deep] for s in (0.3, 0.6, 1.0)])
    u = drive(pair, way, tolerance=1e-11)[-1].u_m
    model, mesh = pair.model, pair.model.mesh
    state = model.evaluate(u, Load(), tangent=False)
    assert state is not None
    x, push = mesh.points_m + u, pair.contact.force_n(u)
    bottom = mesh.points_m[:, 2] == 0.0
    wrenches = np.array(
        [
            _wrench(x, np.where(bottom[:, None], state.reaction_n, 0.0)),
            _wrench(x, np.where(pair.upper[:, None], push, 0.0)),
            -_wrench(x, np.where(pair.upper[:, None], 0.0, push)),
            -_wrench(x, np.where(pair.top[:, None], state.reaction_n, 0.0)),
        ]
    )
    force = float(wrenches[0, 2])
    apart = np.ptp(wrenches, axis=0) / force
    F = deformation(u[mesh.elements], model.gradients)
    P = law.stress_and_tangent(F)[0]
    stress = (P[..., 2, 2] * model.weights).sum(axis=1) / model.weights.sum(axis=1)
    centre = mesh.points_m[mesh.elements[:, :4], 2].mean(axis=1)
    height = np.where(centre > HEIGHT_M, centre - gap - HEIGHT_M, HEIGHT_M - centre) / HEIGHT_M  # from the interface
    mean = abs(float(stress.mean()))
    uniaxial = np.zeros((3, 3))
    uniaxial[2, 2] = stress.mean()
    return ContactPatch(
        balance=float(apart[:3].max()),
        moment_balance=float(apart[3:].max()) / SIDE_M,
        spread_end=float(stress[height > 2.0 / 3.0].std()) / mean,
        spread_interface=float(stress[height < 1.0 / 3.0].std()) / mean,
        worst=float(np.abs(P - uniaxial).max()) / mean,
        dofs=len(model.free),
    )


def patch_rows() -> list[Row]:
    """Return the evenness of the stress that the barrier transmits, for facets that match and that do not."""
    rows = []
    for cells in ((4, 4), (3, 4), (5, 7)):
        found = contact_patch(cells, contact="barrier")
        rows += [
            Row(
                problem=f"contact patch, barrier, {cells[0]} on {cells[1]} cells a side",
                formulation="P2/P0",
                dofs=found.dofs,
                quantity=f"1 + rms deviation of the axial stress, {where}",
                figure=1.0 + spread,
                exact=1.0,
            )
            for where, spread in (("interface", found.spread_interface), ("ends", found.spread_end))
        ]
    return rows


def _wrench(x_m: F64, force_n: F64) -> F64:
    """Return resultant and moment about the origin of nodal forces, array [6]."""
    return np.concatenate([force_n.sum(axis=0), np.cross(x_m, force_n).sum(axis=0)])


def _stretches(total: float, ratio: float) -> tuple[float, float]:
    """Stretches of two blocks of height 1 in series, shortened by ``total``: equal E (l^3 - l) / 2."""

    def excess(e: float) -> float:
        lower, upper = 1.0 + e, 1.0 + total - e
        return (lower**3 - lower) - ratio * (upper**3 - upper)

    found = float(brentq(excess, total, 0.0))
    return 1.0 + found, 1.0 + total - found
