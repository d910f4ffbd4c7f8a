"""Contact: coarse and faceted, without a gap, opening, without friction and with a coefficient of 2."""

import importlib.util

import numpy as np

from fea.lattice import free_faces
from fea.load import Load
from fea.meshes import surface_force
from fea.rubber import neo_hookean
from fea.stability.case import SolidCase, SolidFinding, judged
from fea.verification.contact_blocks import Block, block_pair, drive, settings
from fea.verification.contact_patch import contact_patch
from fea.verification.contact_sliding import sliding_loop

SHEAR_PA, BULK_PA = 3.3e5, 1e6
TOUCHING_M = 1e-9
"""Choice: a nanometre; at exactly none, nodes that coincide are one, and nothing is left to touch."""


def coarse_facets() -> SolidFinding:
    """Grids of two on three cells a side, nothing matches: uniform pressure must pass to rounding."""
    found = contact_patch((2, 3))
    return judged("largest deviation of stress from uniform, relative, <= 1e-9", max(found.worst, found.balance), 1e-9)


def coarse_barrier() -> SolidFinding:
    """Run: the same with the barrier on flat facets: force and moment pass, the stress is uniform to some per cent."""
    if importlib.util.find_spec("ipctk") is None:
        return judged("balance", 0.0, 1.0, typed="NOT INSTALLED: ipctk")
    try:
        found = contact_patch((3, 4), contact="barrier")
    except RuntimeError as error:
        return judged("balance", 1.0, 0.0, typed=f"NO EQUILIBRIUM: {error}")
    return judged("imbalance of force between the ends, relative, <= 1e-6", found.balance, 1e-6)


def _without_gap(contact: str) -> SolidFinding:
    options = settings(contact, distance_m=0.05e-3, stiffness_pa=1e6)
    try:
        block_pair(*_blocks(), neo_hookean(SHEAR_PA, BULK_PA), options, gap_m=TOUCHING_M)
    except ValueError as error:
        return judged("refused", 0.0, 1.0, typed=f"REFUSED: {error}")
    return judged("refused", 1.0, 0.0)


def zero_gap() -> SolidFinding:
    """Blocks that touch at rest: the layer that pushes would push before any load, refused by name."""
    return _without_gap("segments")


def barrier_without_gap() -> SolidFinding:
    """Run: the barrier's energy is infinite without a gap: refused by name."""
    if importlib.util.find_spec("ipctk") is None:
        return judged("refused", 0.0, 1.0, typed="NOT INSTALLED: ipctk")
    return _without_gap("barrier")


def opening() -> SolidFinding:
    """Pressed, then pulled apart under a side load of the lower block: it never pulls, and lets go."""
    options = settings("segments", distance_m=0.1e-3, stiffness_pa=1e6, friction=0.3)
    pair = block_pair(*_blocks(), neo_hookean(SHEAR_PA, BULK_PA), options, gap_m=0.12e-3)
    face = free_faces(pair.model.mesh, lambda c: np.abs(c[..., 2] - 0.5e-3) < 1e-9)
    load = Load(force_n=surface_force(pair.model.mesh, face, np.array([1e3, 0.0, 0.0])))
    heights = 1e-3 * np.array([-0.04, -0.07, -0.03, 0.1])
    states = drive(pair, np.column_stack([0.0 * heights, 0.0 * heights, heights]), tolerance=1e-8, load=load)
    normal = np.array([-s.force_n[2] for s in states])
    pull = max(0.0, -float(normal.min())) + abs(float(normal[-1]))
    return judged("pull, and what is left when apart, share of the push, <= 1e-6", pull / float(normal[1]), 1e-6)


def without_friction() -> SolidFinding:
    """Run: a block pushed sideways over unequal grids without friction: nothing may hold it."""
    loop = sliding_loop(0.0, cells=3, steps=4)
    there, back = loop.sliding
    return judged(
        "tangential over normal force, half the difference of both ways, <= 0.005", abs(0.5 * (there - back)), 5e-3
    )


def much_friction() -> SolidFinding:
    """Run: a coefficient of 2: more sideways than down."""
    options = settings("segments", distance_m=0.05e-3, stiffness_pa=1e7, friction=2.0)
    pair = block_pair(*_blocks(), neo_hookean(SHEAR_PA, BULK_PA), options, gap_m=0.06e-3)
    path = 1e-3 * np.array([[0.0, 0.0, -0.03], [0.02, 0.0, -0.03], [0.1, 0.0, -0.03], [0.0, 0.0, -0.03]])
    try:
        force = np.array([state.force_n for state in drive(pair, path, tolerance=1e-6)])
    except RuntimeError as error:
        return judged("tangential over normal force", 1.0, 0.0, typed=f"NO EQUILIBRIUM: {error}")
    # a block that is pushed twice as hard sideways as down leans and may stick at its heel: never more than the law
    most = float(np.abs(force[:, 0] / force[:, 2]).max())
    return judged("largest tangential over normal force, over 2, <= 1.01", most / 2.0, 1.01)


def _blocks() -> tuple[Block, Block]:
    return (
        Block(side_m=4e-3, height_m=0.5e-3, cells=3, layers=1),
        Block(side_m=2e-3, height_m=0.5e-3, cells=2, layers=1, turned_deg=17.0),
    )


KINDS = {
    name: SolidCase(name=name, hard=hard, stability="converges, or says why not", correctness=right, run=run)
    for name, hard, right, run in (
        ("coarse faceted contact", "grids of two on three cells", "uniform stress", coarse_facets),
        ("coarse barrier contact", "flat facets, grids of three on four cells", "balance", coarse_barrier),
        ("zero gap", "surfaces touch at rest, to a nanometre", "refused by name", zero_gap),
        ("zero gap with the barrier", "its energy is infinite there", "refused by name", barrier_without_gap),
        ("opening contact", "pressed, pulled apart, side load", "never pulls", opening),
        ("friction of 0", "nothing but the mesh holds it", "no force sideways", without_friction),
        ("friction of 2", "twice as much sideways as down", "never more than Coulomb", much_friction),
    )
}
