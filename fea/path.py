"""Follows a load path in adaptive steps; what it reports on the way, and how it goes on from a broken run."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fea.arrays import F64
from fea.assembly import Load, SolidModel
from fea.cost import NO_COST, Cost
from fea.friction import advance, begin, solve_step
from fea.linear_solver import SymmetricSolver
from fea.newton import BOUND_SHARE, Contact, NewtonOptions, Outcome, Status

_GROWTH = 1.15
"""Choice: growth of a load step that worked after one that failed; doubling failed again every second time."""


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
    contact = begin(contact, zero)
    for made in sweep.resume:
        contact = advance(contact, made.u_m)
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
                guess = _extrapolated(before, (at, u), step, contact)
            outcome = solve_step(
                model,
                guess,
                load_at(aim),
                options,
                solver,
                contact=contact,
                on_iteration=partial(sweep.on_iteration, aim),
            )
            spent += outcome.cost
            if outcome.converged:
                before, (at, u) = (at, u), (aim, outcome.u_m)
                contact = advance(contact, u)
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


def _extrapolated(before: tuple[float, F64], now: tuple[float, F64], step: float, contact: Contact | None) -> F64:
    """Return the linear extrapolation of the last two states, stopped where surfaces would meet."""
    (at_before, u_before), (at, u) = before, now
    way = (u - u_before) * step / (at - at_before)
    if contact is not None:
        way = BOUND_SHARE * contact.step_bound(u, u + way) * way
    return np.asarray(u + way)
