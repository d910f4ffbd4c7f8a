"""Grasp trials a second, what of it is the engine's own, and what a second worker brings.

First, in one process, each trial is run as the benchmark runs it (object, scene, trial, record in a store), and the
same model is stepped by the bare engine through the same states, ten steps from each 20 ms of the trial, with nothing
else around it; one after the other, in changing order. Times are those of the processor, so that other work on the
machine disturbs them less. Making an object and its scene, once for all of its trials, is counted as the trials'; the
share without it is told, too. Then the same plan is run by the benchmark's own processes, one and several in turn: with
the start of the processes, some seconds, and from the first result on. A plan of a minute or more shows what a long run
has; in a short one the start and the last trials, when not all workers have one, weigh more.
"""

import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from tqdm import tqdm

from scripts import _cli
from scripts._objects import catalogue_names
from softhand_sim.benchmark.plan import BenchmarkPlan, prepare_for
from softhand_sim.benchmark.runner import run_benchmark
from softhand_sim.benchmark.store import TrialStore
from softhand_sim.grasp.protocol_file import DEFAULT, load_protocol
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.stage import SAMPLE_S
from softhand_sim.grasp.trial import TrialSetup, run_trial
from softhand_sim.objects.catalogue import make_object
from softhand_sim.simulation import HandSimulation

EXAMPLES = """examples:
  benchmark_throughput.py --json out/throughput.json
  benchmark_throughput.py --objects apple,mug --trials 60 --repeats 5
  benchmark_throughput.py --repeats 0                            # the engine's share alone
"""
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What the trials of one object cost.

    Attributes
    ----------
    trials, steps: how many, and the engine's steps in all of them.
    setup_s: processor time of making the object, its scene and its grasp, once.
    trial_s, record_s, engine_s: processor time of all trials, of writing them down, and of the bare engine.
    """

    object: str
    trials: int
    steps: int
    setup_s: float
    trial_s: float
    record_s: float
    engine_s: float

    @property
    def engine_share(self) -> float:
        """Trials a second over those that the bare engine would reach."""
        return _share([self])


def _share(costs: Sequence[Cost], *, setup: bool = True) -> float:
    """Return trials a second over those that the bare engine would reach, with or without set-up."""
    spent = sum(c.trial_s + c.record_s + (c.setup_s if setup else 0.0) for c in costs)
    return sum(c.engine_s for c in costs) / spent


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default="all", help="catalogue names, comma-separated (default all)")
    p.add_argument("--protocol", default=DEFAULT, metavar="NAME", help="or a TOML file (default %(default)s)")
    p.add_argument("--trials", type=_cli.positive_int, default=5, help="per object (default %(default)s)")
    p.add_argument("--workers", type=_cli.positive_int, default=2, help="compared with one (default %(default)s)")
    text = "runs of the whole plan with one and with several workers (default %(default)s)"
    p.add_argument("--repeats", type=_cli.non_negative_int, default=1, help=text)
    p.add_common(seed="seed of the first trial", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    names = catalogue_names(args.objects)
    plan = BenchmarkPlan(
        objects=tuple(make_object(name) for name in names),
        trials=args.trials,
        seed=args.seed,
        protocol=load_protocol(args.protocol),
    )
    with tempfile.TemporaryDirectory() as folder, TrialStore(Path(folder) / "run.sqlite", plan) as store:
        costs = [_cost(plan, name, store) for name in tqdm(names, desc="objects", unit="object", disable=None)]
    runs = [_run(plan, n) for _ in range(args.repeats) for n in dict.fromkeys((1, args.workers))]
    shares = [cost.engine_share for cost in costs]
    share, running = _share(costs), _share(costs, setup=False)
    print(_table(costs))
    quartiles = np.percentile(shares, [25, 75])
    print(
        f"all: {share:.3f} of the bare engine's rate, {running:.3f} without set-up; quartiles of the objects "
        f"{quartiles[0]:.3f}, {quartiles[1]:.3f}"
    )
    data: dict[str, Any] = {"engine_share": share, "engine_share_median": median(shares)}
    data["engine_share_without_setup"] = running
    data["objects"] = [{**asdict(cost), "engine_share": cost.engine_share} for cost in costs]
    if runs:
        data |= {"runs": runs, **_gains(runs, args.workers)}
        for row in runs:
            text = (
                "{workers} workers: {trials_per_s:.2f} trials/s, {steady_trials_per_s:.2f} from the first result on, "
            )
            print((text + "{process_s_per_trial:.3f} s of processor a trial").format(**row))
        print(
            f"{args.workers} workers against one: {data['speedup']:.2f} by the clock, {data['steady_speedup']:.2f} from"
            f" the first result on, {data['speedup_of_free_cores']:.2f} if each had a core of its own"
        )
    if args.json is not None:
        _cli.write_json(args.json, {"protocol": plan.protocol.name, "seed": args.seed, "cpus": os.cpu_count(), **data})
    return 0


def _cost(plan: BenchmarkPlan, name: str, store: TrialStore) -> Cost:
    """Run the trials of one object both ways."""
    began = time.process_time()
    setup = prepare_for(plan, make_object(name))
    setup_s = time.process_time() - began
    spent = {"trial": 0.0, "record": 0.0, "engine": 0.0}
    steps = 0
    for turn, seed in enumerate(plan.seeds):
        states = _states(setup, seed)
        found: list[TrialResult] = []

        def trial() -> None:
            found.append(run_trial(setup, seed))  # noqa: B023 - called within this turn of the loop

        def engine() -> None:
            _step_engine(setup, states)  # noqa: B023

        ways: list[tuple[str, Callable[[], None]]] = [("trial", trial), ("engine", engine)]
        for key, way in reversed(ways) if turn % 2 else ways:
            spent[key] += _processor_s(way)
        spent["record"] += _processor_s(lambda: store.add(found[0]))  # noqa: B023
        steps += len(states) * _steps_a_sample(setup)
    return Cost(
        object=name,
        trials=plan.trials,
        steps=steps,
        setup_s=setup_s,
        trial_s=spent["trial"],
        record_s=spent["record"],
        engine_s=spent["engine"],
    )


def _states(setup: TrialSetup, seed: int) -> list[Vector]:
    """Return the engine's full state, its inputs included, after each 20 ms of a trial."""
    model = setup.scene.model
    size, states = mujoco.mj_stateSize(model, _STATE), []

    def watch(simulation: HandSimulation) -> None:
        states.append(np.empty(size))
        mujoco.mj_getState(model, simulation.data, states[-1], _STATE)

    run_trial(setup, seed, watch)
    return states


