"""Effects: absent equals never written, present changes something, each alone; and what contradicts itself."""

import re
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from softhand_sim.effects import BENCH, FULL, IDEAL, PRESETS, Effects
from softhand_sim.effects.build import apply_to_model, build_losses, build_pneumatics
from softhand_sim.effects.effects import ACTS_ON
from softhand_sim.effects.gas import GasDynamics
from softhand_sim.effects.interference import FingerInterference
from softhand_sim.elements import ELEMENTS, FINGERS
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.losses import Losses
from softhand_sim.objects.catalogue import make_object
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.pneumatics.system import PneumaticSystem, default_elements
from softhand_sim.pneumatics.tube import Tubing
from softhand_sim.relaxation import CONDITIONED_SILICONE
from softhand_sim.simulation import HandSimulation, default_pneumatics

HOLE = (Leak(finger="index", start_s=0.3),)
EVERYTHING = replace(FULL, leaks=HOLE)
NAMES = tuple(ACTS_ON)
DECLARED = {"relief", "pads"}
"""Effects of no preset, which have tests of their own."""


def closing(model, calibration, pneumatics, losses=None, seconds=0.8, set_pa=60e3):
    """Joint angles (n, 15) and pressures (n, 3) of a hand that closes to one set pressure, palm down in the air."""
    simulation = HandSimulation(model=model, calibration=calibration, pneumatics=pneumatics, losses=losses)
    simulation.reset(np.random.default_rng(3), np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.0]))
    simulation.set_pressure_pa_gauge = np.array([set_pa, 0.7 * set_pa, set_pa])
    rows = []
    for _ in range(round(seconds / simulation.dt)):
        simulation.step()
        rows.append([*simulation.data.qpos[simulation.index.joint_qpos].ravel(), *simulation.pressure_pa_gauge()])
    return np.array(rows)


def run(effects, calibration, **kwargs):
    root = build_root(calibration)
    apply_to_model(effects, root)
    losses = build_losses(effects, calibration)
    return closing(compile_scene(root).model, calibration, build_pneumatics(effects, calibration), losses, **kwargs)


def test_presets_and_registry_name_every_effect():
    assert set(IDEAL.present) == set()
    assert set(BENCH.present) == {"gas", "sensor", "sliding", "interference", "gravity"}
    assert set(FULL.present) == set(NAMES) - {"leaks"} - DECLARED
    assert set(EVERYTHING.present) == set(NAMES) - DECLARED
    assert list(PRESETS) == ["ideal", "bench", "full"]


def test_bench_is_what_was_there_before_effects(calibration):
    """Same parameters, same model, same trajectory to the bit as a simulation that never heard of effects."""
    assert build_pneumatics(BENCH, calibration) == default_pneumatics(calibration)
    plain = closing(compile_scene(build_root(calibration)).model, calibration, default_pneumatics(calibration))
    assert run(BENCH, calibration).tobytes() == plain.tobytes()


def test_bench_trial_is_a_trial_without_effects(calibration):
    apple = make_object("apple")
    one, other = (run_trial(prepare(apple, calibration, **more), seed=1) for more in ({}, {"effects": BENCH}))
    assert replace(one, wall_s=0.0) == replace(other, wall_s=0.0)


WRITTEN_BY_HAND = {
    "leaks": lambda full: PneumaticSystem(
        elements=full.elements, sensor=full.sensor, controller=full.controller, delay=full.delay, supply=full.supply
    ),
    "supply": lambda full: PneumaticSystem(
        elements=full.elements, sensor=full.sensor, controller=full.controller, delay=full.delay, leaks=full.leaks
    ),
    "valve_delay": lambda full: PneumaticSystem(
        elements=full.elements, sensor=full.sensor, leaks=full.leaks, supply=full.supply
    ),
    "tube": lambda full: replace(full, elements=tuple(replace(e, tubing=None) for e in full.elements)),
    "heat": lambda full: replace(full, elements=tuple(replace(e, thermal=None) for e in full.elements)),
    "sensor": lambda full: replace(full, sensor=None),
}
"""The system with everything, put together without one effect by other means than `Effects`."""


