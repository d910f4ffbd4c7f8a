"""Grasp trials: the paper's picture (fruit and mug yes, heavy or slippery no), determinism, typed divergence."""

import dataclasses

import numpy as np
import pytest

from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.control.onoff import OnOffController
from softhand_sim.grasp.contacts import ContactMap
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.place import place_object, stand_off
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.simulation import HandSimulation


def without_wall_time(result):
    return dataclasses.replace(result, wall_s=0.0)


@pytest.mark.parametrize("name", ["apple", "mug", "tennis_ball"])
def test_light_objects_are_held(name, calibration):
    setup = prepare(make_object(name), calibration)
    result = run_trial(setup, seed=0)
    assert result.outcome is Outcome.HELD
    assert result.lift_m == pytest.approx(0.15, abs=0.02)
    assert 0.0 < result.penetration_m < 0.002
    # the paper's controller vents above its dead band, as far as a reading tells it: a count of the converter and
    # three deviations of the noise away; a law without lookahead would go over by a pulse of 1 to 2 kPa
    sensor = PressureSensor()
    noise_pa = sensor.noise_v / sensor.supply_v / 0.004 * 1e3
    over = OnOffController().dead_band_pa + sensor.resolution_pa + 3.0 * noise_pa
    angles = setup.plan.set_angle_deg
    for angle, pressure in zip(angles, result.peak_pressure_pa_gauge.values(), strict=True):
        wanted = calibration.closing_pressure(angle)
        assert 0.9 * wanted < pressure < wanted + over


@pytest.mark.parametrize("change", [{"mass_kg": 1.5}, {"friction": 0.05}])
def test_heavy_or_oiled_apple_is_not_held(change, calibration):
    setup = prepare(make_object("apple").with_overrides(**change), calibration)
    assert all(run_trial(setup, seed).outcome in (Outcome.DROPPED, Outcome.MISSED, Outcome.SLIPPED) for seed in (0, 1))


def test_a_finger_that_bends_less_closes_with_its_highest_pressure(calibration):
    """A stiffer finger, or a coarser mesh, may not reach the script's 95 degrees at all."""
    curve, known = calibration.curve, calibration.curve.pressure_pa_gauge <= 60e3
    rows = {name: getattr(curve, name)[known] for name in ("pressure_pa_gauge", "tip_angle_deg", "joint_angle_deg")}
    less = dataclasses.replace(calibration, curve=dataclasses.replace(curve, **rows))
    assert less.curve.tip_angle_deg[-1] < 95.0
    assert less.closing_pressure(95.0) == less.curve.pressure_pa_gauge[-1] == 60e3
    assert less.closing_pressure(30.0) == calibration.pressure_for_angle(30.0)
    result = run_trial(prepare(make_object("apple"), less), seed=0)
    assert 54e3 < max(result.peak_pressure_pa_gauge.values()) < 65e3


def test_without_pressure_nothing_is_lifted(calibration):
    setup = prepare(make_object("apple"), calibration)
    open_hand = dataclasses.replace(setup.plan, set_angle_deg=(0.0, 0.0, 0.0))
    result = run_trial(dataclasses.replace(setup, plan=open_hand), seed=0)
    assert result.outcome is Outcome.MISSED
    assert abs(result.lift_m) < 1e-3


def test_same_seed_same_result_to_the_bit(calibration):
    setup = prepare(make_object("apple"), calibration)
    first, again, other = (without_wall_time(run_trial(setup, seed)) for seed in (3, 3, 4))
    assert first == again
    assert first.object_offset_m != other.object_offset_m


def test_workers_do_not_change_the_trials():
    plan = BenchmarkPlan(
        objects=(make_object("apple"), make_object("tennis_ball")),
        trials=2,
        seed=5,
        protocol=dataclasses.replace(load_protocol(), close_s=1.0, phases=(Lift(height_m=0.15), Hold(duration_s=0.5))),
    )
    alone, side_by_side = (
        [without_wall_time(r) for r in in_order(plan, list(run_benchmark(plan, workers)))] for workers in (1, 2)
    )
    assert alone == side_by_side
    assert [(r.object, r.seed) for r in alone] == [("apple", 5), ("apple", 6), ("tennis_ball", 5), ("tennis_ball", 6)]


def test_a_diverging_engine_is_a_typed_outcome(calibration):
    """Springs far too stiff for the time step: the verdict says so instead of a number that looks right."""
    setup = prepare(make_object("apple"), calibration)
    setup.scene.model.dof_damping[:] = -1e3
    result = run_trial(setup, seed=0)
    assert result.outcome is Outcome.DIVERGED
    assert np.isfinite([result.lift_m, result.slip_m, result.creep_m_per_s, result.penetration_m]).all()


def test_a_hand_starts_clear_of_a_displaced_object(calibration):
    setup = prepare(make_object("cracker_box"), calibration)
    simulation = HandSimulation(model=setup.scene.model, calibration=calibration, pneumatics=setup.pneumatics)
    simulation.reset(np.random.default_rng(0), setup.plan.standoff(setup.protocol.approach_m))
    place_object(simulation, setup.model.rest_height_m, setup.protocol.draw_offset(np.random.default_rng(0), 0))
    contacts = ContactMap.of(setup.scene.model)
    assert contacts.of_object(simulation.data).size
    distance_m = stand_off(simulation, setup.plan, setup.protocol.approach_m)
    assert not contacts.of_object(simulation.data).size
    pose = simulation.data.qpos[simulation.index.wrist_qpos]
    np.testing.assert_allclose(pose, setup.plan.standoff(distance_m))
    np.testing.assert_array_equal(simulation.wrist_target, pose)
    assert run_trial(setup, 0).alarm == ""
