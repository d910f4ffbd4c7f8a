"""What a solve costs: iterations and where the time went."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from time import perf_counter
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Work of a solve; costs of consecutive solves add up.

    Attributes
    ----------
    newton_iterations : int
        Linear solves, those of rejected load steps included.
    wall_s, assembly_s, solve_s, contact_s : float
        Elapsed time as a whole, in stress and tangent with their assembly, in factor and solve, and in contact.
    """

    newton_iterations: int = 0
    wall_s: float = 0.0
    assembly_s: float = 0.0
    solve_s: float = 0.0
    contact_s: float = 0.0

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(**{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)})

    def as_dict(self) -> dict[str, Any]:
        """Return every field, JSON ready."""
        return asdict(self)


NO_COST = Cost()


class Stopwatch:
    """Adds up the time of the parts of one solve."""

    def __init__(self) -> None:
        self._start = perf_counter()
        self._spent = dict.fromkeys(("assembly", "solve", "contact"), 0.0)

    @contextmanager
    def time(self, part: str) -> Iterator[None]:
        """Add the time spent inside to ``"assembly"``, ``"solve"`` or ``"contact"``."""
        start = perf_counter()
        try:
            yield
        finally:
            self._spent[part] += perf_counter() - start

    def cost(self, newton_iterations: int) -> Cost:
        """Return what was spent since this watch was made."""
        return Cost(
            newton_iterations=newton_iterations,
            wall_s=perf_counter() - self._start,
            **{f"{part}_s": spent for part, spent in self._spent.items()},
        )
