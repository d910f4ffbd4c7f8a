"""Ray: the rows of local processes, whoever dies."""

import dataclasses
import os
import signal
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import ray

from scripts import grasp_benchmark
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.benchmark.store import TrialStore, conditions
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.stage import Stage
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object


@dataclass(frozen=True, kw_only=True)
class DeadlyOnce:
    """Kills its process the first time, unless its file is there; always without a file."""

    flag: Path | None
    needs_object: bool = False

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        if stage.simulation.data.time >= 0.0 and (self.flag is None or not self.flag.exists()):
            if self.flag is not None:
                self.flag.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        yield lambda: True


def plan(flag, **changes):
    phases = (Lift(height_m=0.03), Hold(duration_s=0.1), DeadlyOnce(flag=flag))
    quick = dataclasses.replace(load_protocol(), close_s=0.2, settle_s=0.05, phases=phases)
    values = {"objects": (make_object("golf_ball"), make_object("puzzle_cube")), "trials": 6, "protocol": quick}
    return BenchmarkPlan(**{**values, **changes})


def figures(results, a_plan):
    return [dataclasses.replace(result, wall_s=0.0) for result in in_order(a_plan, list(results))]


@pytest.fixture(scope="module", autouse=True)
def cluster():
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    ray.init(address="local", num_cpus=2, include_dashboard=False, log_to_driver=False)
    # workers cannot import this file
    ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
    yield
    ray.shutdown()


def test_two_workers_of_which_one_is_killed_give_the_rows_of_local_processes(tmp_path):
    a_plan = plan(tmp_path / "flag")
    with TrialStore(tmp_path / "run.sqlite", a_plan) as store:
        remote = figures(run_benchmark(a_plan, 2, store, ray_address="local"), a_plan)
        assert (tmp_path / "flag").exists()
        assert len(list(store.results())) == 12
    assert Outcome.CRASHED not in {result.outcome for result in remote}
    assert remote == figures(run_benchmark(a_plan), a_plan)


def test_a_trial_that_kills_its_worker_twice_is_recorded_as_crashed():
    a_plan = plan(None, objects=(make_object("golf_ball"),), trials=1)
    assert [result.outcome for result in run_benchmark(a_plan, 2, ray_address="local")] == [Outcome.CRASHED]


def test_a_trial_s_own_error_ends_the_run_with_its_reason():
    broken = dataclasses.replace(make_object("golf_ball"), convex_parts=("no mesh",), primitive=None)
    with pytest.raises(RuntimeError, match="AttributeError"):
        list(run_benchmark(plan(None, objects=(broken,)), 2, ray_address="local"))


def test_a_node_of_other_versions_is_refused(monkeypatch):
    a_plan = plan(None, objects=(make_object("golf_ball"),), trials=1)
    other = {**conditions(a_plan), "mujoco_version": "1.0"}
    monkeypatch.setattr("softhand_sim.benchmark.ray_engine.conditions", lambda _plan: other)
    with pytest.raises(RuntimeError, match="differs in mujoco_version"):
        list(run_benchmark(a_plan, 1, ray_address="local"))


def test_wrong_calls_are_refused_before_any_work(capsys, monkeypatch):
    assert grasp_benchmark.main(["--objects", "apple", "--ray-address", "auto"]) == 2
    assert "needs --engine ray" in capsys.readouterr().err
    monkeypatch.setattr("softhand_sim.benchmark.ray_engine.find_spec", lambda _name: None)
    assert grasp_benchmark.main(["--objects", "apple", "--engine", "ray"]) == 2
    assert "softhand-sim[ray]" in capsys.readouterr().err
