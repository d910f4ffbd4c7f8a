"""Comparing grasps with and without an effect."""

import json
from dataclasses import replace

import numpy as np
import pytest

from scripts.effects_table import main
from softhand_sim.effects import BENCH, FULL
from softhand_sim.effects.auto import choose
from softhand_sim.effects.bare import BareHand
from softhand_sim.effects.omission import SCATTER, omission, run_bare, run_grasp, without_each
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.grasp.trial import prepare
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.catalogue import make_object


def test_each_variant_lacks_one_effect_and_what_needs_it():
    variants = without_each(FULL)
    assert set(variants) == {*FULL.present, SCATTER}
    for name in set(FULL.present) - {"gas"}:
        assert set(variants[name].present) == set(FULL.present) - {name}
    assert set(variants["gas"].present) == {"sliding", "relaxation", "interference", "gravity"}
    assert variants[SCATTER].present == FULL.present


def test_a_grasp_against_itself_and_against_one_moved_by_hand(calibration):
    setup = prepare(make_object("apple"), calibration)
    run = run_grasp(setup, 0)
    # lift 1.5 s, settling 0.3 s and hold 3 s at 50 Hz
    assert len(run.tip_angle_deg) == pytest.approx(4.8 / 0.02, abs=5)
    same = omission("nothing", run, run)
    assert (same.angle_deg, same.slip_m, same.same_outcome, same.time_ratio) == (0.0, 0.0, True, 1.0)
    moved = run.tip_angle_deg.copy()
    moved[17, 3] -= 2.5
    other = omission("x", run, replace(run, tip_angle_deg=moved, verdict="DROPPED"))
    assert other.angle_deg == pytest.approx(2.5, rel=1e-12)
    assert not other.same_outcome
    assert np.isfinite(run.tip_angle_deg).all()


def test_a_lost_object_stays_behind_by_the_lift(calibration):
    """An oiled tennis ball rolls half a metre; what counts is that it is not in the hand."""
    run = run_grasp(prepare(make_object("tennis_ball").with_overrides(friction=0.05), calibration), 0)
    assert run.verdict in ("MISSED", "DROPPED")
    assert run.slip_m == pytest.approx(0.15, abs=1e-12)


def test_script_holds_every_omission_against_what_was_declared(tmp_path, capsys):
    out = tmp_path / "effects.json"
    assert main(["--objects", "apple", "--trials", "1", "--bare", "1", "--effects", "bench", "--json", str(out)]) == 0
    rows = json.loads(out.read_text())["comparisons"]
    assert [row["effect"] for row in rows] == 2 * [*without_each(BENCH)]
    assert [row["scene"] for row in rows[:: len(without_each(BENCH))]] == ["apple", "bare hand"]
    for row in rows:
        assert row["effect"] == SCATTER or row["angle_deg"] <= row["declared_deg"]
        assert row["effect"] == SCATTER or row["slip_m"] <= row["declared_m"]
    assert max(row["angle_deg"] for row in rows) > 1.0
    assert "declared" in capsys.readouterr().out
    assert main(["--objects", "nothing"]) == 2
    assert main(["--effects-alone"]) == 2


def test_a_bare_hand_that_is_held_long_needs_little(calibration):
    """With the tolerance of a few pulses nothing stays but what costs nothing; the angles are those of all effects."""
    scene = BareHand(set_angle_deg=(40.0, 50.0, 30.0), close_s=4.0, hold_s=2.0)
    effects, answers = choose(SceneFacts.bare(scene, calibration, FULL), Tolerance(angle_deg=12.0, slip_m=0.0))
    assert effects.present == ("gravity",)
    full, bare = (run_bare(scene, calibration, e, 1) for e in (FULL, effects))
    change = omission("auto", full, bare)
    assert 0.1 < change.angle_deg < 12.0
    gas = next(answer for answer in answers if answer.name == "gas")
    assert change.angle_deg > 0.0
    assert gas.omission_error_deg < 12.0
    # held for less than it takes to fill, the pressures are not the set ones
    early = SceneFacts.bare(replace(scene, set_angle_deg=(80.0, 80.0, 80.0), close_s=0.5), calibration, FULL)
    assert "gas" in choose(early, Tolerance(angle_deg=12.0, slip_m=0.0))[0].present


def test_bad_bare_hands_are_named():
    with pytest.raises(ValueError, match="set_angle_deg"):
        BareHand(set_angle_deg=(-1.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="hold_s"):
        BareHand(set_angle_deg=(10.0, 10.0, 10.0), hold_s=0.0)


def test_a_tolerance_picks_effects_and_time_step_and_both_together_stay_within_it(tmp_path, capsys):
    out = tmp_path / "auto.json"
    scene = ["--objects", ",", "--bare", "1", "--seed", "300"]
    assert main([*scene, "--auto", "--angle", "15", "--slip", "25", "--json", str(out)]) == 0
    data = json.loads(out.read_text())
    (row,) = data["comparisons"]
    half = data["fidelity"]["auto_effects"]
    assert half == {"angle_deg": 7.5, "slip_m": 0.0125}
    # what is declared is of both: the effects' share of it, and the setting's own error
    setting = data["fidelity"]["measured"]["angle_error_deg"]
    assert setting <= 7.5
    assert row["angle_deg"] <= row["declared_deg"] <= half["angle_deg"] + setting
    assert "gas" not in row["effects_kept"]
    assert 0.0 < row["angle_deg"] <= 15.0
    step_ms = float(capsys.readouterr().out.split("time step ")[1].split(" ms")[0])
    assert step_ms > 1e3 * EngineSettings.timestep_s
