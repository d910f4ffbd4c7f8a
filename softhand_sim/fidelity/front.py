"""The measured front: what each setting misses and costs, read from a file; the cheapest one for a tolerance."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import comb
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.checks import require_finite
from softhand_sim.effects.scene import Tolerance

SCHEMA, SCHEMA_VERSION = "softhand-sim/accuracy-front", 2
SHARE, CONFIDENCE = 0.95, 0.95
"""Choice: a setting is within a tolerance if its scenes show, with 95 % confidence, that 95 % of all scenes are."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """What the front's measurement says of a setting.

    Attributes
    ----------
    name: the point's.
    angle_error_deg, slip_error_m: within which of the finest setting ``SHARE`` of all scenes are, each alone (`bound`).
    cost_ratio: processor time for a simulated second over that of the bare engine at the default setting.
    """

    name: str
    angle_error_deg: float
    slip_error_m: float
    cost_ratio: float

    def __post_init__(self) -> None:
        require_finite("angle_error_deg", self.angle_error_deg, at_least=0.0)
        require_finite("slip_error_m", self.slip_error_m, at_least=0.0)
        require_finite("cost_ratio", self.cost_ratio, above=0.0)


class Setting(Protocol):
    """What a front is made of: any setting that knows what was measured of it."""

    @property
    def measured(self) -> Measured | None:
        """What was measured of it, None if nothing was."""
        ...


Chosen = TypeVar("Chosen", bound=Setting)


@dataclass(frozen=True, kw_only=True)
class SceneErrors:
    """How far each scene of the measurement was from the finest setting: angles [deg] and slips [m], (n,).

    Raises
    ------
    ValueError
        If the two are not as many.
    """

    angle_deg: npt.NDArray[np.float64]
    slip_m: npt.NDArray[np.float64]

    def __post_init__(self) -> None:
        if self.angle_deg.shape != self.slip_m.shape or self.angle_deg.ndim != 1:
            raise ValueError(f"slip_m: {self.slip_m.shape} values must be as many as angles, {self.angle_deg.shape}")

    def beyond(self, tolerance: Tolerance) -> int:
        """Return how many scenes are not within a tolerance, in angle or in slip."""
        return int(((self.angle_deg > tolerance.angle_deg) | (self.slip_m > tolerance.slip_m)).sum())

    def show_within(self, tolerance: Tolerance) -> bool:
        """Whether they show that ``SHARE`` of all scenes are within a tolerance."""
        return self.beyond(tolerance) <= most_beyond(len(self.angle_deg))


@dataclass(frozen=True, kw_only=True)
class Front(Generic[Chosen]):
    """Settings that may be chosen, each with its `Measured`, in the file's order, and their scenes' errors.

    Raises
    ------
    ValueError
        If there is none, two have one name, or there are not as many errors.
    """

    points: tuple[Chosen, ...]
    errors: tuple[SceneErrors, ...]

    def __post_init__(self) -> None:
        names = [point.measured.name for point in self.points if point.measured is not None]
        if not names or len(names) != len(self.points) or len(set(names)) != len(names):
            raise ValueError(f"points: {names} must be one or more measured ones of different names")
        if len(self.errors) != len(names):
            raise ValueError(f"errors: {len(self.errors)} must be as many as points, {len(names)}")

    def for_tolerance(self, tolerance: Tolerance) -> Chosen:
        """Return the cheapest point within a tolerance: a wider one has all the choices of a narrower one.

        Raises
        ------
        ValueError
            If no point is within it; the message says what the best one reaches.
        """
        within = [(m.cost_ratio, point) for point, m, errors in self._measured() if errors.show_within(tolerance)]
        if not within:
            best, errors = min(((m, e) for _, m, e in self._measured()), key=lambda pair: pair[1].beyond(tolerance))
            count = len(errors.angle_deg)
            raise ValueError(
                f"tolerance = {tolerance.angle_deg:g} degrees, {1e3 * tolerance.slip_m:g} mm: no measured setting is "
                f"known to be within it in {SHARE:.0%} of scenes; {best.name} was not in {errors.beyond(tolerance)} of "
                f"{count}; known of it: {best.angle_error_deg:.2g} degrees, {1e3 * best.slip_error_m:.2g} mm"
            )
        return min(within, key=lambda pair: pair[0])[1]

    def _measured(self) -> list[tuple[Chosen, Measured, SceneErrors]]:
        pairs = zip(self.points, self.errors, strict=True)
        return [(point, point.measured, errors) for point, errors in pairs if point.measured is not None]


@cache
def most_beyond(scenes: int) -> int:
    """Return how many scenes of so many may be beyond a bound that ``SHARE`` of all scenes keep; -1 if too few.

    The largest m for which more than m of them are beyond with probability ``CONFIDENCE`` or more if a share of
    1 - ``SHARE`` of all is, whatever the distribution: Wilks's tolerance limit (Ann. Math. Stat. 12, 91, 1941). 59
    scenes allow none, 93 one, 208 five.
    """
    rest, chance, found = 1.0 - SHARE, 0.0, -1
    for m in range(scenes):
        chance += comb(scenes, m) * rest**m * SHARE ** (scenes - m)
        if chance > 1.0 - CONFIDENCE:
            break
        found = m
    return found


def bound(errors: Sequence[float]) -> float:
    """Return the error that ``SHARE`` of all scenes do not exceed, with ``CONFIDENCE``: one of the measured values.

    Of fewer than 59 scenes the largest, which is no such bound.
    """
    ordered = np.sort(np.asarray(errors, dtype=np.float64))
    return float(ordered[-1 - max(most_beyond(len(ordered)), 0)])


def non_dominated(errors: Sequence[float], costs: Sequence[float]) -> tuple[int, ...]:
    """Return the points that no other one beats in both, by rising cost: errors fall along them."""
    found: list[int] = []
    for k in sorted(range(len(costs)), key=lambda k: (costs[k], errors[k])):
        if not found or errors[k] < errors[found[-1]]:
            found.append(k)
    return tuple(found)


def read_front(path: Path, build: Callable[[dict[str, Any], Measured], Chosen]) -> Front[Chosen]:
    """Read and check a front.

    Points without errors of single scenes are left out, and those with other shapes or links: they are other models.

    Parameters
    ----------
    path: of the file.
    build: makes a setting of its plain fields and what was measured of it.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file isn't a front of this schema and version, or a field is missing or wrong; the one-line message names
        file, field, value and what is allowed.
    """
    root = read_fields(path)
    root.require_equal("schema", SCHEMA)
    root.require_equal("schema_version", SCHEMA_VERSION)
    rows = root.value("points")
    if not isinstance(rows, list) or not rows:
        raise root.error("points", rows, "a list of one point or more")
    with root.naming_file():
        chosen = [
            row
            for row in root.objects("points", len(rows))
            if row.text("kind") == "numerics" and "scene_angle_error_deg" in row.raw
        ]
        points = tuple(_point(row, build) for row in chosen)
        return Front(points=points, errors=tuple(_errors(row) for row in chosen))


def _errors(row: Fields) -> SceneErrors:
    angle, slip = row.numbers("scene_angle_error_deg", (None,)), row.numbers("scene_slip_error_m", (None,))
    return SceneErrors(angle_deg=angle, slip_m=slip)


def _point(row: Fields, build: Callable[[dict[str, Any], Measured], Chosen]) -> Chosen:
    measured = Measured(
        name=row.text("name"),
        angle_error_deg=float(row.numbers("angle_error_deg", ())),
        slip_error_m=float(row.numbers("slip_error_m", ())),
        cost_ratio=float(row.numbers("cost_ratio", ())),
    )
    return build(row.object("fidelity").raw, measured)
