"""Candidate poses: repeatable, above the table, turned to the shape."""

import numpy as np
import pytest

from softhand_sim.grasp.choice.candidates import candidates, some
from softhand_sim.grasp.choice.oblique import LARGEST_LEAN_RAD, from_anywhere
from softhand_sim.grasp.choice.reach import TABLE_PRESS_M, HandReach
from softhand_sim.grasp.plan import palm_axes
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.catalogue import make_object


def proposed(model, calibration, count, seed=0):
    return some(candidates(model, calibration, HandAnatomy(), np.random.default_rng(seed)), count)


def test_reach_of_the_open_hand(calibration):
    """An 85 mm fruit fits between thumb and fingers, and no finger is longer than the finger."""
    reach = HandReach.of(calibration, HandAnatomy())
    assert 0.085 < reach.opening_m < 0.13
    assert reach.depth_m < calibration.finger.length_m + 0.005
    assert abs(reach.centre_m) < 0.02
    assert reach.half_width_m >= 0.5 * HandAnatomy().palm_size_m[1]


def test_more_candidates_begin_with_fewer_ones_and_with_the_scripted_grasp(calibration):
    apple = make_object("apple")
    many, few = proposed(apple, calibration, 40), proposed(apple, calibration, 15)
    assert many[:15] == few
    assert many[0] == plan_grasp(apple)
    assert proposed(apple, calibration, 15, seed=1)[1:] != few[1:]


@pytest.mark.parametrize("name", ["banana", "mug", "wrench", "soccer_ball"])
def test_the_palm_stays_above_the_table(name, calibration):
    half = 0.5 * np.array(HandAnatomy().palm_size_m)
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [0, -2])).reshape(3, -1).T * half
    for plan in proposed(make_object(name), calibration, 60):
        height = plan.wrist_pose[2] + (corners @ palm_axes(plan.wrist_pose).T)[:, 2]
        assert height.min() > 0.0
        assert plan.retreat[2] >= 0.0


def test_from_above_thumb_and_fingers_close_across_a_long_thing(calibration):
    """A 121 mm pen is 18 mm thick: the palm's x axis lies across it, within half of the friction."""
    across = []
    for plan in proposed(make_object("marker"), calibration, 81)[1:]:
        if plan.retreat[2] == 1.0:
            along = palm_axes(plan.wrist_pose)[:2, 0]
            across.append(abs(along[1]) / np.linalg.norm(along))
    # half of the candidates take a main direction instead, which may be the long one
    assert np.mean(np.array(across) > np.cos(0.6)) > 0.6


def test_leaning_hands_look_every_way_and_come_in_clear_of_table_and_object(calibration):
    """Coming in along the table no point of the open hand is in it; from above fingertips alone may press into it."""
    ball, reach = make_object("tennis_ball"), HandReach.of(calibration, HandAnatomy())
    rng, looks = np.random.default_rng(0), []
    for _ in range(200):
        place, axes, retreat = from_anywhere(ball, reach, np.zeros(3), rng.uniform(-np.pi, np.pi), rng)
        assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.norm(retreat) == pytest.approx(1.0)
        assert retreat[2] >= 0.0
        level = retreat[2] <= 0.5
        height = place[2] + reach.points_m @ axes[2]
        assert (height >= reach.above_m - (0.0 if level else TABLE_PRESS_M) * reach.tip - 1e-12).all()
        # a finger's axis keeps the finger's radius, a tip that may press still is above the table's underside
        assert height.min() > calibration.finger.outer_radius_m - TABLE_PRESS_M - 1e-12
        looks.append(axes[:, 2])
    lean = np.arccos(-np.array(looks)[:, 2])
    assert lean.max() <= LARGEST_LEAN_RAD + 1e-9
    assert (np.histogram(lean, bins=4, range=(0.0, LARGEST_LEAN_RAD))[0] > 20).all()
    sideways = np.arctan2(*np.array(looks)[lean > 0.5, :2].T)
    assert (np.histogram(sideways, bins=4, range=(-np.pi, np.pi))[0] > 15).all()
