"""The measured front: what each setting misses and costs, read from a file; the cheapest one for a tolerance."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.checks import require_finite
from softhand_sim.effects.scene import Tolerance

SCHEMA, SCHEMA_VERSION = "softhand-sim/accuracy-front", 1
SHARE = 0.97
"""Choice: share of the front's scenes that are within a point's error; new scenes are to be so in 95 of 100."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """What the front's measurement says of a setting.

    Attributes
    ----------
    name: the point's.
    angle_error_deg, slip_error_m: within which the scenes of the measurement were, but for 3 %, of the finest setting.
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
class Front(Generic[Chosen]):
    """Settings that may be chosen, each with its `Measured`, in the file's order.

    Raises
    ------
    ValueError
        If there is none, or two have one name.
    """

    points: tuple[Chosen, ...]

    def __post_init__(self) -> None:
        names = [point.measured.name for point in self.points if point.measured is not None]
        if not names or len(names) != len(self.points) or len(set(names)) != len(names):
            raise ValueError(f"points: {names} must be one or more measured ones of different names")

    def for_tolerance(self, tolerance: Tolerance) -> Chosen:
        """Return the cheapest point within a tolerance: a wider one has all the choices of a narrower one.

        Raises
        ------
        ValueError
            If no point is within it; the message says what the best ones reach.
        """
        within = [
            (m.cost_ratio, point)
            for point, m in self._measured()
            if m.angle_error_deg <= tolerance.angle_deg and m.slip_error_m <= tolerance.slip_m
        ]
        if not within:
            best = min((m for _, m in self._measured()), key=lambda m: (m.angle_error_deg, m.slip_error_m))
            raise ValueError(
                f"tolerance = {tolerance.angle_deg:g} degrees, {1e3 * tolerance.slip_m:g} mm: no measured setting is "
                f"within it; the best one, {best.name}, has {best.angle_error_deg:.2g} degrees and "
                f"{1e3 * best.slip_error_m:.2g} mm"
            )
        return min(within, key=lambda pair: pair[0])[1]

    def _measured(self) -> list[tuple[Chosen, Measured]]:
        return [(point, point.measured) for point in self.points if point.measured is not None]


def share_within(errors: Sequence[float]) -> float:
    """Return the error that ``SHARE`` of the scenes do not exceed, one of the measured values."""
    return float(np.quantile(np.asarray(errors, dtype=np.float64), SHARE, method="higher"))


def non_dominated(errors: Sequence[float], costs: Sequence[float]) -> tuple[int, ...]:
    """Return the points that no other one beats in both, by rising cost: errors fall along them."""
    found: list[int] = []
    for k in sorted(range(len(costs)), key=lambda k: (costs[k], errors[k])):
        if not found or errors[k] < errors[found[-1]]:
            found.append(k)
    return tuple(found)


def read_front(path: Path, build: Callable[[dict[str, Any], Measured], Chosen]) -> Front[Chosen]:
    """Read and check a front; points with other shapes or links are left out, they are other models.

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
        points = tuple(
            _point(row, build) for row in root.objects("points", len(rows)) if row.text("kind") == "numerics"
        )
        return Front(points=points)


def _point(row: Fields, build: Callable[[dict[str, Any], Measured], Chosen]) -> Chosen:
    measured = Measured(
        name=row.text("name"),
        angle_error_deg=float(row.numbers("angle_error_deg", ())),
        slip_error_m=float(row.numbers("slip_error_m", ())),
        cost_ratio=float(row.numbers("cost_ratio", ())),
    )
    return build(row.object("fidelity").raw, measured)
