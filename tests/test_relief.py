"""Relief at the proximal joint: closed forms, the stated plateau, the energy of a cycle, and the gas that it takes."""

from dataclasses import replace

import numpy as np
import pytest

from softhand_sim.calibration import ChamberCalibration, SlidingCalibration, TendonCalibration, load_evidence
from softhand_sim.characterize import Bench
from softhand_sim.characterize.relief import extrapolated, relief, relief_at_plateau
from softhand_sim.effects import IDEAL, Effects
from softhand_sim.effects.auto import choose
from softhand_sim.effects.build import build_losses
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.hand.scene import build_scene
from softhand_sim.objects.catalogue import make_object
from softhand_sim.relief import ProximalRelief, Relief
from softhand_sim.simulation import HandSimulation

CHAMBER = ChamberCalibration(volume_m3=2.5e-6, area_m2=5e-5, area_slope_m=0.0, bulging_m3_per_pa=0.0)
WALL = TendonCalibration(stiffness_n_per_m=200.0, stiffness_n_per_m2=0.0, stiffness_n_per_m3=0.0)
DT = 2e-3


def settled(law: ProximalRelief, elongation_m: float, pressure_pa: float) -> tuple[float, float]:
    slide, bulge, force = Relief(law=law, chamber=CHAMBER, tendon=WALL), np.zeros(1), np.zeros(1)
    for _ in range(500):
        bulge, force = slide.step(bulge, np.array([elongation_m]), np.array([pressure_pa]), DT)
    return float(bulge[0]), float(force[0])


@pytest.mark.parametrize("stiffness", [0.0, 50.0])
def test_slide_and_wall_share_the_excess_as_springs_in_series(stiffness):
    """p A - K (d + b) = T + k b gives the bulge, and the joints lose K b."""
    law = ProximalRelief(thrust_n=3.0, stiffness_n_per_m=stiffness)
    bulge, force = settled(law, 2e-3, 80e3)
    excess = 80e3 * 5e-5 - 200.0 * 2e-3 - 3.0
    assert bulge == pytest.approx(excess / (200.0 + stiffness), rel=1e-6)
    assert force == pytest.approx(-200.0 * bulge, rel=1e-9)
    assert settled(law, 2e-3, 67e3) == (0.0, 0.0)


def test_slide_gives_way_in_its_time_and_comes_back():
    law, at = ProximalRelief(thrust_n=3.0, time_s=0.05), np.array([0.0])
    slide, bulge = Relief(law=law, chamber=CHAMBER, tendon=WALL), np.zeros(1)
    final, dt = (80e3 * 5e-5 - 3.0) / 200.0, 1e-4
    for _ in range(500):
        bulge, _ = slide.step(bulge, at, np.array([80e3]), dt)
    assert bulge[0] == pytest.approx(final * (1.0 - np.exp(-1.0)), rel=2e-3)
    for _ in range(1500):
        bulge, force = slide.step(bulge, at, np.array([50e3]), dt)
    assert bulge[0] == force[0] == 0.0


def test_blocked_force_levels_off_and_nothing_below_changes(calibration):
    report = relief(calibration, load_evidence())
    assert report.holds, [str(check) for check in report.checks]
    without, with_relief = (np.array(report.figures[key]) for key in ("tip_force_n", "tip_force_with_relief_n"))
    assert (np.diff(without) > 0.03).all()
    assert with_relief[:3] == pytest.approx(without[:3], rel=1e-3)
    assert with_relief[3:] == pytest.approx(with_relief[2], rel=0.01)


def test_default_is_the_thrust_of_the_shipped_finger_at_the_plateau(calibration):
    distance = load_evidence().blocked.sensor_distance_m
    assert relief_at_plateau(calibration, distance).thrust_n == pytest.approx(ProximalRelief().thrust_n, rel=0.01)


