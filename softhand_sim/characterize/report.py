"""What a bench test returns: figures, checks against stated limits, and curves that say whose they are."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any


class Source(Enum):
    """Whose a curve is; a picture shows each alike everywhere."""

    FEA_FITTED = "finite elements, seen by the fit"
    FEA = "finite elements, not seen by the fit"
    SURROGATE = "simulated finger (MuJoCo)"
    PAPER = "paper (stated in its text)"
    COMMAND = "set value"


@dataclass(frozen=True, kw_only=True)
class Check:
    """A figure that must not pass its limit, both in ``unit``."""

    name: str
    value: float
    limit: float
    unit: str

    @property
    def holds(self) -> bool:
        """Whether the value is at most the limit (never with NaN)."""
        return self.value <= self.limit

    def __str__(self) -> str:
        return f"{'ok ' if self.holds else 'NOT'} {self.name}: {self.value:.3g} of at most {self.limit:g} {self.unit}"


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Points of one source; ``label`` says which where a panel has several of one source.

    ``half_width`` is that of the band round ``y``, as long as it, or empty for none.
    """

    source: Source
    x: Sequence[float]
    y: Sequence[float]
    label: str = ""
    half_width: Sequence[float] = ()


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One pair of axes."""

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]


@dataclass(frozen=True, kw_only=True)
class Report:
    """One bench test: ``figures`` are JSON ready, SI units in their keys."""

    name: str
    figures: dict[str, Any]
    checks: tuple[Check, ...]
    panels: tuple[Panel, ...] = ()
    stated: tuple[str, ...] = field(default=())

    @property
    def holds(self) -> bool:
        """Whether every check does."""
        return all(check.holds for check in self.checks)

    def as_dict(self) -> dict[str, Any]:
        """Return the report without its curves, JSON ready."""
        checks = [
            {"name": c.name, "value": c.value, "limit": c.limit, "unit": c.unit, "holds": c.holds} for c in self.checks
        ]
        return self.figures | {"checks": checks, "paper_states": list(self.stated)}
