"""Runs that are killed: no trial is lost, none is made twice, the table is that of an unbroken run."""

import dataclasses
import json
import multiprocessing
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from softhand_sim.benchmark import plan as planning
from softhand_sim.benchmark.plan import BenchmarkPlan, tapered
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.benchmark.store import TrialStore
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.stage import Stage
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

QUICK = dataclasses.replace(
    load_protocol(), close_s=0.2, settle_s=0.05, phases=(Lift(height_m=0.03), Hold(duration_s=0.1))
)


@dataclass(frozen=True, kw_only=True)
class Deadly:
    """Kills its process: always, or only while a file is not there yet."""

    needs_object: bool = False
    unless: Path | None = None

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        if stage.simulation.data.time >= 0.0 and (self.unless is None or not self.unless.exists()):
            if self.unless is not None:
                self.unless.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        yield lambda: True


def plan(**changes):
    values = {"objects": (make_object("golf_ball"), make_object("puzzle_cube")), "trials": 6, "protocol": QUICK}
    return BenchmarkPlan(**{**values, **changes})


def figures(results, a_plan):
    return [dataclasses.replace(result, wall_s=0.0) for result in in_order(a_plan, list(results))]


@pytest.fixture(scope="module")
def unbroken():
    return figures(run_benchmark(plan()), plan())


def test_a_second_run_makes_nothing_twice_and_an_interrupted_one_goes_on(tmp_path, unbroken, monkeypatch):
    path = tmp_path / "run.sqlite"
    with TrialStore(path, plan()) as store:
        running = run_benchmark(plan(), 1, store)
        for _ in range(5):
            next(running)
        running.close()
    made = []
    real = planning.run_trial
    monkeypatch.setattr(
        planning, "run_trial", lambda setup, seed, **more: (made.append(seed), real(setup, seed, **more))[1]
    )
    with TrialStore(path, plan()) as store:
        assert figures(run_benchmark(plan(), 1, store), plan()) == unbroken
        assert len(made) == 12 - 5
        # more trials are added to the same file
        assert len(list(run_benchmark(plan(trials=7), 1, store))) == 14
        assert len(made) == 12 - 5 + 2
    with sqlite3.connect(path) as base:
        assert base.execute("PRAGMA journal_mode").fetchone() == ("wal",)
        assert base.execute("SELECT count(*), count(DISTINCT object || seed) FROM trials").fetchone() == (14, 14)


