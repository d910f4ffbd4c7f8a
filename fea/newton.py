"""Newton's method with a step cap and an optional contact. Failure is a value, not an exception.

No energy line search: near-inextensible rings make the linear step stretch them at large rotation, and a search on the
energy then cripples the method.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64
from fea.assembly import Evaluation, Load, SolidModel
from fea.cost import NO_COST, Cost, Stopwatch
from fea.linear_solver import SymmetricSolver

_EXACT_BELOW = 3e-3
"""Choice: relative residual below which contact gives its exact Hessian. Projected throughout, the finger's step from
65 to 65.8 kPa lost 40 % of its residual an iteration and was not done after 18; exact near the end it took 9."""
BOUND_SHARE = 0.8
"""Choice: share of the collision-free way that a step uses, so that gaps stay open for the next one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactState:
    """Contact forces at a displacement.

    Attributes
    ----------
    force_n : array [n_nodes, 3]
        Forces of the contact on the nodes (minus the gradient of its energy).
    hessian : csr_array [3 n_nodes, 3 n_nodes]
        Hessian of its energy [N/m], upper triangle.
    """

    force_n: F64
    hessian: sp.csr_array


class Contact(Protocol):
    """What Newton's method needs of a contact."""

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return forces and Hessian at displacements [n_nodes, 3]; ``project`` makes it positive semi-definite."""
        ...

    def step_bound(self, u_m: F64, trial_m: F64) -> float:
        """Return the fraction in [0, 1] of the straight way from u to the trial on which nothing touches."""
        ...


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
        Convergence when |internal - external| <= tolerance x the largest of their norms and the reactions'.
    step_cap_m : float
        Largest nodal displacement of one iteration.
    max_iterations : int
        Iterations of one load step.
    min_step : float
        Smallest fraction of a requested load step before giving up.
    largest_step : float
        Load steps start with this size and never exceed it (in the load's parameter).
    """

    relative_tolerance: float = 1e-6
    step_cap_m: float = 4e-3
    max_iterations: int = 16
    min_step: float = 1.0 / 64.0
    largest_step: float = np.inf

    def __post_init__(self) -> None:
        for name in ("relative_tolerance", "step_cap_m", "max_iterations", "min_step", "largest_step"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} = {getattr(self, name)} must be positive")


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
    model: SolidModel,
    u_m: F64,
    load: Load,
    options: NewtonOptions,
    solver: SymmetricSolver,
    *,
    contact: Contact | None = None,
    on_iteration: Callable[[int, float], None] = lambda *_: None,
) -> Outcome:
    """Iterate from ``u_m`` (which satisfies the supports and touches nothing) to equilibrium under ``load``."""
    watch = Stopwatch()
    outcome = _Iteration(model, load, options, solver, contact, watch).run(u_m, on_iteration)
    return replace(outcome, cost=watch.cost(outcome.iterations))


@dataclass(frozen=True)
class _Iteration:
    """One Newton solve: its parts are named here once."""

    model: SolidModel
    load: Load
    options: NewtonOptions
    solver: SymmetricSolver
    contact: Contact | None
    watch: Stopwatch

    def run(self, u_m: F64, on_iteration: Callable[[int, float], None]) -> Outcome:
        u, options = u_m.copy(), self.options
        state = self._evaluate(u)
        relative = np.inf
        for iteration in range(options.max_iterations + 1):
            if state is None or state.tangent is None:
                return Outcome(status=Status.INVERTED, u_m=u, iterations=iteration, residual=relative)
            imbalance, tangent = self._system(u, state, state.tangent, project=relative > _EXACT_BELOW)
            forces = (state.external_n, state.internal_n, state.reaction_n)
            scale = max(1e-12, *(float(np.linalg.norm(force)) for force in forces))
            relative = float(np.linalg.norm(imbalance)) / scale
            on_iteration(iteration, relative)
            if relative <= options.relative_tolerance:
                return Outcome(status=Status.CONVERGED, u_m=u, iterations=iteration, residual=relative)
            if iteration == options.max_iterations:
                break
            with self.watch.time("solve"):
                step = self.solver.solve(tangent, imbalance)
            if step is None:
                return Outcome(status=Status.SINGULAR, u_m=u, iterations=iteration, residual=relative)
            u, state = self._advance(u, self._bounded(u, step))
        return Outcome(status=Status.STALLED, u_m=u, iterations=options.max_iterations, residual=relative)

    def _evaluate(self, u: F64) -> Evaluation | None:
        with self.watch.time("assembly"):
            return self.model.evaluate(u, self.load)

    def _system(self, u: F64, state: Evaluation, tangent: sp.csr_array, *, project: bool) -> tuple[F64, sp.csr_array]:
        """Return out-of-balance force and tangent at the free degrees of freedom, contact included."""
        imbalance = state.external_n - state.internal_n
        if self.contact is None:
            return imbalance, tangent
        free = self.model.free
        with self.watch.time("contact"):
            touch = self.contact.evaluate(u, project=project)
            imbalance = imbalance + touch.force_n.ravel()[free]
            return imbalance, sp.csr_array(tangent + touch.hessian[free][:, free])

    def _bounded(self, u: F64, step: F64) -> F64:
        """Return the step cut to the cap and to the way on which nothing touches."""
        step = step * min(1.0, self.options.step_cap_m / max(float(np.abs(step).max()), 1e-30))
        if self.contact is None:
            return step
        with self.watch.time("contact"):
            bound = self.contact.step_bound(u, self._moved(u, step))
        return step if bound >= 1.0 else BOUND_SHARE * bound * step

    def _advance(self, u: F64, step: F64) -> tuple[F64, Evaluation | None]:
        """Take the step, halved while it would invert an element."""
        for _ in range(6):
            trial = self._moved(u, step)
            state = self._evaluate(trial)
            if state is not None:
                return trial, state
            step = 0.5 * step
        return u, None

    def _moved(self, u: F64, step: F64) -> F64:
        moved = u.copy()
        moved.reshape(-1)[self.model.free] += step
        return moved
