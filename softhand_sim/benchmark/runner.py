"""Runs the trials of several objects, in this process or in worker processes; the results do not depend on which."""

from collections.abc import Callable, Iterator, Sequence

from softhand_sim.benchmark.plan import BenchmarkPlan, Shard, run_shard, tapered
from softhand_sim.benchmark.ray_engine import require_ray, run_on_ray
from softhand_sim.benchmark.store import TrialStore
from softhand_sim.benchmark.workers import run_shards
from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.trial import TrialSetup


def run_benchmark(
    plan: BenchmarkPlan,
    workers: int = 1,
    store: TrialStore | None = None,
    only: frozenset[tuple[str, int]] | None = None,
    ray_address: str | None = None,
) -> Iterator[TrialResult]:
    """Return an iterator over the results as they come, those of the store first; `in_order` sorts them.

    Parameters
    ----------
    plan: what to run.
    workers: processes side by side; one worker is this process.
    store: keeps each trial; those that it has are not run again.
    only: some of the plan's trials, as object's name and seed; by default all.
    ray_address: of a Ray cluster that runs the trials instead of local processes; ``local`` for one of its own.

    Raises
    ------
    FileNotFoundError, ValueError
        If the calibration is missing or wrong, or Ray is not installed; at once, before the first trial.
    """
    for file in {plan.calibration, plan.control}:
        load_calibration(file)
    if ray_address is not None:
        require_ray()

    def engine(shards: Sequence[Shard]) -> Iterator[TrialResult]:
        if workers > 1:
            shards = tapered(shards, workers)
        if ray_address is not None:
            return run_on_ray(plan, shards, workers, ray_address)
        return _in_this_process(plan, shards) if workers == 1 else run_shards(plan, shards, workers)

    return _results(plan, store, frozenset(plan.trial_keys) if only is None else only, engine)


def _results(
    plan: BenchmarkPlan,
    store: TrialStore | None,
    wanted: frozenset[tuple[str, int]],
    engine: Callable[[Sequence[Shard]], Iterator[TrialResult]],
) -> Iterator[TrialResult]:
    kept = [] if store is None else [r for r in store.results() if (r.object, r.seed) in wanted]
    yield from kept
    shards = plan.shards(wanted - {(result.object, result.seed) for result in kept})
    for result in engine(shards) if shards else ():
        if store is not None:
            store.add(result)
        yield result


def _in_this_process(plan: BenchmarkPlan, shards: Sequence[Shard]) -> Iterator[TrialResult]:
    setup: TrialSetup | None = None
    for shard in shards:
        setup, results = run_shard(plan, shard, setup)
        yield from results


def in_order(plan: BenchmarkPlan, results: Sequence[TrialResult]) -> list[TrialResult]:
    """Return the results by object (in the plan's order) and seed."""
    place = {model.name: i for i, model in enumerate(plan.objects)}
    return sorted(results, key=lambda result: (place[result.object], result.seed))
