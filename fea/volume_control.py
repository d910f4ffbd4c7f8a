"""Inflation controlled by the cavity's volume, which goes on past a limit point of pressure.

Unknowns are u and p: internal(u) - p dV/du = 0 and V(u) = V*. The bordered tangent [K, -g; g^T, 0] is solved by block
elimination with one factorisation of K and two right-hand sides. At equilibrium dp/dV = 1 / (g . K^-1 g): its change of
sign is the limit point (Riks, 1979; Crisfield, Non-linear Finite Element Analysis of Solids and Structures, ch. 9).
"""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64
from fea.assembly import Load, SolidModel
from fea.linear_solver import SymmetricSolver
from fea.newton import NewtonOptions, Status


@dataclass(frozen=True, kw_only=True)
class LimitPoint:
    """Where the pressure has its first maximum over volume (volume of the modelled part)."""

    volume_m3: float
    pressure_pa_gauge: float


@dataclass(frozen=True, kw_only=True, eq=False)
class VolumePath:
    """States reached, over the volumes asked for.

    Attributes
    ----------
    status : Status
        ``CONVERGED`` where every volume was reached, ``LIMIT_POINT`` where the path was to end at one and did, else why
        the step after the last state failed.
    volume_m3, pressure_pa_gauge, slope_pa_per_m3 : arrays [n]
        Volume of the modelled part, pressure and dp/dV.
    u_m : array [n, n_nodes, 3]
    limit : LimitPoint or None
        First maximum of pressure passed.
    iterations : int
        Newton iterations in all.
    """

    status: Status
    volume_m3: F64
    pressure_pa_gauge: F64
    slope_pa_per_m3: F64
    u_m: F64
    limit: LimitPoint | None
    iterations: int


def inflate_by_volume(
    model: SolidModel, volumes_m3: list[float], options: NewtonOptions | None = None, *, stop_at_limit: bool = False
) -> VolumePath:
    """Bring the cavity through increasing volumes, starting unloaded.

    Raises
    ------
    ValueError
        If the model has no cavity, or the volumes do not increase from that of the undeformed cavity.
    """
    if model.cavity is None:
        raise ValueError("model: volume control needs a cavity")
    rest = model.cavity.volume_m3(model.mesh.points_m)
    if not volumes_m3 or np.any(np.diff([rest, *volumes_m3]) <= 0.0):
        raise ValueError(f"volumes_m3 = {volumes_m3} must increase from the volume at rest, {rest:g} m3")
    settings = options or NewtonOptions()
    solver = SymmetricSolver()
    u, pressure, total = np.zeros_like(model.mesh.points_m), 0.0, 0
    rows: list[tuple[float, float, float]] = []
    states: list[F64] = []
    limit: LimitPoint | None = None
    status = Status.CONVERGED
    at = rest
    for volume in volumes_m3:
        fraction, span = 1.0, volume - at
        while at < volume:
            step = min(fraction * span, volume - at)
            status, trial, trial_pressure, slope, iterations = _solve(model, u, pressure, at + step, settings, solver)
            total += iterations
            if status is Status.CONVERGED:
                u, pressure, at = trial, trial_pressure, volume if step >= volume - at else at + step
                continue
            fraction *= 0.5
            if fraction < settings.min_step:
                break
        if status is not Status.CONVERGED:
            break
        rows.append((volume, pressure, slope))
        states.append(u)
        if limit is None and len(rows) > 1 and rows[-2][2] > 0.0 >= slope:
            limit = _maximum(rows[-2], rows[-1])
            if stop_at_limit:
                status = Status.LIMIT_POINT
                break
    solver.close()
    table = np.array(rows).reshape(-1, 3)
    return VolumePath(
        status=status,
        volume_m3=table[:, 0],
        pressure_pa_gauge=table[:, 1],
        slope_pa_per_m3=table[:, 2],
        u_m=np.array(states),
        limit=limit,
        iterations=total,
    )


def _solve(
    model: SolidModel, u_m: F64, pressure: float, volume: float, options: NewtonOptions, solver: SymmetricSolver
) -> tuple[Status, F64, float, float, int]:
    """Return status, u, p, dp/dV and iterations of one volume."""
    assert model.cavity is not None
    u = u_m.copy()
    state = model.evaluate(u, Load(pressure_pa_gauge=pressure))
    for iteration in range(options.max_iterations + 1):
        if state is None or state.tangent is None:
            return Status.INVERTED, u, pressure, np.nan, iteration
        points = model.mesh.points_m + u
        gradient = model.cavity.derivatives(points)[0].ravel()[model.free]
        missing = volume - model.cavity.volume_m3(points)
        imbalance = state.external_n - state.internal_n
        solved = solver.solve(state.tangent, np.column_stack([imbalance, gradient]))
        if solved is None:
            return Status.SINGULAR, u, pressure, np.nan, iteration
        compliance = float(gradient @ solved[:, 1])
        scale = max(1e-12, float(np.linalg.norm(state.external_n)), float(np.linalg.norm(state.internal_n)))
        balanced = float(np.linalg.norm(imbalance)) <= options.relative_tolerance * scale
        if balanced and abs(missing) <= 1e-9 * volume:
            return Status.CONVERGED, u, pressure, 1.0 / compliance, iteration
        more = (missing - float(gradient @ solved[:, 0])) / compliance
        step = solved[:, 0] + more * solved[:, 1]
        fraction = min(1.0, options.step_cap_m / max(float(np.abs(step).max()), 1e-30))
        for _ in range(6):  # halve the step while it would invert an element
            trial = u.copy()
            trial.reshape(-1)[model.free] += fraction * step
            state = model.evaluate(trial, Load(pressure_pa_gauge=pressure + fraction * more))
            if state is not None:
                u, pressure = trial, pressure + fraction * more
                break
            fraction *= 0.5
    return Status.STALLED, u, pressure, np.nan, options.max_iterations


def _maximum(before: tuple[float, float, float], after: tuple[float, float, float]) -> LimitPoint:
    """Return the maximum of the cubic through two states (volume, pressure, slope) on either side of it."""
    (v0, p0, s0), (v1, p1, s1) = before, after
    h = v1 - v0
    # p(x) = p0 + h s0 x + b x^2 + c x^3 on x in [0, 1]
    b = 3.0 * (p1 - p0) - h * (2.0 * s0 + s1)
    c = 2.0 * (p0 - p1) + h * (s0 + s1)
    roots = np.roots([3.0 * c, 2.0 * b, h * s0])
    x = float(next(r.real for r in roots if abs(r.imag) < 1e-12 and -1e-9 <= r.real <= 1.0 + 1e-9))
    return LimitPoint(volume_m3=v0 + h * x, pressure_pa_gauge=p0 + h * s0 * x + b * x**2 + c * x**3)
