"""Follows a load path in adaptive steps; what it reports on the way, and how it goes on from a broken run."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fea.arrays import F64
from fea.assembly import SolidModel
from fea.contact_interface import Contact
from fea.cost import NO_COST, Cost
from fea.friction import advance, begin, solve_step
from fea.load import Load
from fea.newton import NewtonOptions, Outcome, Status
from fea.workspace import workspace

_EASY, _HARD = 8, 12
_GROWTH, _SHRINKAGE = 1.5, 0.8
"""Choices: a step of at most 8 iterations lets the next grow, one of more than 12 makes it shrink."""


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
    at, u = states[-1]
    spent = sweep.resume[-1].cost if sweep.resume else NO_COST
    reached = dict(states)
    contact = begin(contact, zero)
    for made in sweep.resume:
        contact = advance(contact, made.u_m)
    work = workspace(model)
    outcome = Outcome(status=Status.CONVERGED, u_m=u, iterations=0, residual=0.0)
    size = _resumed_size(sweep.resume, targets, options)
    start = 0.0
    for target in targets:
        span, start = target - start, target
        while at < target:
            step = min(size, target - at)
            aim = target if step >= target - at else at + step
            outcome = solve_step(
                work,
                u,
                load_at(aim),
                options,
                balanced=load_at(at),
                contact=contact,
                on_iteration=partial(sweep.on_iteration, aim),
            )
            spent += outcome.cost
            if outcome.converged:
                at, u = aim, outcome.u_m
                size = _next_size(size, step, outcome.iterations, options)
                contact = advance(contact, u)
                made = Step(parameter=at, u_m=u, iterations=outcome.iterations, residual=outcome.residual, cost=spent)
                sweep.on_step(made)
                continue
            size = 0.5 * step
            if size < options.min_step * min(span, options.largest_step):
                work.close()
                return replace(outcome, u_m=u, iterations=spent.newton_iterations, cost=spent)
        on_target(target, reached.get(target, u))
    work.close()
    return replace(outcome, u_m=u, iterations=spent.newton_iterations, cost=spent)


def _resumed_size(resume: Sequence[Step], targets: list[float], options: NewtonOptions) -> float:
    """Return the size that an unbroken run would go on with: with friction the steps are part of the result."""
    size, at = min(options.first_step, options.largest_step), 0.0
    for made in resume:
        step = made.parameter - at
        if made.parameter not in targets:
            size = step
        at = made.parameter
        size = _next_size(size, step, made.iterations, options)
    return size


def _next_size(size: float, step: float, iterations: int, options: NewtonOptions) -> float:
    """Return the next load step's size; one cut short to meet a target says nothing of the size."""
    if iterations > _HARD:
        return _SHRINKAGE * step
    if iterations <= _EASY and step >= size:
        return min(options.largest_step, _GROWTH * size)
    return size
