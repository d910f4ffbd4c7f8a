"""Trials on a Ray cluster: the shards of the local processes, run by actors; one that dies is replaced.

Every node needs this package, in the same versions, and the calibration file at the same path; each actor checks it.
"""

import os
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

from softhand_sim.benchmark.plan import BenchmarkPlan, Shard, prepare_for
from softhand_sim.benchmark.store import conditions
from softhand_sim.benchmark.workers import ATTEMPTS
from softhand_sim.grasp.result import TrialResult, crashed
from softhand_sim.grasp.trial import TrialSetup, run_trial
from softhand_sim.objects.model import ObjectModel

LOCAL = "local"


class RayWorker:
    """Runs single trials; the body of an actor."""

    def __init__(self, plan: BenchmarkPlan, expected: dict[str, Any]) -> None:
        own = conditions(plan)
        if differing := sorted(key for key in expected if own.get(key) != expected[key]):
            raise RuntimeError(f"a node of the cluster differs in {', '.join(differing)}")
        self._plan = plan
        self._setup: TrialSetup | None = None

    def trial(self, model: ObjectModel, seed: int) -> TrialResult:
        """Run one trial; what trials of an object share is kept until the object changes."""
        if self._setup is None or self._setup.model.name != model.name:
            self._setup = prepare_for(self._plan, model)
        return run_trial(self._setup, seed, replays=self._plan.replays)


@dataclass(kw_only=True)
class _Hired:
    """One actor and the trials it still owes, the running one first, as seed and reference."""

    actor: Any
    shard: Shard
    owed: deque[tuple[int, Any]] = field(default_factory=deque)


def require_ray() -> Any:
    """Return the Ray module.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    if find_spec("ray") is None:
        raise ValueError("--engine ray: Ray is missing (pip install 'softhand-sim[ray]')")
    # no report of its use leaves the machine
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    import ray  # noqa: PLC0415 - optional dependency

    return ray


def run_on_ray(
    plan: BenchmarkPlan, shards: Sequence[Shard], workers: int, address: str = LOCAL
) -> Iterator[TrialResult]:
    """Yield the results of all trials of the shards, as they come.

    Parameters
    ----------
    plan, shards: what to run.
    workers: actors side by side, of one processor each.
    address: of the cluster; ``local`` starts one of `workers` processors on this machine and stops it at the end. A
        connection that exists already is used, whatever the address.

    Raises
    ------
    ValueError
        If Ray is missing, or nothing answers at the address.
    RuntimeError
        If a trial raises an error of its own (not if its process dies), or a node has other versions.
    """
    ray = require_ray()
    connected = ray.is_initialized()
    if not connected:
        more = {"num_cpus": workers, "include_dashboard": False} if address == LOCAL else {}
        try:
            ray.init(address=address, log_to_driver=False, **more)
        except (ConnectionError, RuntimeError) as error:
            raise ValueError(f"--ray-address {address}: {' '.join(str(error).split())}") from error
    try:
        yield from _run(ray, plan, shards, workers)
    finally:
        if not connected:
            ray.shutdown()


def _run(ray: Any, plan: BenchmarkPlan, shards: Sequence[Shard], workers: int) -> Iterator[TrialResult]:
    waiting, crew = deque(shards), list[_Hired]()
    deaths: dict[tuple[str, int], int] = {}
    hire = ray.remote(num_cpus=1, max_restarts=0)(RayWorker).remote
    lone, expected = plan.without_objects(), conditions(plan)
    models = {model.name: ray.put(model) for model in plan.objects}
    try:
        while waiting or crew:
            while waiting and len(crew) < workers:
                crew.append(_give(hire(lone, expected), waiting.popleft(), models))
            ready, _ = ray.wait([one.owed[0][1] for one in crew])
            one = next(one for one in crew if one.owed[0][1] == ready[0])
            try:
                result = ray.get(ready[0])
            except ray.exceptions.RayTaskError as error:
                raise RuntimeError(f"{type(error.cause).__name__}: {error.cause}") from error
            except ray.exceptions.RayActorError as error:
                if error.actor_init_failed:
                    raise RuntimeError(f"a worker cannot start: {str(error).strip().splitlines()[-1]}") from error
                crew.remove(one)
                yield from _mourn(plan, one, waiting, deaths)
                continue
            one.owed.popleft()
            yield result
            if not one.owed:
                crew.remove(one)
                if waiting:
                    crew.append(_give(one.actor, waiting.popleft(), models))
    finally:
        for one in crew:
            ray.kill(one.actor)


def _give(actor: Any, shard: Shard, models: dict[str, Any]) -> _Hired:
    owed = deque((seed, actor.trial.remote(models[shard.model.name], seed)) for seed in shard.seeds)
    return _Hired(actor=actor, shard=shard, owed=owed)


def _mourn(
    plan: BenchmarkPlan, one: _Hired, waiting: deque[Shard], deaths: dict[tuple[str, int], int]
) -> Iterator[TrialResult]:
    """Put a dead actor's trials back; yield the one it died of if that was its last attempt."""
    model, seeds = one.shard.model, [seed for seed, _ in one.owed]
    deaths[model.name, seeds[0]] = deaths.get((model.name, seeds[0]), 0) + 1
    if deaths[model.name, seeds[0]] >= ATTEMPTS:
        yield crashed(model, plan.protocol, seeds.pop(0))
    if seeds:
        waiting.appendleft(Shard(model=model, seeds=tuple(seeds)))
