"""The check on the time step: which trials, which engine, what counts as a flipped verdict."""

import dataclasses
import json

import pytest

from scripts import grasp_benchmark
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.runner import run_benchmark
from softhand_sim.benchmark.step_check import NOSLIP_ITERATIONS, compare, drawn, finer, repeat
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import crashed
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

QUICK = dataclasses.replace(
    load_protocol(), close_s=0.2, settle_s=0.05, phases=(Lift(height_m=0.03), Hold(duration_s=0.1))
)
PLAN = BenchmarkPlan(objects=(make_object("golf_ball"), make_object("puzzle_cube")), trials=20, protocol=QUICK)


def results(outcome):
    return [
        dataclasses.replace(crashed(model, QUICK, seed), outcome=outcome)
        for model in PLAN.objects
        for seed in range(20)
    ]


def test_the_repeated_trials_are_drawn_without_repetition_and_never_crashed_ones():
    all_held = results(Outcome.HELD)
    keys = drawn(all_held, 15, seed=3)
    assert len(keys) == 15
    assert keys == drawn(all_held, 15, seed=3) != drawn(all_held, 15, seed=4)
    assert len(drawn(all_held, 500, seed=0)) == 40
    half = [dataclasses.replace(r, outcome=Outcome.CRASHED) if r.seed % 2 else r for r in all_held]
    assert {seed % 2 for _, seed in drawn(half, 20, seed=0)} == {0}


def test_every_changed_verdict_is_a_flip_and_those_of_held_are_counted():
    first = results(Outcome.HELD)
    fine = [
        dataclasses.replace(r, outcome={0: Outcome.SLIPPED, 1: Outcome.DROPPED}.get(r.seed, r.outcome)) for r in first
    ]
    check = compare(first, fine)
    assert check.trials == 40
    assert check.flipped == tuple(
        (name, seed, "HELD", other)
        for name in ("golf_ball", "puzzle_cube")
        for seed, other in ((0, "SLIPPED"), (1, "DROPPED"))
    )
    assert check.held_flipped == 4
    lost = compare(results(Outcome.MISSED), results(Outcome.DROPPED))
    assert (len(lost.flipped), lost.held_flipped) == (40, 0)
    assert lost.data()["flipped_share"] == 1.0
    with pytest.raises(ValueError, match="no trial was repeated"):
        compare(first, [])


def test_the_repeated_trials_run_with_a_quarter_of_the_step():
    fine = finer(PLAN)
    assert fine.engine.timestep_s == pytest.approx(PLAN.engine.timestep_s / 4)
    assert fine.engine.noslip_iterations == NOSLIP_ITERATIONS > PLAN.engine.noslip_iterations
    key = ("puzzle_cube", 7)
    (once,) = list(repeat(PLAN, frozenset({key})))
    (again,) = list(run_benchmark(fine, only=frozenset({key})))
    (coarse,) = list(run_benchmark(PLAN, only=frozenset({key})))
    assert (once.object, once.seed) == key
    assert dataclasses.replace(once, wall_s=0.0) == dataclasses.replace(again, wall_s=0.0)
    # the same trial: the same offset of the object
    assert coarse.object_offset_m == once.object_offset_m
    assert coarse.lift_m != once.lift_m


def test_the_command_line_reports_the_flips(tmp_path, capsys):
    out, store = tmp_path / "out.json", tmp_path / "run.sqlite"
    protocol = tmp_path / "quick.toml"
    protocol.write_text(
        'source = "test"\napproach_m = 0.05\nclose_s = 0.2\nsettle_s = 0.05\n'
        '[[phase]]\ndo = "lift"\nheight_m = 0.03\n[[phase]]\ndo = "hold"\nduration_s = 0.1\n',
        encoding="utf-8",
    )
    argv = ["--objects", "golf_ball", "--trials", "2", "--protocol", str(protocol), "--check-steps", "1"]
    argv += ["--no-pictures", "--json", str(out), "--store", str(store)]
    assert grasp_benchmark.main(argv) == 0
    check = json.loads(out.read_text())["step_check"]
    assert check["trials"] == 1
    assert check["wilson_low"] <= check["flipped_share"] <= check["wilson_high"]
    assert "of 1 verdicts differ" in capsys.readouterr().out
    assert (tmp_path / "run.sqlite.steps").is_file()
    assert grasp_benchmark.main([*argv, "--timestep", "0.2"]) == 2
