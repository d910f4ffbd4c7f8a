"""Effects chosen by the scene: what each is asked, what the tolerance allows, and how far the estimates reach."""

import json
from dataclasses import replace

import numpy as np
import pytest

from scripts.explain_scene import main
from softhand_sim.effects import BENCH, FULL, IDEAL
from softhand_sim.effects.auto import QUESTIONS, choose
from softhand_sim.effects.build import build_pneumatics
from softhand_sim.effects.effects import ACTS_ON
from softhand_sim.effects.gas import GasDynamics
from softhand_sim.effects.omission import omission, run_grasp, without_each
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.grasp.trial import STRESS_SEEDS, facts_of, prepare, survives_more_mass
from softhand_sim.objects.catalogue import make_object
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.tube import Tubing

WIDE = Tolerance(angle_deg=15.0, slip_m=0.03)


@pytest.fixture(scope="module")
def apple(calibration):
    return SceneFacts.of(make_object("apple"), calibration, FULL, survives=lambda: True)


def gentle(facts, angle_deg):
    """The scene with smaller set angles."""
    return replace(facts, set_pa_gauge=np.full(3, facts.calibration.pressure_for_angle(angle_deg)))


def by_name(answers):
    return {answer.name: answer for answer in answers}


def test_every_effect_is_asked_once(apple):
    _, answers = choose(apple, WIDE)
    assert list(QUESTIONS) == list(ACTS_ON) == [answer.name for answer in answers]
    assert all(answer.reason for answer in answers)


def test_no_tolerance_leaves_out_only_what_does_nothing(apple):
    effects, answers = choose(apple, Tolerance(angle_deg=0.0, slip_m=0.0))
    assert effects == FULL
    assert not by_name(answers)["leaks"].active
    assert by_name(answers)["leaks"].omission_error_deg == 0.0
    assert by_name(answers)["leaks"].reason == "no leak is declared"


def test_a_trial_prepared_with_a_tolerance_has_the_chosen_effects(calibration):
    """An apple that is oiled is lost, so everything stays that could change anything."""
    oiled = make_object("apple").with_overrides(friction=0.1)
    assert not survives_more_mass(oiled, calibration, None, STRESS_SEEDS[:1])
    setup = prepare(oiled, calibration, effects=FULL, tolerance=WIDE)
    assert setup.pneumatics == build_pneumatics(FULL, calibration)
    assert by_name(setup.answers)["tube"].active
    assert "may be lost" in by_name(setup.answers)["tube"].reason


def test_wide_tolerance_leaves_the_gas_and_what_cannot_be_told(apple):
    effects, answers = choose(apple, WIDE)
    assert {"gas", "interference", "gravity"} <= set(effects.present)
    assert "tube" not in effects.present
    # whatever happens: the object is lost, a free finger bends by so much
    assert by_name(answers)["gas"].omission_error_deg == apple.loss_deg > 95.0
    assert by_name(answers)["gas"].omission_error_m == 0.15
    gone = [a for a in answers if not a.active]
    assert all(a.omission_error_deg <= WIDE.angle_deg for a in gone)


def test_a_grasp_that_may_fail_has_no_bound_but_the_physical_one(apple):
    shaky = replace(apple, survives=lambda: False)
    effects, answers = choose(shaky, WIDE)
    assert effects == FULL
    assert by_name(answers)["tube"].omission_error_deg == apple.loss_deg
    assert by_name(answers)["leaks"].omission_error_deg == 0.0
    # nobody is asked for trials where no answer depends on them
    choose(replace(apple, survives=pytest.fail), Tolerance(angle_deg=0.5, slip_m=0.5))


def test_slip_counts_as_well_as_angle(apple):
    strict, _ = choose(apple, replace(WIDE, slip_m=1e-3))
    assert set(strict.present) == set(FULL.present)


def test_fingers_that_stay_apart_need_no_pairs(apple):
    """Closed by 20 degrees fingers are far from each other; by 95 thumb and fingers can meet."""
    near, far = (by_name(choose(gentle(apple, a), WIDE)[1])["interference"] for a in (95.0, 20.0))
    assert near.active
    assert not far.active
    assert far.omission_error_deg == 0.0


