"""Worker processes that run trials; one that dies is replaced, and its trial repeated once."""

import multiprocessing
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from softhand_sim.benchmark.plan import BenchmarkPlan, Shard, run_shard
from softhand_sim.grasp.result import TrialResult, crashed
from softhand_sim.grasp.trial import TrialSetup

ATTEMPTS = 2
"""Times that a trial is tried whose worker dies; after that it is recorded as crashed."""


@dataclass(kw_only=True)
class _Worker:
    """One process and the trials it still owes, the running one first."""

    process: SpawnProcess
    pipe: Connection
    shard: Shard | None = None
    owed: deque[int] = field(default_factory=deque)


def run_shards(plan: BenchmarkPlan, shards: Sequence[Shard], workers: int) -> Iterator[TrialResult]:
    """Yield the results of all trials of the shards, as they come.

    Raises
    ------
    RuntimeError
        If a trial raises an error of its own (not if its process dies); the message is the error's.
    """
    waiting = deque(shards)
    deaths: dict[tuple[str, int], int] = {}
    crew: list[_Worker] = []
    try:
        while waiting or crew:
            while waiting and len(crew) < workers:
                crew.append(_hire(plan))
                _give(crew[-1], waiting.popleft())
            ready = wait([worker.pipe for worker in crew] + [worker.process.sentinel for worker in crew])
            for worker in list(crew):
                if worker.pipe not in ready and worker.process.sentinel not in ready:
                    continue
                result = _receive(worker)
                if result is not None:
                    worker.owed.popleft()
                    yield result
                else:
                    crew.remove(worker)
                    _dismiss(worker)
                    yield from _mourn(plan, worker, waiting, deaths)
                    continue
                if not worker.owed:
                    if waiting:
                        _give(worker, waiting.popleft())
                    else:
                        crew.remove(worker)
                        _dismiss(worker)
    finally:
        for worker in crew:
            worker.process.kill()
            _dismiss(worker)


def _hire(plan: BenchmarkPlan) -> _Worker:
    # spawn: a forked child would inherit the parent's GL and BLAS threads
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there, plan.without_objects()), daemon=True)
    process.start()
    there.close()
    return _Worker(process=process, pipe=here)


def _give(worker: _Worker, shard: Shard) -> None:
    worker.shard, worker.owed = shard, deque(shard.seeds)
    with suppress(OSError):  # it is dead: its sentinel says so next
        worker.pipe.send(shard)


def _receive(worker: _Worker) -> TrialResult | None:
    """Return a worker's next result, or None if it is dead."""
    try:
        if not worker.pipe.poll() and not worker.process.is_alive():
            return None
        answer = worker.pipe.recv()
    except (EOFError, OSError):
        return None
    if isinstance(answer, str):
        raise RuntimeError(answer)
    assert isinstance(answer, TrialResult)
    return answer


def _mourn(
    plan: BenchmarkPlan, worker: _Worker, waiting: deque[Shard], deaths: dict[tuple[str, int], int]
) -> Iterator[TrialResult]:
    """Put a dead worker's trials back; yield the one it died of if that was its last attempt."""
    if worker.shard is None or not worker.owed:
        return
    model, fatal = worker.shard.model, worker.owed[0]
    deaths[model.name, fatal] = deaths.get((model.name, fatal), 0) + 1
    if deaths[model.name, fatal] >= ATTEMPTS:
        worker.owed.popleft()
        yield crashed(model, plan.protocol, fatal)
    if worker.owed:
        waiting.appendleft(Shard(model=model, seeds=tuple(worker.owed)))


def _dismiss(worker: _Worker) -> None:
    worker.pipe.close()
    worker.process.join()


def _serve(pipe: Connection, plan: BenchmarkPlan) -> None:
    """Run shards until the pipe closes; the body of a worker process."""
    setup: TrialSetup | None = None
    try:
        while True:
            shard: Shard = pipe.recv()
            setup, results = run_shard(plan, shard, setup)
            for result in results:
                pipe.send(result)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        pass  # the main process has ended
    except Exception as error:  # sent on, so that the run ends with its reason
        pipe.send(f"{type(error).__name__}: {error}")