@pytest.mark.parametrize("rate", [1.0, 0.5])
def test_gas_work_of_a_closed_cycle_is_that_of_the_finger_and_of_the_slide(calibration, rate):
    """The gas gives p dV(d + b); the joints take (p A - N) dd, the wall gives all back, the slide takes the rest."""
    sliding = SlidingCalibration(coefficient_per_rad=0.0, stiffness_n_per_m=0.0)
    law = ProximalRelief()
    bench = Bench(replace(extrapolated(calibration, 90e3), sliding=sliding), wall_distance_m=0.04, relief=law)
    chamber = calibration.chamber
    n = int(1000 / rate)
    up = np.concatenate([np.linspace(0.0, 90e3, 5 * n), np.linspace(90e3, 0.0, 5 * n), np.zeros(500)])
    rows = []
    for p in up:
        bench.step(float(p))
        rows.append((p, bench.elongation_m, bench.bulge_m, bench.pressure_force_n + bench.loss_force_n))
    p, d, b, force = np.array(rows).T
    assert b.max() > 3e-3
    assert b[-1] == 0.0
    volume = np.array([chamber.volume_m3_at(x) for x in d + b])
    a1, a2, a3 = calibration.tendon.polynomial

    def mean(x):
        return 0.5 * (x[1:] + x[:-1])

    gas = mean(p) * np.diff(volume)
    # what the engine's actuators put on the joints, less its own spring for the wall
    thrust = force - d * (a1 + d * (a2 + d * a3))
    stored = np.diff((d + b) ** 2 * (a1 / 2 + (d + b) * (a2 / 3 + (d + b) * a3 / 4)))
    joints = mean(thrust) * np.diff(d)
    slide = mean(thrust) * np.diff(b)
    moved = np.abs(gas).sum()
    assert abs((gas - stored - joints - slide).sum()) < 1e-6 * moved
    assert abs(stored.sum()) < 1e-6 * moved
    # the plateau's own work comes back; what is left is the dashpot's, which the rate brings down
    lost = slide - law.thrust_n * np.diff(b)
    assert 0.0 < lost.sum() < 2e-3 * rate * moved


def test_gas_has_the_volume_that_the_relief_takes(calibration):
    """Fingers held straight at 75 kPa: the slide is out, the chamber is longer by it, and the gas stays bounded."""
    model = build_scene(calibration).model
    hands = []
    for effects in (IDEAL, Effects(relief=ProximalRelief())):
        hand = HandSimulation(
            model=model, calibration=calibration, pneumatics=None, losses=build_losses(effects, calibration)
        )
        hand.reset(np.random.default_rng(0), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
        hand.set_pressure_pa_gauge = np.full(3, 75e3)
        for _ in range(20):  # too short for a finger to bend far
            hand.step()
        hands.append(hand)
    plain, relieved = hands
    bulge = relieved.loss_state.bulge_m
    assert (bulge > 5e-4).all()
    chamber, d = calibration.chamber, relieved.elongations_m()
    expected = [chamber.volume_m3_at(x) for x in d + bulge]
    assert relieved.chamber_volumes_m3() == pytest.approx(expected)
    assert (relieved.tip_angles_rad() < plain.tip_angles_rad()).all()


def test_a_gentle_grasp_does_not_call_for_it(calibration):
    scene = SceneFacts.of(make_object("apple"), calibration, Effects(relief=ProximalRelief()))
    for set_pa, stays in ((50e3, False), (80e3, True)):
        chosen, answers = choose(replace(scene, set_pa_gauge=np.full(3, set_pa)), Tolerance(angle_deg=1.0, slip_m=0.01))
        assert (chosen.relief is not None) == stays
        answer = next(answer for answer in answers if answer.name == "relief")
        assert (answer.omission_error_deg > 0.0) == stays


@pytest.mark.parametrize("change", [{"thrust_n": 0.0}, {"stiffness_n_per_m": -1.0}, {"time_s": float("nan")}])
def test_parameters_out_of_range_are_refused_by_name(change):
    with pytest.raises(ValueError, match=next(iter(change))):
        ProximalRelief(**change)