def test_a_leak_that_is_declared_is_kept_and_a_long_thin_tube_too(apple):
    hole = Leak(finger="index", orifice=Orifice(sonic_conductance_m3_per_s_pa=3e-10), start_s=3.0)
    leaky = SceneFacts(
        calibration=apple.calibration, hand=apple.hand, offered=replace(FULL, leaks=(hole,)),
        set_pa_gauge=apple.set_pa_gauge, closed_s=apple.closed_s, end_s=apple.end_s,
    )  # fmt: skip
    answer = by_name(choose(leaky, WIDE)[1])["leaks"]
    assert answer.active
    assert answer.omission_error_deg > 30.0
    thin = GasDynamics(tubing=Tubing(finger_length_m=20.0, bore_m=1e-3))
    slow = replace(leaky, offered=replace(FULL, gas=thin))
    assert by_name(choose(slow, WIDE)[1])["tube"].omission_error_deg > WIDE.angle_deg


def test_forced_effects_stay_or_go(apple):
    tight = Tolerance(angle_deg=0.0, slip_m=0.0)
    effects, answers = choose(apple, tight, {"gravity": False})
    assert effects == replace(FULL, gravity=None)
    assert by_name(answers)["gravity"].reason.startswith("forced")
    kept, _ = choose(apple, WIDE, {"tube": True})
    assert "tube" in kept.present
    for wrong in ({"tubes": True}, {"leaks": True}):
        with pytest.raises(ValueError, match="force"):
            choose(apple, WIDE, wrong)
    without_gas, _ = choose(apple, WIDE, {"gas": False})
    assert set(without_gas.present) <= {"sliding", "relaxation", "interference", "gravity"}


@pytest.mark.parametrize(
    ("name", "seed", "effects"), [("apple", 7, ("tube", "heat", "gravity")), ("tennis_ball", 4, ("valve_delay",))]
)
def test_estimates_bound_what_running_both_shows(calibration, name, seed, effects):
    model = make_object(name)
    facts = facts_of(model, calibration, FULL, seeds=(seed,))
    answers = by_name(choose(facts, WIDE)[1])
    everything = run_grasp(prepare(model, calibration, effects=FULL), seed)
    for effect in effects:
        without = run_grasp(prepare(model, calibration, effects=without_each(FULL)[effect]), seed)
        change = omission(effect, everything, without)
        assert change.same_outcome or not facts.firm
        assert 0.0 < change.angle_deg <= answers[effect].omission_error_deg
        assert change.slip_m <= answers[effect].omission_error_m


def test_script_writes_the_table(tmp_path, capsys):
    out = tmp_path / "scene.json"
    assert main(["--objects", "apple", "--json", str(out), "--effects", "bench", "--without", "gravity"]) == 0
    data = json.loads(out.read_text())
    rows = {row["name"]: row for row in data["effects"]}
    assert rows["gas"]["omission_error"] > 95.0
    assert rows["gas"]["active"]
    assert not rows["gravity"]["active"]
    assert {"name", "active", "reason", "omission_error"} <= set(rows["sensor"])
    assert "degrees" in capsys.readouterr().out
    # half of the tolerance is the setting's, which is told as well
    assert data["fidelity"]["auto_effects"]["angle_deg"] == 0.5 * data["tolerance_angle_deg"]
    assert data["fidelity"]["measured"]["angle_error_deg"] <= 0.5 * data["tolerance_angle_deg"]
    assert main(["--with", "nothing"]) == 2
    assert "force" in capsys.readouterr().err


def test_bad_tolerance_is_named():
    with pytest.raises(ValueError, match="slip_m"):
        Tolerance(angle_deg=1.0, slip_m=-1.0)


def test_nothing_offered_nothing_asked(calibration):
    facts = SceneFacts.of(make_object("apple"), calibration, IDEAL)
    effects, answers = choose(facts, WIDE)
    assert effects == IDEAL
    assert not any(answer.active for answer in answers)
    assert BENCH.present  # the presets are not changed by asking