def _step_engine(setup: TrialSetup, states: Sequence[Vector]) -> None:
    """Step the engine for 20 ms from each state, without a line of Python between the steps."""
    model, count = setup.scene.model, _steps_a_sample(setup)
    data = mujoco.MjData(model)
    for state in states:
        mujoco.mj_setState(model, data, state, _STATE)
        mujoco.mj_step(model, data, count)


def _steps_a_sample(setup: TrialSetup) -> int:
    return max(1, round(SAMPLE_S / float(setup.scene.model.opt.timestep)))


def _processor_s(job: Callable[[], None]) -> float:
    began = time.process_time()
    job()
    return time.process_time() - began


def _run(plan: BenchmarkPlan, workers: int) -> dict[str, float]:
    """Run the whole plan with some workers: rates with the start of the processes, and from the first result on."""
    total = len(plan.objects) * plan.trials
    with tempfile.TemporaryDirectory() as folder, TrialStore(Path(folder) / "run.sqlite", plan) as store:
        began, began_process, came = time.perf_counter(), _all_processes_s(), list[float]()
        for _ in tqdm(run_benchmark(plan, workers, store), total=total, desc=f"{workers} workers", disable=None):
            came.append(time.perf_counter())
        wall_s, process_s = time.perf_counter() - began, _all_processes_s() - began_process
    return {
        "workers": workers,
        "trials": total,
        "trials_per_s": total / wall_s,
        "steady_trials_per_s": (total - 1) / max(came[-1] - came[0], 1e-9),
        "process_s_per_trial": process_s / total,
    }


def _gains(runs: Sequence[dict[str, float]], workers: int) -> dict[str, float]:
    """Return medians over the repeats of what several workers bring against one that ran just before."""
    pairs = list(zip(runs[::2], runs[1::2], strict=True)) if workers > 1 else [(row, row) for row in runs]
    return {
        "trials_per_s": median(several["trials_per_s"] for _, several in pairs),
        "steady_trials_per_s": median(several["steady_trials_per_s"] for _, several in pairs),
        "speedup": median(several["trials_per_s"] / one["trials_per_s"] for one, several in pairs),
        "steady_speedup": median(several["steady_trials_per_s"] / one["steady_trials_per_s"] for one, several in pairs),
        "speedup_of_free_cores": median(
            workers * one["process_s_per_trial"] / several["process_s_per_trial"] for one, several in pairs
        ),
    }


def _all_processes_s() -> float:
    """Return the processor time of this process and of those that it waited for [s]."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


def _table(costs: Sequence[Cost]) -> str:
    heads = ("set-up ms", "trial ms", "record ms", "engine ms", "engine us/step", "share")
    lines = [f"{'object':<18}" + "".join(f"{head:>{len(head) + 2}}" for head in heads)]
    for cost in costs:
        each = 1e3 / cost.trials
        lines.append(
            f"{cost.object:<18}{1e3 * cost.setup_s:>11.0f}{each * cost.trial_s:>10.0f}{each * cost.record_s:>11.2f}"
            f"{each * cost.engine_s:>11.0f}{1e6 * cost.engine_s / cost.steps:>16.0f}{cost.engine_share:>7.3f}"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    raise SystemExit(main())
