"""Comparing grasps with and without an effect."""

import json
from dataclasses import replace

import numpy as np
import pytest

from scripts.effects_table import main
from softhand_sim.effects import BENCH, FULL
from softhand_sim.effects.omission import SCATTER, grasp, omission, without_each
from softhand_sim.objects.catalogue import make_object


def test_each_variant_lacks_one_effect_and_what_needs_it():
    variants = without_each(FULL)
    assert set(variants) == {*FULL.present, SCATTER}
    for name in set(FULL.present) - {"gas"}:
        assert set(variants[name].present) == set(FULL.present) - {name}
    assert set(variants["gas"].present) == {"sliding", "relaxation", "interference", "gravity"}
    assert variants[SCATTER].present == FULL.present


def test_a_grasp_against_itself_and_against_one_moved_by_hand(calibration):
    run = grasp(make_object("apple"), calibration, BENCH, 0)
    # lift 1.5 s, settling 0.3 s and hold 3 s at 50 Hz
    assert len(run.tip_angle_deg) == pytest.approx(4.8 / 0.02, abs=5)
    same = omission("nothing", run, run)
    assert (same.angle_deg, same.slip_m, same.same_outcome, same.time_ratio) == (0.0, 0.0, True, 1.0)
    moved = run.tip_angle_deg.copy()
    moved[17, 3] -= 2.5
    other = omission("x", run, replace(run, tip_angle_deg=moved))
    assert other.angle_deg == pytest.approx(2.5, rel=1e-12)
    assert np.isfinite(run.tip_angle_deg).all()


def test_script_writes_every_comparison(tmp_path, capsys):
    out = tmp_path / "effects.json"
    assert main(["--objects", "apple", "--trials", "1", "--effects", "bench", "--json", str(out)]) == 0
    rows = json.loads(out.read_text())["comparisons"]
    assert [row["effect"] for row in rows] == [*without_each(BENCH)]
    assert {"object", "seed", "angle_deg", "slip_m", "same_outcome"} <= set(rows[0])
    assert "other verdict" in capsys.readouterr().out
    assert main(["--objects", "nothing"]) == 2


def test_script_compares_what_a_scene_chooses(tmp_path):
    out = tmp_path / "auto.json"
    assert main(["--objects", "apple", "--trials", "1", "--auto", "--json", str(out)]) == 0
    (row,) = json.loads(out.read_text())["comparisons"]
    assert row["effect"] == "auto"
    assert "gas" in row["effects_kept"]
    assert "tube" not in row["effects_kept"]
    assert row["same_outcome"]
    assert row["angle_deg"] <= 12.0
