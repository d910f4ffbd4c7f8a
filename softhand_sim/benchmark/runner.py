"""Runs the trials of several objects, in this process or in worker processes; the results do not depend on which."""

import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from pathlib import Path

from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import TrialResult, TrialSetup, prepare, run_trial
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.model import ObjectModel

# choice: small enough to keep two workers busy to the end, large enough to share the building of a scene
TRIALS_A_CHUNK = 5


@dataclass(frozen=True, kw_only=True)
class BenchmarkPlan:
    """What to run.

    Attributes
    ----------
    objects: the objects, each with its own name.
    trials: per object; their seeds are ``seed .. seed + trials - 1``, the same for every object.
    calibration: finger calibration file; None for the shipped one.
    protocol, engine: what a trial does, and the engine's settings.
    """

    objects: tuple[ObjectModel, ...]
    trials: int
    seed: int = 0
    calibration: Path | None = None
    protocol: GraspProtocol = field(default_factory=load_protocol)
    engine: EngineSettings = field(default_factory=EngineSettings)

    def __post_init__(self) -> None:
        names = [model.name for model in self.objects]
        if not names or len(set(names)) != len(names):
            raise ValueError(f"objects: {names} must be one or more different names")
        if self.trials < 1 or self.seed < 0:
            raise ValueError(f"trials: {self.trials} must be 1 or above, seed: {self.seed} 0 or above")

    def chunks(self) -> list[tuple[ObjectModel, tuple[int, ...]]]:
        """Return the work in pieces: an object and the seeds of its trials."""
        seeds = range(self.seed, self.seed + self.trials)
        return [
            (model, tuple(seeds[start : start + TRIALS_A_CHUNK]))
            for model in self.objects
            for start in range(0, self.trials, TRIALS_A_CHUNK)
        ]


def run_benchmark(plan: BenchmarkPlan, workers: int = 1) -> Iterator[TrialResult]:
    """Return an iterator over the results as they come; `in_order` sorts them.

    Raises
    ------
    FileNotFoundError, ValueError
        If the calibration is missing or wrong; at once, before the first trial.
    """
    load_calibration(plan.calibration)
    return _results(plan, workers)


def _results(plan: BenchmarkPlan, workers: int) -> Iterator[TrialResult]:
    work = plan.chunks()
    if workers == 1:
        for model, seeds in work:
            yield from _run_chunk(plan, model, seeds)
        return
    # a chunk carries its own object: the others need not travel with it
    lean = replace(plan, objects=plan.objects[:1])
    # spawn: a forked child would inherit the parent's GL and BLAS threads
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(workers, len(work)), mp_context=context) as pool:
        jobs = [pool.submit(_run_chunk, lean, model, seeds) for model, seeds in work]
        for job in as_completed(jobs):
            yield from job.result()


def in_order(plan: BenchmarkPlan, results: Sequence[TrialResult]) -> list[TrialResult]:
    """Return the results by object (in the plan's order) and seed."""
    place = {model.name: i for i, model in enumerate(plan.objects)}
    return sorted(results, key=lambda result: (place[result.object], result.seed))


def _run_chunk(plan: BenchmarkPlan, model: ObjectModel, seeds: tuple[int, ...]) -> list[TrialResult]:
    setup = prepare_for(plan, model)
    return [run_trial(setup, seed) for seed in seeds]


def prepare_for(plan: BenchmarkPlan, model: ObjectModel) -> TrialSetup:
    """Return what the trials of one object of the plan share."""
    return prepare(model, load_calibration(plan.calibration), protocol=plan.protocol, engine=plan.engine)
