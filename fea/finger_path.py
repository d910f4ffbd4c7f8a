"""What the complete finger goes through, as one increasing parameter: pressure up, then down, or a load on the tip."""

from dataclasses import dataclass

from fea.inputs import check_loads, check_pressures

PA_PER_N = 1e5
"""Choice: parameter per newton of tip load; load steps are then of a tenth of a newton at most."""


@dataclass(frozen=True)
class FingerPath:
    """Gauge pressures up; with ``unload`` down again to ``unload_to_pa_gauge``; or tip loads up at the last pressure.

    Raises
    ------
    ValueError
        If pressures or loads do not increase, both ``unload`` and ``tip_loads_n`` are given, or the way back ends
        above the last pressure.
    """

    pressures_pa_gauge: tuple[float, ...]
    unload: bool = False
    tip_loads_n: tuple[float, ...] = ()
    unload_to_pa_gauge: float = 0.0

    def __post_init__(self) -> None:
        check_pressures(self.pressures_pa_gauge)
        if not 0.0 <= self.unload_to_pa_gauge < self.pressures_pa_gauge[-1]:
            raise ValueError(
                f"unload_to_pa_gauge = {self.unload_to_pa_gauge:g} must lie in [0, {self.pressures_pa_gauge[-1]:g})"
            )
        if self.tip_loads_n:
            check_loads(self.tip_loads_n)
        if self.unload and self.tip_loads_n:
            raise ValueError("unload, tip_loads_n: tip loads are put on at the last pressure; give one of them")

    @property
    def targets(self) -> list[float]:
        """Parameters at which states are asked for."""
        up = list(self.pressures_pa_gauge)
        if self.unload:
            down = [p for p in up[-2::-1] if p > self.unload_to_pa_gauge]
            return [*up, *(2.0 * up[-1] - p for p in (*down, self.unload_to_pa_gauge))]
        return [*up, *(up[-1] + PA_PER_N * load for load in self.tip_loads_n)]

    def pressure(self, parameter: float) -> float:
        """Return the gauge pressure at a parameter [Pa]."""
        top = self.pressures_pa_gauge[-1]
        return min(parameter, 2.0 * top - parameter if self.unload else top)

    def tip_load(self, parameter: float) -> float:
        """Return the load on the tip at a parameter [N]."""
        beyond = max(0.0, parameter - self.pressures_pa_gauge[-1])
        return beyond / PA_PER_N if self.tip_loads_n else 0.0

    def branch(self, parameter: float) -> str:
        """Return which branch a parameter belongs to."""
        if parameter <= self.pressures_pa_gauge[-1]:
            return "loading"
        return "tip load" if self.tip_loads_n else "unloading"
