"""The choice by tolerance: the cheapest point, never slower for a wider tolerance; the front's file."""

import json
from itertools import pairwise

import numpy as np
import pytest

from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity, load_front
from softhand_sim.fidelity.front import (
    CONFIDENCE,
    SHARE,
    Front,
    Measured,
    SceneErrors,
    bound,
    most_beyond,
    non_dominated,
)


def _errors(angle, slip_m, scenes=59):
    return SceneErrors(angle_deg=np.full(scenes, angle), slip_m=np.full(scenes, slip_m))


def _front(rows):
    points = [
        Fidelity(measured=Measured(name=str(k), angle_error_deg=a, slip_error_m=1e-3 * s, cost_ratio=c))
        for k, (a, s, c) in enumerate(rows)
    ]
    return Front(points=tuple(points), errors=tuple(_errors(a, 1e-3 * s) for a, s, _ in rows))


def _cost(front, angle, slip_mm):
    found = front.for_tolerance(Tolerance(angle_deg=angle, slip_m=1e-3 * slip_mm))
    return found.measured.cost_ratio


def test_the_cheapest_point_within_both_tolerances_is_taken():
    front = _front([(0.1, 0.1, 9.0), (1.0, 2.0, 1.0), (1.5, 0.5, 2.0), (1.5, 0.5, 1.5)])
    assert front.for_tolerance(Tolerance(angle_deg=2.0, slip_m=1e-3)).measured.name == "3"
    assert front.for_tolerance(Tolerance(angle_deg=2.0, slip_m=2e-3)).measured.name == "1"
    assert front.for_tolerance(Tolerance(angle_deg=0.5, slip_m=2e-3)).measured.name == "0"


def test_twice_the_error_is_never_slower():
    rng = np.random.default_rng(0)
    for _ in range(50):
        rows = rng.lognormal(size=(12, 3))
        front = _front([*rows.tolist(), (1e-3, 1e-3, 99.0)])
        angle, slip = rng.lognormal(size=2)
        costs = [_cost(front, factor * angle + 1e-2, factor * slip + 1e-2) for factor in (1.0, 2.0, 4.0)]
        assert costs == sorted(costs, reverse=True)


def test_a_tolerance_that_nothing_is_within_is_refused_with_the_best_there_is():
    front = _front([(0.5, 0.3, 4.0), (1.0, 0.1, 1.0)])
    with pytest.raises(ValueError, match=r"tolerance = 0.1 degrees, 1 mm.*0 was not in 59 of 59.*0.5 degrees, 0.3 mm"):
        front.for_tolerance(Tolerance(angle_deg=0.1, slip_m=1e-3))


def test_a_setting_needs_scenes_enough_and_few_enough_beyond_in_angle_or_slip():
    """59 scenes allow none beyond, 93 one: a scene counts once, whether by its angle, its slip or both."""
    wide = Tolerance(angle_deg=2.0, slip_m=1e-3)
    assert not _errors(1.0, 5e-4, scenes=58).show_within(wide)
    assert _errors(1.0, 5e-4, scenes=59).show_within(wide)
    angle, slip = np.ones(93), np.full(93, 5e-4)
    angle[0] = slip[0] = 9.0
    assert SceneErrors(angle_deg=angle, slip_m=slip).show_within(wide)
    slip[1] = 2e-3
    assert SceneErrors(angle_deg=angle, slip_m=slip).beyond(wide) == 2
    assert not SceneErrors(angle_deg=angle, slip_m=slip).show_within(wide)


def test_the_bound_of_few_scenes_is_kept_by_new_ones_as_often_as_is_said():
    """Draws of a law with heavy tails, whose 95 % quantile is known: Student's with two degrees of freedom."""
    rng, quantile = np.random.default_rng(2), 2.919986
    for scenes in (59, 93, 208):
        bounds = [bound(rng.standard_t(2, size=scenes)) for _ in range(4000)]
        kept = float(np.mean(np.array(bounds) >= quantile))
        assert CONFIDENCE - 0.012 < kept < 0.975
    assert SHARE == 0.95


def test_how_many_may_be_beyond_are_the_tables_of_wilks():
    assert [most_beyond(n) for n in (24, 58, 59, 92, 93, 123, 124, 153, 181, 208)] == [-1, -1, 0, 0, 1, 1, 2, 3, 4, 5]


def test_errors_fall_along_the_points_that_no_other_beats():
    rng = np.random.default_rng(1)
    errors, costs = rng.lognormal(size=(2, 40))
    chosen = non_dominated(errors, costs)
    assert all(errors[a] > errors[b] and costs[a] < costs[b] for a, b in pairwise(chosen))
    for k in set(range(40)) - set(chosen):
        assert any(errors[j] <= errors[k] and costs[j] <= costs[k] for j in chosen)


def test_without_scenes_enough_the_largest_error_stands_for_the_bound():
    assert bound([1.0, 50.0, 2.0]) == 50.0


@pytest.fixture
def content():
    point = {"name": "2 ms", "kind": "numerics", "fidelity": {"timestep_s": 0.002}}
    point |= {"angle_error_deg": 1.0, "slip_error_m": 1e-3, "cost_ratio": 1.2}
    point |= {"scene_angle_error_deg": [0.5] * 59, "scene_slip_error_m": [1e-3] * 59}
    return {"schema": "softhand-sim/accuracy-front", "schema_version": 2, "points": [point]}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"cost_ratio": 0.0}, "cost_ratio = 0"),
        ({"slip_error_m": -1e-3}, "slip_error_m = -0.001"),
        ({"angle_error_deg": "small"}, "angle_error_deg = 'small'"),
        ({"fidelity": {"timestep_s": 0.02}}, "timestep_s: 0.02"),
        ({"fidelity": {"timestep": 0.002}}, "timestep: no such field"),
        ({"fidelity": {"cone": "round"}}, "cone: 'round'"),
        ({"kind": "shapes"}, "points: "),
        ({"scene_slip_error_m": [1e-3]}, "slip_m: "),
        ({"scene_angle_error_deg": [None]}, "scene_angle_error_deg"),
    ],
)
def test_a_damaged_front_is_refused_by_name(content, tmp_path, change, says):
    file = tmp_path / "front.json"
    content["points"][0] |= change
    file.write_text(json.dumps(content))
    with pytest.raises(ValueError, match=says) as raised:
        load_front(file)
    assert str(file) in str(raised.value)


def test_a_front_is_read_as_it_was_written(content, tmp_path):
    file = tmp_path / "front.json"
    file.write_text(json.dumps(content))
    front = load_front(file)
    (point,), (errors,) = front.points, front.errors
    assert point == Fidelity(measured=Measured(name="2 ms", angle_error_deg=1.0, slip_error_m=1e-3, cost_ratio=1.2))
    assert (errors.angle_deg.tolist(), errors.slip_m.tolist()) == ([0.5] * 59, [1e-3] * 59)
    content["points"] += [content["points"][0] | {"name": "few", "scene_angle_error_deg": None}]
    del content["points"][1]["scene_angle_error_deg"]
    file.write_text(json.dumps(content))
    assert load_front(file).points == (point,)
