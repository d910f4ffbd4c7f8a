"""Whether verdicts depend on the engine's settings: some trials again at a quarter of the time step."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.report import wilson_interval
from softhand_sim.benchmark.runner import run_benchmark
from softhand_sim.benchmark.store import TrialStore
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome

STEP_FRACTION = 0.25
NOSLIP_ITERATIONS = 10
"""Choice: three times the default; creep of a held object no longer falls with more."""
Key = tuple[str, int]


@dataclass(frozen=True, kw_only=True)
class StepCheck:
    """Trials that were run twice.

    Attributes
    ----------
    trials: how many.
    flipped: those whose verdict is another one, as object, seed, verdict at the run's settings, verdict at the finer.
    held_flipped: how many of them went to or from `HELD`.
    """

    trials: int
    flipped: tuple[tuple[str, int, str, str], ...]
    held_flipped: int

    def data(self) -> dict[str, Any]:
        """Return the figures, JSON-ready: counts, shares and their Wilson intervals."""
        low, high = wilson_interval(len(self.flipped), self.trials)
        held_low, held_high = wilson_interval(self.held_flipped, self.trials)
        return {
            **asdict(self),
            "flipped_share": len(self.flipped) / self.trials,
            "wilson_low": low,
            "wilson_high": high,
            "held_flipped_share": self.held_flipped / self.trials,
            "held_wilson_low": held_low,
            "held_wilson_high": held_high,
        }

    def text(self) -> str:
        """Return the figures in a line, and a line each flipped trial."""
        data = self.data()
        head = (
            f"at a quarter of the time step and {NOSLIP_ITERATIONS} noslip iterations {len(self.flipped)} of "
            f"{self.trials} verdicts differ: {data['flipped_share']:.1%}, 95 % Wilson {data['wilson_low']:.1%} - "
            f"{data['wilson_high']:.1%}; {self.held_flipped} of them to or from HELD"
        )
        return "\n".join([head, *(f"  {name} {seed}: {one} -> {other}" for name, seed, one, other in self.flipped)])


def finer(plan: BenchmarkPlan) -> BenchmarkPlan:
    """Return the plan with the finer engine."""
    engine = replace(
        plan.engine, timestep_s=STEP_FRACTION * plan.engine.timestep_s, noslip_iterations=NOSLIP_ITERATIONS
    )
    return replace(plan, engine=engine)


def drawn(results: Sequence[TrialResult], count: int, seed: int) -> frozenset[Key]:
    """Draw trials to repeat, evenly among all that did not crash; all of them if there are no more than `count`."""
    keys = sorted((result.object, result.seed) for result in results if result.outcome is not Outcome.CRASHED)
    rng = np.random.default_rng(seed)
    return frozenset(keys[i] for i in rng.choice(len(keys), size=min(count, len(keys)), replace=False))


def repeat(
    plan: BenchmarkPlan,
    keys: frozenset[Key],
    workers: int = 1,
    store: TrialStore | None = None,
    ray_address: str | None = None,
) -> Iterator[TrialResult]:
    """Return an iterator over the trials with the finer engine; `store` belongs to `finer(plan)`."""
    return run_benchmark(finer(plan), workers, store, only=keys, ray_address=ray_address)


def compare(results: Sequence[TrialResult], fine: Sequence[TrialResult]) -> StepCheck:
    """Return which verdicts of the repeated trials differ.

    Raises
    ------
    ValueError
        If no trial was repeated.
    """
    if not fine:
        raise ValueError("no trial was repeated: the run has none that did not crash")
    first = {(result.object, result.seed): result.outcome for result in results}
    flipped = [
        (result.object, result.seed, first[result.object, result.seed].value, result.outcome.value)
        for result in sorted(fine, key=lambda result: (result.object, result.seed))
        if first[result.object, result.seed] is not result.outcome
    ]
    return StepCheck(
        trials=len(fine),
        flipped=tuple(flipped),
        held_flipped=sum(Outcome.HELD.value in row[2:] for row in flipped),
    )
