"""Each guard is provoked; its replay file repeats the alarm to the bit; ordinary trials stay far from all of them."""

import dataclasses
import json

import mujoco
import numpy as np
import pytest

from scripts.grasp_benchmark import main
from softhand_sim.effects import BENCH
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.phases.shake import Shake
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.guards.caveats import caveats
from softhand_sim.guards.energy import EnergyBook
from softhand_sim.guards.limits import AlarmKind, Guards
from softhand_sim.guards.plain import NotPlainError, from_plain, to_plain
from softhand_sim.guards.replay import repeat
from softhand_sim.hand.scene import EngineSettings, build_scene
from softhand_sim.objects.catalogue import make_object
from softhand_sim.simulation import HandSimulation

NONE = Guards(energy_j=None, penetration_m=None, past_stop_rad=None, past_pressure_pa=None)
SHORT = dataclasses.replace(load_protocol(), close_s=1.0, phases=(Lift(height_m=0.02), Hold(duration_s=0.1)))


# a search found it: the thumb comes down on the box and is bent backward
PRESSED = GraspPlan(
    wrist_pose=(-0.00121, 0.02643, 0.08013, -1.63167, -0.37076, 0.01443),
    retreat=(0.0, 0.0, 1.0),
    set_angle_deg=(95.0,) * 3,
)


def negative_damping(model):
    model.dof_damping[6:21] = -1e-5


def far_too_stiff(model):
    model.dof_damping[:] = -1e3


def soft_contacts(model):
    model.geom_solref[:, 0] = 0.2


def unchanged(_model):
    pass


SHAKEN = dataclasses.replace(
    SHORT,
    phases=(
        Lift(height_m=0.15),
        Shake(acceleration_m_per_s2=8.0, frequency_hz=3.0, swings=8, x=1.0, needs_object=False),
    ),
)
PROVOKED = {
    "negative damping": (Outcome.UNBALANCED, "apple", SHORT, negative_damping, Guards()),
    "springs too stiff for the step": (Outcome.DIVERGED, "apple", SHORT, far_too_stiff, Guards()),
    "soft contacts": (Outcome.PENETRATED, "apple", SHORT, soft_contacts, Guards()),
    "pressure beyond the calibration": (
        Outcome.EXTRAPOLATED, "apple", dataclasses.replace(SHORT, closing_pressure_pa_gauge=120e3), unchanged, Guards(),
    ),
    "a joint far past its stop": (Outcome.EXTRAPOLATED, "pudding_box", SHORT, unchanged, Guards()),
    "a wrist that a phase drives": (
        Outcome.UNBALANCED, "strawberry", SHAKEN, unchanged, dataclasses.replace(NONE, energy_j=2e-4),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PROVOKED)
def test_each_guard_fires_and_its_file_repeats_the_alarm_to_the_bit(name, calibration, tmp_path):
    outcome, thing, protocol, change, guards = PROVOKED[name]
    plan = PRESSED if thing == "pudding_box" else None
    setup = prepare(make_object(thing), calibration, protocol=protocol, plan=plan)
    setup = dataclasses.replace(setup, guards=guards)
    change(setup.scene.model)
    result = run_trial(setup, 0, replays=tmp_path)
    assert result.outcome is outcome
    assert result.alarm.startswith(outcome.value)
    json.dumps(dataclasses.asdict(result), allow_nan=False)
    again = repeat(tmp_path / result.replay)
    assert again.same
    assert again.saved.kind is AlarmKind(outcome.value)
    assert (again.about["object"], again.about["seed"]) == (thing, 0)


def test_contacts_left_out_for_want_of_memory_are_no_verdict(calibration, tmp_path):
    """24 kB of memory hold no constraints: the engine says so and goes on without, and fingers sink into the apple."""
    setup = prepare(make_object("apple"), calibration, protocol=SHORT)
    xml = setup.scene.xml.replace("<worldbody>", '<size memory="24K"/><worldbody>', 1)
    scene = dataclasses.replace(setup.scene, xml=xml, model=mujoco.MjModel.from_xml_string(xml))
    result = run_trial(dataclasses.replace(setup, scene=scene, guards=NONE), 0, replays=tmp_path)
    assert result.outcome is Outcome.DIVERGED
    assert "warnings_of_full_memory" in result.alarm
    assert result.engine_warnings["mjWARN_CNSTRFULL"] > 0
    again = repeat(tmp_path / result.replay)
    assert again.same
    assert again.seen.quantity == "warnings_of_full_memory"


def test_without_guards_the_same_trials_end_with_a_verdict(calibration):
    """The alarm is the guard's: taken away, the pudding box is a plain miss as before."""
    setup = prepare(make_object("pudding_box"), calibration, protocol=SHORT, plan=PRESSED)
    result = run_trial(dataclasses.replace(setup, guards=NONE), 0)
    assert result.outcome is Outcome.MISSED
    assert result.alarm == ""
    assert min(result.beyond_calibration.values()) < -0.85


def test_an_ordinary_trial_stays_below_a_tenth_of_the_energy_guard(calibration):
    tight = Guards(energy_j=1e-3, penetration_m=5e-4, past_stop_rad=0.05, past_pressure_pa=1e3)
    lemon = make_object("lemon")
    setup = prepare(lemon, calibration, protocol=SHORT, plan=plan_grasp(lemon))
    result = run_trial(dataclasses.replace(setup, guards=tight), 1)
    assert result.alarm == ""
    assert result.outcome in (Outcome.HELD, Outcome.SLIPPED)


def test_energy_book_is_empty_for_a_free_fall_and_counts_a_kick(calibration):
    def ball(root):
        body = root.worldbody.add("body", name="object", pos=(0.3, 0.3, 2.0))
        body.add("freejoint")
        body.add("geom", type="sphere", size=(0.02,), mass=0.1)

    scene = build_scene(calibration, add_object=ball)
    simulation = HandSimulation(model=scene.model, calibration=calibration, pneumatics=None)
    simulation.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.0]))
    book = EnergyBook(scene.model, simulation.data, scene.model.body("object").id)
    for _ in range(10):
        simulation.advance(10)
        assert book.look() < 2e-3
    speed = float(simulation.data.qvel[-4])
    simulation.data.qvel[-4] = speed - 0.5
    kick_j = 0.5 * 0.1 * ((speed - 0.5) ** 2 - speed**2)
    simulation.advance(10)
    # a tenth of what moved is allowed to the rule
    assert 0.85 * kick_j < book.look() < 1.01 * kick_j


