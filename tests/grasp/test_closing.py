"""The cheap closing: what it must say of an apple, a heavy one, a slippery one, and of impossible poses."""

import dataclasses

import numpy as np
import pytest

from softhand_sim.calibration import JOINT_RANGE_RAD
from softhand_sim.grasp.choice import closing as module
from softhand_sim.grasp.choice.closing import LOADS, SHORTEST_LIFT_M, lift_of
from softhand_sim.grasp.choice.search import closing_of
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.verdict import Thresholds
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.index import HandIndex
from softhand_sim.objects.catalogue import make_object

HERE = (0.0, 0.0, 0.0)


def closing(model, calibration):
    return closing_of(model, calibration, load_protocol(), HandAnatomy())


def test_an_apple_is_held_with_margin_beside_its_place_too_and_again_to_the_bit(calibration):
    apple = make_object("apple")
    offsets = [HERE, (0.003, -0.005, -0.16)]
    first = closing(apple, calibration).load_factors([plan_grasp(apple)], offsets)
    assert first == pytest.approx(np.full((1, 2), LOADS[-1]))
    assert np.array_equal(first, closing(apple, calibration).load_factors([plan_grasp(apple)], offsets))


@pytest.mark.parametrize("change", [{"mass_kg": 1.5}, {"friction": 0.05}])
def test_a_heavy_or_oiled_apple_is_lost(change, calibration):
    apple = make_object("apple").with_overrides(**change)
    assert closing(apple, calibration).load_factors([plan_grasp(apple)], [HERE])[0, 0] < 0.6


def test_the_load_held_falls_with_the_mass(calibration):
    """A can of 100 g is held from the side with margin, one of 160 g is not, one of 349 g does not leave the table."""
    held = []
    for mass_kg in (0.10, 0.16, 0.349):
        can = make_object("soup_can").with_overrides(mass_kg=mass_kg)
        held.append(closing(can, calibration).load_factors([plan_grasp(can)], [HERE])[0, 0])
    assert held[0] > 1.0
    assert held[0] >= held[1] >= held[2]
    assert held[2] < 0.6


def test_worlds_do_not_know_of_each_other(calibration):
    apple = make_object("apple")
    ball = closing(apple, calibration)
    good = plan_grasp(apple)
    beside = dataclasses.replace(good, wrist_pose=(0.15, *good.wrist_pose[1:]))
    together = ball.load_factors([beside, good], [HERE])[:, 0]
    assert together == pytest.approx([ball.load_factors([plan], [HERE])[0, 0] for plan in (beside, good)], abs=0.0)
    assert together[0] < 0.6 < together[1]


def test_a_hand_that_starts_in_the_object_or_must_be_pressed_onto_it_holds_nothing(calibration):
    can = make_object("soup_can")
    height = can.extents_m[2]
    light = closing(can.with_overrides(mass_kg=0.05), calibration)
    down = GraspPlan(wrist_pose=(0.0, 0.0, height - 0.012, 0.0, 0.0, 0.0), retreat=(0.0, 0.0, 1.0))
    inside = dataclasses.replace(down, wrist_pose=(0.0, 0.0, height - 0.06, 0.0, 0.0, 0.0))
    assert light.load_factors([down, inside], [HERE])[:, 0].tolist() == [0.0, 0.0]


def test_a_long_thing_is_lifted_until_it_cannot_stand_on_its_end():
    """A level rod that leans by all of the tilt allowed and slips by all of the slip allowed is off the table."""
    limits = Thresholds()
    for name in ("banana", "hammer"):
        rod = make_object(name)
        half = np.linalg.norm(rod.mesh.vertices[:, :2], axis=1).max()
        assert lift_of(rod, limits) > limits.slip_m + half * np.sin(limits.tilt_rad)
    assert lift_of(make_object("golf_ball"), limits) == SHORTEST_LIFT_M


def test_a_joint_that_rests_on_its_stop_is_told_from_one_that_touches_it(calibration):
    ball = closing(make_object("tennis_ball"), calibration)
    hand = HandIndex.of(ball.model)
    states = np.zeros((3, 100, 1 + ball.model.nq))
    proximal = 1 + int(hand.joint_qpos[0, 0])
    states[0, :, proximal] = JOINT_RANGE_RAD[0] - 0.01
    states[1, :10, proximal] = JOINT_RANGE_RAD[0] - 0.01
    states[2, :, proximal] = JOINT_RANGE_RAD[0] + 0.01
    assert ball._on_a_stop(states, hand).tolist() == [True, False, False]


def test_each_load_is_lifted_from_the_closed_hand_not_added_to_what_came_up_with_less(calibration):
    """A hold at full weight doesn't depend on lighter lifts before it: alone it gives the same verdict."""
    apple = make_object("apple")
    for mass_kg in (0.068, 0.5):
        ball = closing(apple.with_overrides(mass_kg=mass_kg), calibration)
        ladder = ball.load_factors([plan_grasp(apple)], [HERE])[0, 0]
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(module, "LOADS", (1.0,))
            assert (ball.load_factors([plan_grasp(apple)], [HERE])[0, 0] >= 1.0) == (ladder >= 1.0)