def test_other_conditions_other_objects_and_a_second_writer_are_refused(tmp_path):
    path = tmp_path / "run.sqlite"
    with TrialStore(path, plan()), pytest.raises(ValueError, match="another run writes"):
        TrialStore(path, plan())
    with pytest.raises(ValueError, match=r"other conditions \(protocol\)"):
        TrialStore(path, plan(protocol=load_protocol()))
    heavy = make_object("golf_ball").with_overrides(mass_kg=0.1)
    with pytest.raises(ValueError, match="another object or grasp called 'golf_ball'"):
        TrialStore(path, plan(objects=(heavy,)))
    elsewhere = GraspPlan(wrist_pose=(0.0, 0.0, 0.2, 0.0, 0.0, 0.0), retreat=(0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match="another object or grasp called 'golf_ball'"):
        TrialStore(path, plan(grasps={"golf_ball": elsewhere}))
    (tmp_path / "letter.sqlite").write_text("Dear sir or madam, " * 100, encoding="utf-8")
    with pytest.raises(ValueError, match=r"letter\.sqlite"):
        TrialStore(tmp_path / "letter.sqlite", plan())
    with TrialStore(path, plan()) as store:
        result = next(run_benchmark(plan(trials=1), 1, store))
        with pytest.raises(sqlite3.IntegrityError):
            store.add(result)


def test_shards_get_shorter_towards_the_end_and_hold_the_same_trials():
    whole = plan(trials=20)
    shards = whole.shards(frozenset(whole.trial_keys))
    pieces = tapered(shards, 2)
    assert [(p.model.name, seed) for p in pieces for seed in p.seeds] == list(whole.trial_keys)
    sizes = [len(piece.seeds) for piece in pieces]
    left = [sum(sizes[i:]) for i in range(len(sizes))]
    assert all(size <= max(1, rest // 6) for size, rest in zip(sizes, left, strict=True))
    assert sizes[0] == 5
    assert sizes[-6:] == [1] * 6


def test_a_killed_worker_is_replaced_and_loses_nothing(unbroken):
    results = []
    for result in run_benchmark(plan(), 2):
        results.append(result)
        if len(results) in (1, 4):
            # the elder: the younger one may have the trial that the first victim died of
            os.kill(min(child.pid for child in multiprocessing.active_children()), signal.SIGKILL)
    assert figures(results, plan()) == unbroken
    assert multiprocessing.active_children() == []


def test_a_trial_whose_worker_dies_is_repeated_once_and_then_recorded_as_crashed(tmp_path):
    def outcomes(phase):
        a_plan = plan(
            objects=(make_object("golf_ball"),),
            trials=2,
            protocol=dataclasses.replace(QUICK, phases=(*QUICK.phases, phase)),
        )
        with TrialStore(tmp_path / f"{phase.unless is None}.sqlite", a_plan) as store:
            results = in_order(a_plan, list(run_benchmark(a_plan, 2, store)))
            assert len(list(store.results())) == 2
        return [result.outcome for result in results]

    assert outcomes(Deadly()) == [Outcome.CRASHED] * 2
    assert Outcome.CRASHED not in outcomes(Deadly(unless=tmp_path / "once"))


def test_a_trial_s_own_error_ends_the_run_with_its_reason():
    broken = dataclasses.replace(make_object("golf_ball"), convex_parts=("no mesh",))
    broken = dataclasses.replace(broken, primitive=None)
    with pytest.raises(RuntimeError, match="AttributeError"):
        list(run_benchmark(plan(objects=(broken,)), 2))
    assert multiprocessing.active_children() == []


def test_a_killed_main_process_goes_on_where_it_was(tmp_path):
    """The command line, `kill -9` of the main process while trials run, the same line again."""
    protocol = tmp_path / "quick.toml"
    protocol.write_text(
        'source = "test"\napproach_m = 0.05\nclose_s = 0.2\nsettle_s = 0.05\n'
        "[offsets]\nposition_m = 0.01\nyaw_rad = 0.1\n"
        '[[phase]]\ndo = "lift"\nheight_m = 0.03\n[[phase]]\ndo = "hold"\nduration_s = 0.1\n',
        encoding="utf-8",
    )
    line = [sys.executable, "-m", "scripts.grasp_benchmark", "--objects", "golf_ball,puzzle_cube", "--trials", "6"]
    line += ["--protocol", str(protocol), "--no-pictures"]
    store = tmp_path / "run.sqlite"
    broken = [*line, "--workers", "2", "--store", str(store), "--json", str(tmp_path / "broken.json")]
    first = subprocess.Popen(broken, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        kept = 0
        deadline = time.monotonic() + 600.0
        while kept < 2 and time.monotonic() < deadline and first.poll() is None:
            time.sleep(0.02)
            kept = _count(store)
    finally:
        first.kill()
        first.wait()
    assert 2 <= kept < 12
    again = _count(store)
    subprocess.run(broken, check=True, capture_output=True)
    subprocess.run([*line, "--json", str(tmp_path / "whole.json")], check=True, capture_output=True)
    assert 2 <= again < _count(store) == 12
    tables = []
    for name in ("broken", "whole"):
        data = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
        tables.append([{**row, "wall_s": 0.0} for row in data["trials"]])
    assert tables[0] == tables[1]


def _count(store):
    try:
        with sqlite3.connect(f"file:{store}?mode=ro", uri=True) as base:
            return base.execute("SELECT count(*) FROM trials").fetchone()[0]
    except sqlite3.OperationalError:  # not made yet
        return 0
