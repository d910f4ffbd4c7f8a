"""Newton's method for large rotations, follower pressure and contact. Failure is a value, not an exception.

Four things make it converge where stiff rings turn far in one step (figures in docs/decisions.md):

- the linear step is applied through :class:`fea.retraction.Retraction`, which turns stiff parts and does not
  stretch them;
- the tangent belongs to the load that the stresses balance. The stiffness of a follower pressure that the walls do not
  carry yet is that of a strut about to buckle, so the load moves on with the step that brings the stresses there;
- while it moves on, a step is taken in the share that leaves less than the load out of balance;
- then a search on the energy keeps steps from going deep into a contact.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import Enum
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64
from fea.assembly import Evaluation
from fea.contact_interface import Contact, ContactState
from fea.cost import NO_COST, Cost, Stopwatch
from fea.load import Load
from fea.workspace import Workspace

_SUFFICIENT_DECREASE = 1e-4
"""Armijo's constant (Nocedal & Wright, Numerical Optimization, ch. 3)."""
_ROUNDING = 1e-12
"""Choice: share of the energy by which rounding may hide a decrease."""
_SEARCH_HALVINGS = 10
_OVERSHOT = 1.0
"""Choice: relative imbalance beyond which a step has run into a contact. Steps that go well leave less than 0.7 on the
finger; after those that left 1.7 to 30 Newton's method failed or took many small steps back."""
HOPELESS = 0.3
"""Choice: of the finger's load steps one was seen to converge that still had this residual after 8 iterations."""
_WHOLE = 1.0 - 1e-9
_SMALLEST_FORCE_N = 1e-9
"""Choice: where no force acts, residuals are measured against this."""
_FOUNDATION_SHARES = (0.0, 1e-2, 1e-1, 1.0, 10.0)
BOUND_SHARE = 0.8
"""Choice: share of the collision-free way that a step uses, so that gaps stay open for the next one."""


class Status(Enum):
    """How a solve ended."""

    CONVERGED = "converged"
    STALLED = "stalled"
    INVERTED = "inverted"
    SINGULAR = "singular"
    LIMIT_POINT = "limit point"


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """Settings of the nonlinear solve.

    Attributes
    ----------
    relative_tolerance : float
        Convergence when |internal - external| <= tolerance x the largest of their norms and the reactions', now or at
        the start of the solve.
    step_cap_m : float
        Largest nodal displacement of one iteration.
    max_iterations, patience : int
        Iterations of one load step, and those after which a residual above ``HOPELESS`` ends it.
    min_step : float
        Smallest step before giving up, as a fraction of the way between two targets or the largest step.
    first_step, largest_step : float
        Size of the first load step and the size that none exceeds (in the load's parameter).
    """

    relative_tolerance: float = 1e-6
    step_cap_m: float = 30e-3
    max_iterations: int = 16
    patience: int = 100
    min_step: float = 1.0 / 64.0
    first_step: float = np.inf
    largest_step: float = np.inf

    def __post_init__(self) -> None:
        for item in fields(self):
            if not getattr(self, item.name) > 0:
                raise ValueError(f"{item.name} = {getattr(self, item.name)} must be positive")


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcome:
    """Result of one load step: the displacement [n_nodes, 3] (last accepted one on failure)."""

    status: Status
    u_m: F64
    iterations: int
    residual: float
    cost: Cost = NO_COST

    @property
    def converged(self) -> bool:
        """Whether equilibrium was reached."""
        return self.status is Status.CONVERGED


def solve_equilibrium(
    work: Workspace,
    u_m: F64,
    load: Load,
    options: NewtonOptions,
    *,
    balanced: Load | None = None,
    contact: Contact | None = None,
    on_iteration: Callable[[int, float], None] = lambda *_: None,
) -> Outcome:
    """Iterate from ``u_m`` (which satisfies the supports and touches nothing) to equilibrium under ``load``.

    ``balanced`` is the load that ``u_m`` is in equilibrium with; without it, it is taken to be ``load``.
    """
    watch = Stopwatch()
    solve = _Solve(work, load, options, contact, watch)
    outcome = solve.run(u_m, balanced or load, on_iteration)
    return replace(outcome, cost=watch.cost(outcome.iterations))


