"""Grasp trials with the fingers of an ensemble."""

import dataclasses
import json

import pytest

from assets import asset_path
from softhand_sim.calibration.integrity import content_sha256
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.objects.catalogue import make_object
from softhand_sim.uncertainty import UncertaintyPlan, grasp_rows, load_ensemble

QUICK = dataclasses.replace(
    load_protocol(), close_s=0.2, settle_s=0.05, phases=(Lift(height_m=0.03), Hold(duration_s=0.1))
)
SHIPPED = json.loads((asset_path("calibration") / "finger.json").read_text())


def cut(content, highest_pa):
    """Return a finger that lost its equilibrium above a pressure."""
    made = {key: value for key, value in content.items() if key != "content_sha256"}
    kept = sum(p <= highest_pa for p in made["curve"]["pressure_pa_gauge"])
    made["curve"] = {name: values[:kept] for name, values in made["curve"].items()}
    return made | {"content_sha256": content_sha256(made)}


@pytest.fixture
def ensemble(tmp_path):
    stiff = json.loads((asset_path("calibration", "ensemble", "solved") / "pair-set1-set1.json").read_text())
    members = [
        {"name": "stiff", "at": None, "file": "stiff.json"},
        {"name": "short", "at": None, "file": "short.json"},
        {"name": "none", "at": None, "refused": "no equilibrium at all"},
    ]
    manifest = {
        "schema": "softhand-sim/calibration-ensemble",
        "schema_version": 1,
        "nominal_sha256": SHIPPED["content_sha256"],
        "sources": [
            {
                "name": "wall",
                "kind": "tolerance",
                "text": "",
                "members": [{"name": "thick", "at": 10.0, "file": "stiff.json"}],
            },
            {"name": "sets", "kind": "scenarios", "text": "", "members": members},
        ],
        "provenance": {},
    }
    for name, content in (("stiff", stiff), ("short", cut(SHIPPED, 60e3)), ("ensemble", manifest)):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    return load_ensemble(tmp_path)


def plan(**changed):
    values = {"objects": (make_object("golf_ball"),), "trials": 1, "fingers": 2, "protocol": QUICK}
    return UncertaintyPlan(**{**values, **changed})


def trials(rows):
    """Return everything but the time that trials took."""
    return [[dataclasses.replace(trial, wall_s=0.0) for trial in row.trials] for row in rows]


def test_rows_do_not_depend_on_the_workers_and_fingers_differ(ensemble, tmp_path):
    alone = list(grasp_rows(ensemble, plan(), tmp_path / "a"))
    beside = list(grasp_rows(ensemble, plan(), tmp_path / "b", workers=2))
    assert trials(alone) == trials(beside)
    assert [row.name for row in alone] == ["nominal", "drawn-00", "drawn-01"]
    assert [row.coordinates for row in alone] == [row.coordinates for row in beside]
    # set to the nominal finger's pressure, a finger that is not the nominal one bends otherwise
    angles = [row.tip_angle_deg_at_set_pressure for row in alone]
    assert angles[0] == pytest.approx(95.0)
    for row in alone[1:]:
        assert (row.tip_angle_deg_at_set_pressure < 95.0) == (row.coordinates["wall"] > 0.0)
    assert len({str(t) for t in trials(alone)}) == 3


def test_without_spread_every_finger_is_the_nominal_one(ensemble, tmp_path):
    rows = list(grasp_rows(ensemble, plan(spread=0.0), tmp_path))
    assert trials(rows)[1] == trials(rows)[2] == trials(rows)[0]


def test_scenarios_beyond_their_calibration_have_a_reason_and_no_trials(ensemble, tmp_path):
    rows = {row.name: row for row in grasp_rows(ensemble, plan(fingers=1, scenarios=("sets",)), tmp_path)}
    assert rows["stiff"].tip_angle_deg_at_set_pressure < 30.0
    assert len(rows["stiff"].trials) == 1
    assert rows["short"].refused == "set to 74.6 kPa, calibrated up to 60 kPa"
    assert rows["none"].refused == "no equilibrium at all"
    assert rows["short"].trials == rows["none"].trials == ()


def test_a_controller_that_knows_the_finger_sets_its_own_pressure(ensemble, tmp_path):
    known = plan(fingers=1, scenarios=("sets",), known_finger=True)
    rows = {row.name: row for row in grasp_rows(ensemble, known, tmp_path)}
    # it does not bend to the angle asked for below 60 kPa, and gets the highest pressure that it was calibrated for
    assert rows["short"].tip_angle_deg_at_set_pressure == pytest.approx(SHIPPED_AT_60_DEG)
    assert rows["drawn-00"].tip_angle_deg_at_set_pressure == pytest.approx(95.0, abs=1e-6)


SHIPPED_AT_60_DEG = SHIPPED["curve"]["tip_angle_deg"][SHIPPED["curve"]["pressure_pa_gauge"].index(60e3)]


def test_the_controller_holds_what_its_own_calibration_says(ensemble):
    nominal, stiff = ensemble.nominal.calibration, ensemble.sources[1].members[0].calibration

    def highest_set(control):
        seen = []
        setup = prepare(make_object("golf_ball"), stiff, protocol=QUICK, control=control)
        run_trial(setup, 0, lambda simulation: seen.append(float(simulation.set_pressure_pa_gauge.max())))
        return max(seen), max(setup.plan.set_angle_deg)

    pressure_pa, angle_deg = highest_set(nominal)
    assert pressure_pa == pytest.approx(nominal.pressure_for_angle(angle_deg))
    # the stiff finger bends to less than that: its own calibration asks for its highest pressure
    assert highest_set(None)[0] == pytest.approx(80e3)


def test_bad_plans_are_named(ensemble, tmp_path):
    with pytest.raises(ValueError, match=r"scenarios: 'weather' is not one of \['sets'\]"):
        list(grasp_rows(ensemble, plan(scenarios=("weather",)), tmp_path))
    with pytest.raises(ValueError, match="fingers: 0, trials: 1 must be 1 or above"):
        plan(fingers=0)
