"""The choice by tolerance: the cheapest point, never slower for a wider tolerance; the front's file."""

import json
from itertools import pairwise

import numpy as np
import pytest

from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity, load_front
from softhand_sim.fidelity.front import Front, Measured, non_dominated, share_within


def _front(rows):
    points = [
        Fidelity(measured=Measured(name=str(k), angle_error_deg=a, slip_error_m=1e-3 * s, cost_ratio=c))
        for k, (a, s, c) in enumerate(rows)
    ]
    return Front(points=tuple(points))


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
    with pytest.raises(ValueError, match=r"tolerance = 0.1 degrees, 1 mm.*0, has 0.5 degrees and 0.3 mm"):
        front.for_tolerance(Tolerance(angle_deg=0.1, slip_m=1e-3))


def test_errors_fall_along_the_points_that_no_other_beats():
    rng = np.random.default_rng(1)
    errors, costs = rng.lognormal(size=(2, 40))
    chosen = non_dominated(errors, costs)
    assert all(errors[a] > errors[b] and costs[a] < costs[b] for a, b in pairwise(chosen))
    for k in set(range(40)) - set(chosen):
        assert any(errors[j] <= errors[k] and costs[j] <= costs[k] for j in chosen)


def test_all_but_three_in_a_hundred_scenes_are_within_a_point_s_error():
    errors = np.arange(100.0)
    assert (errors <= share_within(errors)).mean() >= 0.97
    assert share_within([1.0, 2.0, 50.0]) == 50.0


@pytest.fixture
def content():
    point = {"name": "2 ms", "kind": "numerics", "fidelity": {"timestep_s": 0.002}}
    point |= {"angle_error_deg": 1.0, "slip_error_m": 1e-3, "cost_ratio": 1.2}
    return {"schema": "softhand-sim/accuracy-front", "schema_version": 1, "points": [point]}


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
    (point,) = load_front(file).points
    assert point == Fidelity(measured=Measured(name="2 ms", angle_error_deg=1.0, slip_error_m=1e-3, cost_ratio=1.2))
