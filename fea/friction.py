"""Coulomb friction along a load path: an elastic slip that each converged step hands to the next.

Quasi-static friction has no rate. A pair of facets slips by s = T (w + e): w the relative displacement since the last
converged step, e the elastic slip left by it, T the tangent plane. Its friction is mu N f(|s| / length) against s with
the smooth f of Incremental Potential Contact (Li et al. 2020, section 5), and the part of |s| beyond the length is lost
for good: a return mapping as in elastoplasticity (Simo & Laursen 1992, Comput. Struct. 42). Without e, as in a dynamic
simulation, a body that sticks would creep by up to the length in every load step.

The normal forces N and planes T belong to the state that is reached: a step is first solved with those of the last
state and then with those of every iterate, so that at convergence nothing lags. Only the tangent and the energy that
each iteration must lower leave out how N and T change, which keeps the one symmetric and makes the other exist.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64
from fea.contact_interface import Contact, ContactState
from fea.load import Load
from fea.newton import NewtonOptions, Outcome, solve_equilibrium
from fea.surface_contact import AnySurfaces
from fea.tangential import TangentialPairs
from fea.workspace import Workspace

_FIRST_TOLERANCE = 3e-3
"""Choice: residual at which the normal forces of the last state give way to those of every iterate."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FrictionalContact:
    """Contact during one load step; immutable, so a step that fails leaves nothing behind.

    Attributes
    ----------
    surfaces : SurfaceContact or SegmentContact
    anchor_m : array [n_nodes, 3]
        Displacement from which slip counts: that of the last converged step less the elastic slip.
    pairs : TangentialPairs or None
        Frozen normal forces and tangent planes; None: those of the displacement that is evaluated.
    """

    surfaces: AnySurfaces
    anchor_m: F64
    pairs: TangentialPairs | None = None

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return forces and Hessian of normal contact and friction.

        Newton's own tangent of friction is nothing where all slides: it takes the fewest iterations (2 where each
        pair's secant takes 7), and where it leads up the energy ``project`` gives the secant instead.
        """
        pairs, slip = self._pairs(u_m), u_m - self.anchor_m
        normal = self.surfaces.evaluate(u_m, project=project)
        hessian = normal.hessian + pairs.hessian(slip, secant=project)
        return ContactState(force_n=normal.force_n + pairs.force_n(slip), hessian=sp.csr_array(hessian))

    def force_n(self, u_m: F64) -> F64:
        """Return the forces of normal contact and friction [n_nodes, 3]."""
        return self.surfaces.force_n(u_m) + self.friction_force_n(u_m)

    def energy(self, u_m: F64) -> float:
        """Return the energy [J]; with the normal forces of each displacement it has other forces than these."""
        return self.surfaces.energy(u_m) + self._pairs(u_m).energy_j(u_m - self.anchor_m)

    def held(self, u_m: F64, /) -> "FrictionalContact":
        """Return the contact with the normal forces and tangent planes of displacement u, unless it has some."""
        return replace(self, pairs=self._pairs(u_m))

    def step_bound(self, u_m: F64, trial_m: F64) -> float:
        """Return the collision-free fraction of the way."""
        return self.surfaces.step_bound(u_m, trial_m)

    def friction_force_n(self, u_m: F64) -> F64:
        """Return friction's part of the forces [n_nodes, 3]."""
        return self._pairs(u_m).force_n(u_m - self.anchor_m)

    def following(self, u_m: F64, /) -> "FrictionalContact":
        """Return the contact of the next step after converging at u."""
        anchor = u_m - self.elastic_slip_m(u_m)
        return replace(self, surfaces=self.surfaces.following(u_m), anchor_m=anchor, pairs=None)

    def elastic_slip_m(self, u_m: F64) -> F64:
        """Return the slip that stays elastic [n_nodes, 3]: half on each side, opposite, no longer than the length.

        Pairs come and go, nodes stay: a node keeps the average over its pairs.
        """
        slip = self.surfaces.friction_pairs(u_m).mean_slip_m(u_m - self.anchor_m)
        size = np.linalg.norm(slip, axis=1, keepdims=True)
        return np.asarray(
            0.5 * slip * np.minimum(1.0, self.surfaces.options.friction_slip_m / np.maximum(size, 1e-300))
        )

    def _pairs(self, u_m: F64) -> TangentialPairs:
        return self.surfaces.friction_pairs(u_m) if self.pairs is None else self.pairs


