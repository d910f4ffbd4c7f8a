"""Many hands at once are the same hands one by one, to the bit; the compiled step is the plain one."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from softhand_sim.actuation import EngineArrays, HandParts
from softhand_sim.actuation.compiled import CompiledActuation
from softhand_sim.actuation.plain import PlainActuation
from softhand_sim.batch import HandBatch
from softhand_sim.control.protocol import ValveCommand
from softhand_sim.effects import BENCH, FULL, IDEAL
from softhand_sim.elements import FINGERS
from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.trial import prepare
from softhand_sim.hand.index import HandIndex
from softhand_sim.objects.catalogue import make_object
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.relief import ProximalRelief
from softhand_sim.simulation import HandSimulation

LEAKING = replace(FULL, leaks=(Leak(finger="ring", start_s=0.0301),), relief=ProximalRelief(thrust_n=1.0))
PRESETS = {"ideal": IDEAL, "bench": BENCH, "full": FULL, "leaking": LEAKING}


class Threshold:
    """A controller of one's own: fills below the set pressure, and counts its ticks."""

    def reset(self):
        return (0.0,)

    def command(self, readings_pa_abs, set_pa_gauge, state):
        commands = [ValveCommand(r - 101325.0 < s, False) for r, s in zip(readings_pa_abs, set_pa_gauge, strict=True)]
        return tuple(commands), (state[0] + 1.0,)


def offset(world):
    return 0.004 * world, -0.003 * world, 0.1 * world


@pytest.mark.parametrize("preset", ["bench", "full", "ideal"])
def test_batch_is_single_hands_to_the_bit(preset, calibration):
    """Grasps of an apple at other places, worlds reset at other times, two threads."""
    setup = prepare(make_object("apple"), calibration, effects=PRESETS[preset])
    n, start = 3, setup.plan.standoff(0.01)
    made = {"model": setup.scene.model, "calibration": calibration}
    made |= {"pneumatics": setup.pneumatics, "losses": setup.losses}
    batch = HandBatch(**made, worlds=n, threads=2)
    singles = [HandSimulation(**made) for _ in range(n)]
    address = setup.scene.model.joint("object_joint").qposadr[0]

    def reset(worlds):
        batch.reset(worlds, [np.random.default_rng(w) for w in worlds], start)
        for w in worlds:
            singles[w].reset(np.random.default_rng(w), start)
            place_object(singles[w], setup.model.rest_height_m, offset(w))
            batch.engine.bind("qpos")[w, address : address + 7] = singles[w].data.qpos[address : address + 7]
        batch.forward(worlds)
        for w in worlds:
            singles[w].wrist_target = setup.plan.standoff(0.0)
            batch.wrist_target[w] = setup.plan.standoff(0.0)
            singles[w].set_pressure_pa_gauge = np.array([70e3, 60e3, 50e3])
            batch.set_pressure_pa_gauge[w] = [70e3, 60e3, 50e3]

    reset([0, 1, 2])
    for k in range(900):
        if k == 407:  # between two ticks of the others
            reset([1])
        batch.step()
        for single in singles:
            single.step()
    for w, single in enumerate(singles):
        for field in ("qpos", "qvel", "ctrl"):
            assert batch.engine.bind(field)[w].tobytes() == getattr(single.data, field).tobytes()
        assert batch.actuation.gas(w) == single.gas
        assert batch.beyond_calibration(w) == single.range_watch.beyond()
        assert batch.tip_angles_rad()[w] == pytest.approx(single.tip_angles_rad(), rel=1e-14)
        assert batch.reading_pa_gauge()[w].tolist() == single.reading_pa_gauge().tolist()
    assert not batch.diverged.any()
    assert np.degrees(batch.tip_angles_rad()).max() > 30.0


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("dt", [0.002, 0.0133])
@pytest.mark.parametrize("own", [False, True])
def test_compiled_step_is_the_plain_one(preset, dt, own, calibration):
    """Fingers moved by hand, so that the step alone is compared; ticks inside steps, worlds out of phase."""
    setup = prepare(make_object("apple"), calibration, effects=PRESETS[preset])
    system = setup.pneumatics
    if own and system is not None:
        system = replace(system, controller=Threshold())
    parts = HandParts(
        index=HandIndex.of(setup.scene.model), calibration=calibration, pneumatics=system, losses=setup.losses
    )
    n, model = 2, setup.scene.model
    made = []
    for kind in (PlainActuation, CompiledActuation):
        arrays = EngineArrays(
            ten_length=np.tile(model.tendon_length0, (n, 1)), qpos=np.zeros((n, model.nq)), ctrl=np.zeros((n, model.nu))
        )
        made.append((kind(parts, arrays), arrays))
        for w in range(n):
            made[-1][0].reset(w, np.random.default_rng(w))
    sets = np.array([[70e3, 60e3, 50e3], [30e3, 0.0, 75e3]])
    for k in range(150):
        bent = 0.3 * (1.0 - np.cos(0.05 * k + np.arange(n)))
        for actuation, arrays in made:
            actuation.set_pa_gauge[:] = sets if k < 80 else 0.4 * sets
            arrays.ten_length[:, parts.index.tendon] = parts.index.straight_length_m - 0.01 * bent[:, None]
            arrays.qpos[:, parts.index.joint_qpos] = bent[:, None, None]
            if k == 37:
                actuation.reset(1, np.random.default_rng(5))
            actuation.step(dt)
        (plain, one), (fast, other) = made
        np.testing.assert_allclose(other.ctrl, one.ctrl, rtol=1e-10, atol=1e-7)
        for w in range(n):
            if system is not None:
                a, b = plain.gas(w), fast.gas(w)
                np.testing.assert_allclose(b.to_array(), a.to_array(), rtol=1e-10, atol=1e-12)
                fast.set_gas(w, b)
                assert fast.gas(w) == b
            np.testing.assert_allclose(fast.losses(w).slip_m, plain.losses(w).slip_m, rtol=1e-10)
            np.testing.assert_allclose(fast.losses(w).bulge_m, plain.losses(w).bulge_m, rtol=1e-9, atol=1e-15)
            np.testing.assert_allclose(fast.losses(w).flow_m, plain.losses(w).flow_m, rtol=1e-10)
    assert (fast.losses(0).bulge_m.max() > 1e-4) == (preset == "leaking")
    assert np.ptp(one.ctrl[:, parts.index.pressure_ctrl]) > 1e3 or system is None


def test_bad_set_pressures_and_lengths_are_named(calibration):
    setup = prepare(make_object("apple"), calibration)
    simulation = HandSimulation(model=setup.scene.model, calibration=calibration, pneumatics=setup.pneumatics)
    simulation.reset(np.random.default_rng(0), setup.plan.standoff(0.01))
    simulation.set_pressure_pa_gauge = np.array([10e3, -1.0, 0.0])
    with pytest.raises(ValueError, match="set_pa_gauge of index"):
        simulation.step()
    simulation.set_pressure_pa_gauge = np.zeros(3)
    simulation.data.ten_length[simulation.index.tendon[FINGERS.index("ring")]] = np.nan
    with pytest.raises(ValueError, match="volumes_m3"):
        simulation.step()
    with pytest.raises(ValueError, match="worlds"):
        HandBatch(model=mujoco.MjModel.from_xml_string("<mujoco/>"), calibration=calibration, pneumatics=None, worlds=0)
