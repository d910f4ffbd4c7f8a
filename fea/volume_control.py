"""Inflation controlled by the cavity's volume, which goes on past a limit point of pressure.

The pressure comes from a supply that is stiffer than the cavity: equilibrium is then stable on either side of a limit
point, and Newton's method, contact and friction work as under a given pressure. The supply's own pressure is moved
until the volume is the one asked for (augmented Lagrangian: Nocedal & Wright, Numerical Optimization, ch. 17). At
equilibrium dp/dV = 1 / (g . K^-1 g), g = dV/du: its change of sign is the limit point (Riks, 1979; Crisfield,
Non-linear Finite Element Analysis of Solids and Structures, ch. 9).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fea.arrays import F64
from fea.assembly import SolidModel
from fea.contact_interface import Contact
from fea.friction import advance, begin, solve_step
from fea.load import Load, Supply
from fea.newton import NewtonOptions, Outcome, Status
from fea.workspace import Workspace, workspace

STIFFNESS = 30.0
"""Choice: the supply's stiffness in units of the cavity's at rest. Each correction of the volume then leaves a
thirtieth of the error, and the volume's curvature over a step does not hide the energy's fall."""
_CORRECTIONS = 10
_VOLUME_TOLERANCE = 1e-9


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
    model: SolidModel,
    volumes_m3: list[float],
    options: NewtonOptions | None = None,
    *,
    contact: Contact | None = None,
    stop_at_limit: bool = False,
    progress: Callable[[], None] = lambda: None,
) -> VolumePath:
    """Bring the cavity through increasing volumes, starting unloaded; ``progress`` is called after each.

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
    zero = np.zeros_like(model.mesh.points_m)
    follower = _Follower(workspace(model), options or NewtonOptions())
    stiffness = STIFFNESS * follower.slope(zero, Load(), None)
    at = _State(
        u_m=zero, load=Load(supply=Supply(volume_m3=rest, stiffness_pa_per_m3=stiffness)), contact=begin(contact, zero)
    )
    rows: list[tuple[float, float, float]] = []
    states: list[F64] = []
    limit: LimitPoint | None = None
    for volume in volumes_m3:
        status, at = follower.reach(at, volume)
        if status is not Status.CONVERGED:
            break
        rows.append((volume, model.pressure_pa_gauge(at.u_m, at.load), follower.slope(at.u_m, at.load, at.contact)))
        states.append(at.u_m)
        progress()
        if limit is None and len(rows) > 1 and rows[-2][2] > 0.0 >= rows[-1][2]:
            limit = _maximum(rows[-2], rows[-1])
            if stop_at_limit:
                status = Status.LIMIT_POINT
                break
    follower.work.close()
    table = np.array(rows).reshape(-1, 3)
    return VolumePath(
        status=status,
        volume_m3=table[:, 0],
        pressure_pa_gauge=table[:, 1],
        slope_pa_per_m3=table[:, 2],
        u_m=np.array(states),
        limit=limit,
        iterations=follower.iterations,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _State:
    """A converged state: displacement [n_nodes, 3], its load and the contact of the next step."""

    u_m: F64
    load: Load
    contact: Contact | None


@dataclass
class _Follower:
    """Steps from volume to volume and counts the iterations."""

    work: Workspace
    options: NewtonOptions
    iterations: int = 0

    def reach(self, at: _State, volume_m3: float) -> tuple[Status, _State]:
        """Go to a volume, in halves of the way where the whole is too much; on failure return the last state."""
        assert at.load.supply is not None
        span = step = volume_m3 - at.load.supply.volume_m3
        while at.load.supply is not None and at.load.supply.volume_m3 < volume_m3:
            near = at.load.supply.volume_m3 + step > volume_m3 - 1e-9 * span
            outcome, load = self._step(at, volume_m3 if near else at.load.supply.volume_m3 + step)
            if outcome.converged:
                at = _State(u_m=outcome.u_m, load=load, contact=advance(at.contact, outcome.u_m))
                continue
            step *= 0.5
            if step < self.options.min_step * span:
                return outcome.status, at
        return Status.CONVERGED, at

    def _step(self, at: _State, volume_m3: float) -> tuple[Outcome, Load]:
        assert at.load.supply is not None
        model = self.work.model
        load = replace(at.load, supply=replace(at.load.supply, volume_m3=volume_m3))
        outcome = self._solve(at.u_m, load, at.load, at.contact)
        for _ in range(_CORRECTIONS):
            assert model.cavity is not None
            reached = model.cavity.volume_m3(model.mesh.points_m + outcome.u_m)
            if not outcome.converged or abs(reached - volume_m3) <= _VOLUME_TOLERANCE * volume_m3:
                break
            before, load = load, replace(load, pressure_pa_gauge=load.pressure_at(reached))
            outcome = self._solve(outcome.u_m, load, before, at.contact)
        return outcome, load

    def _solve(self, u_m: F64, load: Load, balanced: Load, contact: Contact | None) -> Outcome:
        outcome = solve_step(self.work, u_m, load, self.options, balanced=balanced, contact=contact)
        self.iterations += outcome.iterations
        return outcome

    def slope(self, u_m: F64, load: Load, contact: Contact | None) -> float:
        """Return dp/dV of the cavity at an equilibrium [Pa/m3], NaN where the tangent is singular."""
        model = self.work.model
        assert model.cavity is not None
        state = model.evaluate(u_m, load)
        if state is None or state.tangent is None:
            return np.nan
        tangent = state.tangent
        if contact is not None:
            touch = contact.held(u_m).evaluate(u_m, project=False)
            tangent = self.work.with_contact(tangent, touch.hessian)
        gradient = model.cavity.gradient(model.mesh.points_m + u_m).ravel()[model.free]
        solved = self.work.solver.solve(tangent, gradient)
        return np.nan if solved is None else 1.0 / float(gradient @ solved)


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