class _Move(NamedTuple):
    """A step taken: displacement [n_nodes, 3], share of the step, and the body's energy there if it was looked at."""

    u_m: F64
    share: float
    energy_j: float | None


@dataclass(frozen=True)
class _Solve:
    """One equilibrium: its parts are named here once."""

    work: Workspace
    load: Load
    options: NewtonOptions
    contact: Contact | None
    watch: Stopwatch

    def run(self, u_m: F64, balanced: Load, on_iteration: Callable[[int, float], None]) -> Outcome:
        u, options, carried, start = u_m.copy(), self.options, balanced, 0.0
        energy: float | None = None
        for iteration in range(options.max_iterations + 1):
            with self.watch.time("assembly"):
                state = self.work.model.evaluate(u, carried)
            if state is None or state.tangent is None:
                return Outcome(status=Status.INVERTED, u_m=u, iterations=iteration, residual=np.inf)
            held = self if self.contact is None else replace(self, contact=self.contact.held(u))
            imbalance, tangent = held._system(u, state, state.tangent, settled=carried is self.load)
            # a step that ends without load is measured against the forces that it started with
            start = start or _scale(state)
            relative = float(np.linalg.norm(imbalance)) / max(start, _scale(state))
            on_iteration(iteration, relative)
            if relative <= options.relative_tolerance and carried is self.load:
                return Outcome(status=Status.CONVERGED, u_m=u, iterations=iteration, residual=relative)
            if iteration == options.max_iterations or (iteration >= options.patience and relative > HOPELESS):
                break
            step = held._direction(u, state, tangent, imbalance)
            if step is None:
                return Outcome(status=Status.SINGULAR, u_m=u, iterations=iteration, residual=relative)
            moved = held._advance(u, step, float(step @ imbalance), carried, energy)
            if moved is None:
                return Outcome(status=Status.STALLED, u_m=u, iterations=iteration + 1, residual=relative)
            u, energy = moved.u_m, moved.energy_j
            if carried is not self.load:
                carried = self.load if moved.share > _WHOLE else carried.towards(self.load, moved.share)
        return Outcome(status=Status.STALLED, u_m=u, iterations=iteration, residual=relative)

    def _system(self, u: F64, state: Evaluation, tangent: sp.csr_array, *, settled: bool) -> tuple[F64, sp.csr_array]:
        """Return the imbalance under the whole load and the tangent at the load carried, at the free freedoms."""
        model = self.work.model
        wanted = state.external_n if settled else model.external(u, self.load).ravel()[model.free]
        imbalance = wanted - state.internal_n
        if self.contact is None:
            return imbalance, tangent
        with self.watch.time("contact"):
            touch = self.contact.evaluate(u, project=False)
        return imbalance + touch.force_n.ravel()[model.free], self._with_contact(tangent, touch)

    def _with_contact(self, tangent: sp.csr_array, touch: ContactState) -> sp.csr_array:
        with self.watch.time("contact"):
            return self.work.with_contact(tangent, touch.hessian)

    def _direction(self, u: F64, state: Evaluation, tangent: sp.csr_array, imbalance: F64) -> F64 | None:
        """Return a step down the energy: Newton's, else with the contact's Hessian projected, else on a foundation."""
        step = self._solved(tangent, state.rank_one, imbalance)
        if step is not None and step @ imbalance > 0.0:
            return step
        if self.contact is not None and state.tangent is not None:
            with self.watch.time("contact"):
                touch = self.contact.evaluate(u, project=True)
            tangent = self._with_contact(state.tangent, touch)
        for share in _FOUNDATION_SHARES:
            shifted = tangent if share == 0.0 else _on_diagonal(tangent, share * self.work.foundation_n_per_m)
            step = self._solved(shifted, state.rank_one, imbalance)
            if step is not None and step @ imbalance > 0.0:
                return step
        return None

    def _solved(self, tangent: sp.csr_array, rank_one: F64 | None, imbalance: F64) -> F64 | None:
        """Solve with the tangent and its rank-one part (Sherman & Morrison, 1950, Ann. Math. Stat. 21)."""
        with self.watch.time("solve"):
            if rank_one is None:
                return self.work.solver.solve(tangent, imbalance)
            both = self.work.solver.solve(tangent, np.column_stack([imbalance, rank_one]))
        if both is None:
            return None
        plain, correction = both.T
        return np.asarray(plain - correction * float(rank_one @ plain) / (1.0 + float(rank_one @ correction)))

    def _advance(self, u: F64, step: F64, slope: float, carried: Load, energy: float | None) -> _Move | None:
        """Return the state after the step, or None where no share of it will do; ``energy`` as in :class:`_Move`.

        The share keeps the cap, what is free of collisions and elements upright. While the load is still being taken up
        it also keeps the forces near balance, and then the energy falling.
        """
        nodal = np.zeros_like(u)
        nodal.reshape(-1)[self.work.model.free] = step
        share = min(1.0, self.options.step_cap_m / max(float(np.abs(nodal).max()), 1e-30))
        settled, before, after = carried is self.load, 0.0, None
        if settled:
            before = (self._body_energy(u) if energy is None else energy) + self._contact_energy(u)
        for attempt in range(_SEARCH_HALVINGS):
            trial = u + self.work.retraction(u, share * nodal)
            if self.contact is not None and attempt == 0:
                with self.watch.time("contact"):
                    bound = self.contact.step_bound(u, trial)
                if bound < 1.0:
                    share *= BOUND_SHARE * bound
                    trial = u + self.work.retraction(u, share * nodal)
            if settled:
                after = self._body_energy(trial)
                allowed = before - _SUFFICIENT_DECREASE * share * slope + _ROUNDING * abs(before)
                good = after < np.inf and after + self._contact_energy(trial) <= allowed
            else:
                good = self._imbalance(trial, carried.towards(self.load, share)) < _OVERSHOT
            if good:
                return _Move(trial, share, after)
            share *= 0.5
        return None

    def _imbalance(self, u: F64, load: Load) -> float:
        """Return the relative imbalance under a load, infinite where an element is inverted."""
        with self.watch.time("assembly"):
            state = self.work.model.evaluate(u, load, tangent=False)
        if state is None:
            return np.inf
        imbalance = state.external_n - state.internal_n
        if self.contact is not None:
            with self.watch.time("contact"):
                imbalance = imbalance + self.contact.force_n(u).ravel()[self.work.model.free]
        return float(np.linalg.norm(imbalance)) / _scale(state)

    def _body_energy(self, u: F64) -> float:
        """Return the potential without the contact's [J], infinite where an element is inverted."""
        with self.watch.time("assembly"):
            energy = self.work.model.energy(u, self.load)
        return np.inf if energy is None else energy

    def _contact_energy(self, u: F64) -> float:
        if self.contact is None:
            return 0.0
        with self.watch.time("contact"):
            return self.contact.energy(u)


def _scale(state: Evaluation) -> float:
    forces = (state.external_n, state.internal_n, state.reaction_n)
    return max(_SMALLEST_FORCE_N, *(float(np.linalg.norm(force)) for force in forces))


def _on_diagonal(upper: sp.csr_array, values: F64) -> sp.csr_array:
    """Return the upper triangle with values added to its diagonal, on the same pattern."""
    shifted = upper.copy()
    # the first stored entry of each row of an upper triangle with a full diagonal is the diagonal
    shifted.data[upper.indptr[:-1]] += values
    return shifted