@pytest.mark.parametrize("name", WRITTEN_BY_HAND)
def test_absent_equals_never_written(calibration, name):
    with_all = build_pneumatics(EVERYTHING, calibration)
    without = replace(EVERYTHING, **{name: None})
    model = compile_scene(build_root(calibration)).model
    losses = Losses.of(calibration, CONDITIONED_SILICONE)
    expected = closing(model, calibration, WRITTEN_BY_HAND[name](with_all), losses, seconds=1.0)
    assert run(without, calibration, seconds=1.0).tobytes() == expected.tobytes()
    # and the effect is no empty word
    assert run(EVERYTHING, calibration, seconds=1.0).tobytes() != expected.tobytes()


@pytest.mark.parametrize("name", ["sliding", "relaxation"])
def test_absent_losses_equal_never_written(calibration, name):
    """Without friction as with a calibration that has none; without relaxation as the default simulation."""
    rows = run(replace(replace(BENCH, relaxation=CONDITIONED_SILICONE), **{name: None}), calibration, seconds=1.0)
    system, model = default_pneumatics(calibration), compile_scene(build_root(calibration)).model
    losses = Losses.of(calibration)
    if name == "sliding":
        smooth = replace(calibration, sliding=replace(calibration.sliding, coefficient_per_rad=0.0))
        losses = Losses.of(smooth, CONDITIONED_SILICONE)
        assert losses.sliding is None
    assert rows.tobytes() == closing(model, calibration, system, losses, seconds=1.0).tobytes()
    both = run(replace(BENCH, relaxation=CONDITIONED_SILICONE), calibration, seconds=1.0)
    assert rows.tobytes() != both.tobytes()


def test_without_flow_effects_the_plain_gas_is_what_runs(calibration):
    """The parts of FULL taken away one after the other leave BENCH, to the bit."""
    effects = EVERYTHING
    for name in ("leaks", "supply", "heat", "tube", "valve_delay", "relaxation"):
        effects = replace(effects, **{name: None})
    assert effects == BENCH
    state = build_pneumatics(effects, calibration).reset([2e-6] * 5, np.random.default_rng(0))
    assert (state.chamber_mass_kg, state.invariant, state.waiting_s, state.supply_mass_kg, state.time_s) == ((),) * 5


def test_without_gas_the_fingers_have_the_set_pressure_at_once(calibration):
    rows = run(IDEAL, calibration, seconds=0.05)
    assert rows[:, -3:].tolist() == [[60e3, 0.7 * 60e3, 60e3]] * len(rows)
    # what no gas means for the engine, written out
    root = build_root(calibration)
    apply_to_model(IDEAL, root)
    model = compile_scene(root).model
    data, rest = mujoco.MjData(model), np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.0])
    nothing = build_losses(IDEAL, calibration)
    simulation = HandSimulation(model=model, calibration=calibration, pneumatics=None, losses=nothing)
    simulation.reset(np.random.default_rng(0), rest)
    index = simulation.index
    data.qpos[index.wrist_qpos] = rest
    data.ctrl[index.wrist_ctrl] = rest
    data.ctrl[index.pressure_ctrl] = [60e3, 0.7 * 60e3, 60e3, 60e3, 60e3]
    mujoco.mj_forward(model, data)
    for row in rows:
        mujoco.mj_step(model, data)
        assert data.qpos[index.joint_qpos].ravel().tolist() == row[:15].tolist()


def test_without_interference_no_pair_of_fingers_meets(calibration):
    """The same trajectory, to the bit, as with every such pair excluded by name; and other contacts stay."""
    pinched = 103.0
    pressure = calibration.closing_pressure(pinched)
    effects = replace(BENCH, interference=None)
    root = build_root(calibration)
    bodies = {f: [b.name for b in root.find_all("body") if b.name.startswith(f"{f}_")] for f in FINGERS}
    for k, one in enumerate(FINGERS):
        for other in FINGERS[k + 1 :]:
            for a in bodies[one]:
                for b in bodies[other]:
                    root.contact.add("exclude", body1=a, body2=b)
    system = default_pneumatics(calibration)
    excluded = closing(compile_scene(root).model, calibration, system, seconds=2.0, set_pa=pressure)
    got = run(effects, calibration, seconds=2.0, set_pa=pressure)
    assert got.tobytes() == excluded.tobytes()
    met = run(BENCH, calibration, seconds=2.0, set_pa=pressure)
    assert np.abs(met - got)[:, :15].max() > 0.01  # in this closing fingers do meet
    assert run_trial(prepare(make_object("apple"), calibration, effects=effects), seed=0).outcome == "HELD"


