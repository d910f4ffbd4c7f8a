"""Newton's method with a step cap and adaptive load steps. Failure is a value, not an exception.

No energy line search: near-inextensible rings make the linear step stretch them at large rotation, and a search on the
energy then cripples the method.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64
from fea.assembly import Load, SolidModel
from fea.cost import NO_COST, Cost, Stopwatch
from fea.linear_solver import SymmetricSolver

_GROWTH = 1.15
"""Choice: growth of a load step that worked after one that failed; doubling failed again every second time."""
_BOUND_SHARE = 0.8
"""Choice: share of the collision-free way that a step uses, so that gaps stay open for the next one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactState:
    """Contact forces at a displacement.

    Attributes
    ----------
    force_n : array [n_nodes, 3]
        Forces of the contact on the nodes (minus the gradient of its energy).
    hessian : csr_array [3 n_nodes, 3 n_nodes]
        Positive semi-definite Hessian of its energy [N/m], upper triangle.
    """

    force_n: F64
    hessian: sp.csr_array


class Contact(Protocol):
    """What Newton's method needs of a contact."""

    def evaluate(self, u_m: F64) -> ContactState:
        """Return forces and Hessian at displacements [n_nodes, 3]."""
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Step:
    """A converged load step: parameter, displacement [n_nodes, 3], its own iterations and residual, cost so far."""

    parameter: float
    u_m: F64
    iterations: int
    residual: float
    cost: Cost


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """What a load path reports while it runs, and the steps of a broken run that it goes on from.

    Attributes
    ----------
    on_iteration : callable
        Gets the parameter aimed at, the iteration and the relative residual.
    on_step : callable
        Gets every newly converged step.
    resume : sequence of Step
        Converged steps of an earlier run of the same path, in order.
    """

    on_iteration: Callable[[float, int, float], None] = lambda *_: None
    on_step: Callable[[Step], None] = lambda *_: None
    resume: Sequence[Step] = ()


def solve_equilibrium(
    model: SolidModel,
    u_m: F64,
    load: Load,
    options: NewtonOptions,
    solver: SymmetricSolver,
    contact: Contact | None = None,
    on_iteration: Callable[[int, float], None] = lambda *_: None,
) -> Outcome:
    """Iterate from ``u_m`` (which satisfies the supports and touches nothing) to equilibrium under ``load``."""
    watch = Stopwatch()
    u = u_m.copy()
    with watch.time("assembly"):
        state = model.evaluate(u, load)
    relative = np.inf
    for iteration in range(options.max_iterations + 1):
        if state is None or state.tangent is None:
            return Outcome(
                status=Status.INVERTED, u_m=u, iterations=iteration, residual=relative, cost=watch.cost(iteration)
            )
        imbalance, tangent = state.external_n - state.internal_n, state.tangent
        if contact is not None:
            with watch.time("contact"):
                touch = contact.evaluate(u)
                imbalance = imbalance + touch.force_n.ravel()[model.free]
                tangent = sp.csr_array(tangent + touch.hessian[model.free][:, model.free])
        forces = (state.external_n, state.internal_n, state.reaction_n)
        scale = max(1e-12, *(float(np.linalg.norm(force)) for force in forces))
        relative = float(np.linalg.norm(imbalance)) / scale
        on_iteration(iteration, relative)
        if relative <= options.relative_tolerance:
            return Outcome(
                status=Status.CONVERGED, u_m=u, iterations=iteration, residual=relative, cost=watch.cost(iteration)
            )
        if iteration == options.max_iterations:
            break
        with watch.time("solve"):
            step = solver.solve(tangent, imbalance)
        if step is None:
            return Outcome(
                status=Status.SINGULAR, u_m=u, iterations=iteration, residual=relative, cost=watch.cost(iteration)
            )
        step *= min(1.0, options.step_cap_m / max(float(np.abs(step).max()), 1e-30))
        if contact is not None:
            trial = u.copy()
            trial.reshape(-1)[model.free] += step
            with watch.time("contact"):
                bound = contact.step_bound(u, trial)
            step *= 1.0 if bound >= 1.0 else _BOUND_SHARE * bound
        for _ in range(6):  # halve the step while it would invert an element
            trial = u.copy()
            trial.reshape(-1)[model.free] += step
            with watch.time("assembly"):
                state = model.evaluate(trial, load)
            if state is not None:
                u = trial
                break
            step *= 0.5
    cost = watch.cost(options.max_iterations)
    return Outcome(status=Status.STALLED, u_m=u, iterations=options.max_iterations, residual=relative, cost=cost)


def follow(
    model: SolidModel,
    load_at: Callable[[float], Load],
    targets: list[float],
    options: NewtonOptions,
    *,
    on_target: Callable[[float, F64], None],
    extrapolate: bool = False,
    contact: Contact | None = None,
    sweep: Sweep | None = None,
) -> Outcome:
    """Go through increasing load parameters, halving a step that fails and growing it again when one works.

    Parameters
    ----------
    model : SolidModel
    load_at : callable
        Load at a parameter; 0 is the unloaded state.
    targets : list of float
        Increasing parameters at which ``on_target(parameter, u)`` is called, those of resumed steps included.
    options : NewtonOptions
    on_target : callable
    extrapolate : bool
        Start each step from the linear extrapolation of the last two states, as far as contact allows.
    contact : Contact, optional
        Contact between surfaces of the model.
    sweep : Sweep, optional
        Reports and the steps to go on from.

    Returns
    -------
    Outcome
        Of the last step; not converged if the path ended before the last target. ``iterations`` and ``cost`` are of
        the whole path, the resumed part included.
    """
    sweep = sweep or Sweep()
    zero = np.zeros_like(model.mesh.points_m)
    states = [(0.0, zero), *((step.parameter, step.u_m) for step in sweep.resume)]
    before, (at, u) = (states[-2] if len(states) > 1 else None), states[-1]
    spent = sweep.resume[-1].cost if sweep.resume else NO_COST
    reached = dict(states)
    solver = SymmetricSolver()
    outcome = Outcome(status=Status.CONVERGED, u_m=u, iterations=0, residual=0.0)
    start, size = 0.0, options.largest_step
    for target in targets:
        span, start = target - start, target
        while at < target:
            step = min(size, target - at)
            aim = target if step >= target - at else at + step
            guess = u
            if extrapolate and before is not None:
                guess = u + (u - before[1]) * step / (at - before[0])
                if contact is not None:
                    guess = u + _BOUND_SHARE * contact.step_bound(u, guess) * (guess - u)
            outcome = solve_equilibrium(
                model,
                guess,
                load_at(at + step),
                options,
                solver,
                contact,
                partial(sweep.on_iteration, aim),
            )
            spent += outcome.cost
            if outcome.converged:
                before = (at, u)
                at, u = aim, outcome.u_m
                size = min(options.largest_step, size * _GROWTH) if step >= size else size
                made = Step(parameter=at, u_m=u, iterations=outcome.iterations, residual=outcome.residual, cost=spent)
                sweep.on_step(made)
                continue
            size = 0.5 * step
            if size < options.min_step * span:
                solver.close()
                return replace(outcome, u_m=u, iterations=spent.newton_iterations, cost=spent)
        on_target(target, reached.get(target, u))
    solver.close()
    return replace(outcome, u_m=u, iterations=spent.newton_iterations, cost=spent)