def accumulated_slip_m(surfaces: AnySurfaces, states_m: Sequence[F64]) -> F64:
    """Return how far each node of the first surface slid along the other one while they touched [n_first].

    ``states_m`` are the converged displacements of a path in order, the unloaded one first. Works without friction too.
    """
    total = np.zeros(len(surfaces.first_nodes))
    for before, after in pairwise(states_m):
        slip = surfaces.friction_pairs(after, coefficient=1.0).mean_slip_m(after - before)
        total += np.linalg.norm(slip[surfaces.first_nodes], axis=1)
    return total


@dataclass(frozen=True, kw_only=True, eq=False)
class Together:
    """Several contacts at once; friction is a matter of each of them."""

    parts: tuple[Contact, ...]

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return the sums of forces and Hessians."""
        states = [part.evaluate(u_m, project=project) for part in self.parts]
        hessian = sp.csr_array((u_m.size, u_m.size))
        for state in states:
            hessian = hessian + state.hessian
        return ContactState(force_n=np.sum([s.force_n for s in states], axis=0), hessian=sp.csr_array(hessian))

    def force_n(self, u_m: F64) -> F64:
        """Return the sum [n_nodes, 3]."""
        return np.asarray(np.sum([part.force_n(u_m) for part in self.parts], axis=0))

    def energy(self, u_m: F64) -> float:
        """Return the sum [J]."""
        return float(sum(part.energy(u_m) for part in self.parts))

    def held(self, u_m: F64, /) -> "Together":
        """Return the contacts held."""
        return Together(parts=tuple(part.held(u_m) for part in self.parts))

    def following(self, u_m: F64, /) -> "Together":
        """Return the contacts of the next step."""
        return Together(parts=tuple(part.following(u_m) for part in self.parts))

    def step_bound(self, u_m: F64, trial_m: F64) -> float:
        """Return the smallest fraction."""
        return min(part.step_bound(u_m, trial_m) for part in self.parts)


def begin(contact: Contact | None, u_m: F64) -> Contact | None:
    """Return the contact of the first step from u; the same object where there is no friction."""
    if isinstance(contact, Together):
        parts = [begin(part, u_m) for part in contact.parts]
        return Together(parts=tuple(part for part in parts if part is not None))
    if isinstance(contact, AnySurfaces) and contact.options.friction > 0.0:
        return FrictionalContact(surfaces=contact, anchor_m=u_m)
    return contact


def advance(contact: Contact | None, u_m: F64) -> Contact | None:
    """Return the contact of the next step after converging at u, if there is one."""
    return None if contact is None else contact.following(u_m)


def _has_friction(contact: Contact | None) -> bool:
    parts = contact.parts if isinstance(contact, Together) else (contact,)
    return any(isinstance(part, FrictionalContact) for part in parts)


def solve_step(
    work: Workspace,
    u_m: F64,
    load: Load,
    options: NewtonOptions,
    *,
    balanced: Load | None = None,
    contact: Contact | None = None,
    on_iteration: Callable[[int, float], None] = lambda *_: None,
) -> Outcome:
    """Solve one load step as :func:`fea.newton.solve_equilibrium` does; with friction in two stages."""
    if not _has_friction(contact):
        return solve_equilibrium(
            work, u_m, load, options, balanced=balanced, contact=contact, on_iteration=on_iteration
        )
    assert contact is not None
    held = contact.held(u_m)
    rough = replace(options, relative_tolerance=max(_FIRST_TOLERANCE, options.relative_tolerance))
    first = solve_equilibrium(work, u_m, load, rough, balanced=balanced, contact=held, on_iteration=on_iteration)
    if not first.converged:
        return first
    second = solve_equilibrium(work, first.u_m, load, options, contact=contact, on_iteration=on_iteration)
    return replace(second, iterations=first.iterations + second.iterations, cost=first.cost + second.cost)