def test_without_interference_every_other_pair_may_still_meet(calibration):
    """Bits of the compiled model: fingers with the table and with themselves, but not with one another."""
    root = build_root(calibration)
    apply_to_model(replace(BENCH, interference=None), root)
    root.worldbody.add("geom", name="thing", type="sphere", size=(0.01,))
    model = compile_scene(root).model
    names = [model.geom(k).name for k in range(model.ngeom)]

    def meets(one, other):
        a, b = model.geom(one), model.geom(other)
        return bool((a.contype & b.conaffinity) | (b.contype & a.conaffinity))

    for one in names:
        for other in names:
            fingers = {name.split("_")[0] for name in (one, other)} & set(FINGERS)
            assert meets(one, other) == (len(fingers) < 2), (one, other)


def test_without_their_weight_fingers_bend_as_in_weightlessness(calibration):
    """Palm down in the air: the same angles as in a world without gravity where a force stands for the palm's weight.

    To rounding: the engine adds a weight and takes it off again. Without that force they differ by 3e-4 rad, since the
    palm sags on its servo while the fingers close.
    """
    ends = {}
    for name, effects, gravity, push in (
        ("off", replace(BENCH, gravity=None), 9.81, 0.0),
        ("none", BENCH, 0.0, 9.81),
        ("on", BENCH, 9.81, 0.0),
    ):
        root = build_root(calibration, engine=EngineSettings(gravity_m_per_s2=gravity))
        apply_to_model(effects, root)
        system, model = build_pneumatics(effects, calibration), compile_scene(root).model
        simulation = HandSimulation(model=model, calibration=calibration, pneumatics=system)
        simulation.reset(np.random.default_rng(3), np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.0]))
        simulation.set_pressure_pa_gauge = np.full(3, 60e3)
        palm = simulation.index.palm_body
        simulation.data.xfrc_applied[palm, 2] = -push * model.body_mass[palm]
        for _ in range(750):
            simulation.step()
        ends[name] = simulation.data.qpos[simulation.index.joint_qpos].copy()
    assert np.abs(ends["off"] - ends["none"]).max() < 1e-12
    assert np.abs(ends["on"] - ends["none"]).max() > 1e-3


def test_without_their_weight_is_written_by_hand(calibration):
    """The same trajectory to the bit as the MJCF in which each body of a finger says that its weight is borne."""
    xml = re.sub(
        r'<body name="((?:thumb|index|middle|ring|little)_\w+)"',
        r'<body name="\1" gravcomp="1"',
        compile_scene(build_root(calibration)).xml,
    )
    assert xml.count("gravcomp") == 4 * len(FINGERS)
    system, losses = default_pneumatics(calibration), Losses.of(calibration)
    expected = closing(mujoco.MjModel.from_xml_string(xml), calibration, system, losses)
    assert run(replace(BENCH, gravity=None), calibration).tobytes() == expected.tobytes()


def test_full_trial_holds_the_apple(calibration):
    result = run_trial(prepare(make_object("apple"), calibration, effects=FULL), seed=0)
    assert result.outcome == "HELD"
    assert max(result.peak_pressure_pa_gauge.values()) > 60e3


def test_ambient_and_tubes_reach_every_part(calibration):
    gas = GasDynamics(ambient_pa_abs=80e3, supply_pa_abs=200e3, tubing=Tubing(finger_length_m=2.0))
    system = build_pneumatics(replace(BENCH, gas=gas), calibration)
    assert system.ambient_pa_abs.tolist() == [80e3] * 3
    assert system.controller.ambient_pa_abs == 80e3
    volumes = [e.dead_volume_m3 for e in system.elements]
    assert volumes == [Tubing(finger_length_m=2.0).volume_m3(n) for n in (1, 1, 3)]
    assert len(system.elements) == len(ELEMENTS) == len(default_elements())


def test_contradictions_are_named():
    for name, value in (("tube", FULL.tube), ("sensor", PressureSensor()), ("leaks", HOLE), ("heat", FULL.heat)):
        with pytest.raises(ValueError, match=f"{name} = .*gas is None"):
            Effects(**{name: value})
    with pytest.raises(ValueError, match="leaks"):
        replace(BENCH, leaks=())
    with pytest.raises(ValueError, match="supply_pa_abs"):
        GasDynamics(supply_pa_abs=90e3)
    assert Effects(interference=FingerInterference()).present == ("interference",)