def test_settings_that_were_not_verified_are_told(calibration):
    assert caveats(build_scene(calibration).model) == ()
    coarse = build_scene(calibration, engine=EngineSettings(timestep_s=0.004)).model
    assert [line.split(":")[0] for line in caveats(coarse)] == ["UNVERIFIED_STEP", "SOFTENED_CONTACTS"]
    three = build_scene(calibration, engine=EngineSettings(timestep_s=0.003)).model
    assert [line.split(":")[0] for line in caveats(three)] == ["UNVERIFIED_STEP"]


def test_the_benchmark_keeps_a_file_and_repeats_it(tmp_path, capsys):
    protocol = tmp_path / "hard.toml"
    keys = "approach_m = 0.05\nclose_s = 1.0\nsettle_s = 0.1\nclosing_pressure_pa_gauge = 120e3\n"
    protocol.write_text(f'source = "test"\n{keys}[[phase]]\ndo = "lift"\nheight_m = 0.02\n')
    base = ["--objects", "lemon", "--trials", "1", "--no-pictures", "--search", "0", "--protocol", str(protocol)]
    assert main([*base, "--replays", str(tmp_path / "r"), "--json", str(tmp_path / "run.json")]) == 0
    assert "ended by a guard: lemon, seed 0: EXTRAPOLATED" in capsys.readouterr().out
    (trial,) = json.loads((tmp_path / "run.json").read_text())["trials"]
    assert main(["--replay", trial["replay"], "--json", str(tmp_path / "again.json")]) == 0
    assert "the same to the bit" in capsys.readouterr().out
    again = json.loads((tmp_path / "again.json").read_text())
    assert again["same"]
    assert again["seen"]["figure"] == pytest.approx(40e3)
    assert main(["--replay", str(tmp_path / "none.npz")]) == 2


def test_files_that_are_no_replay_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError):
        repeat(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("no archive")
    with pytest.raises(ValueError, match="not a replay file"):
        repeat(tmp_path / "text.npz")
    np.savez(tmp_path / "objects.npz", about=np.array({"a": 1}, dtype=object))
    with pytest.raises(ValueError, match="not a replay file"):
        repeat(tmp_path / "objects.npz")
    np.savez(tmp_path / "other.npz", about=np.array(json.dumps({"format": "x", "format_version": 1})))
    with pytest.raises(ValueError, match="format x 1"):
        repeat(tmp_path / "other.npz")


def test_plain_values_come_back_and_strangers_are_refused():
    values = {"a": (1.0, float("inf"), None, "text"), "b": np.array([[1.5, -0.0]]), "c": Guards(energy_j=0.1)}
    back = from_plain(json.loads(json.dumps(to_plain(values))))
    assert back["a"] == values["a"]
    assert back["b"].tobytes() == values["b"].tobytes()
    assert back["c"] == values["c"]
    with pytest.raises(NotPlainError, match="Stranger has no plain form"):
        to_plain(dataclasses.make_dataclass("Stranger", [])())
    for broken in (
        {"kind": "os"},
        {"kind": "Guards", "values": {"energy_j": -1.0}},
        {"kind": "Guards", "values": {"x": 1}},
    ):
        with pytest.raises(ValueError, match=r"kind|energy_j|Guards"):
            from_plain(broken)


def test_weight_that_the_engine_bears_is_no_energy(calibration):
    """Fingers without weight: their rise in a lift is no work, and no gain either."""
    effects = dataclasses.replace(BENCH, gravity=None)
    lemon = make_object("lemon")
    setup = prepare(lemon, calibration, protocol=SHORT, effects=effects, plan=plan_grasp(lemon))
    assert setup.scene.model.body_gravcomp.any()
    guards = dataclasses.replace(NONE, energy_j=1e-3)
    assert run_trial(dataclasses.replace(setup, guards=guards), 0).alarm == ""
