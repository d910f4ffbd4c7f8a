from dataclasses import fields, replace

import pytest

from fea.geometry import FingerGeometry, choices


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"actuator_outer_radius_m": 4.9e-3}, "actuator_outer_radius_m - actuator_inner_radius_m = 0.0019 m"),
        ({"tube_wall_m": 1.9e-3}, "tube_wall_m = 0.0019 m must be at least 0.002"),
        ({"flexure_thickness_m": 1.5e-3}, "flexure_thickness_m = 0.0015"),
        ({"cap_thickness_m": 1e-3}, "cap_thickness_m"),
        ({"end_plate_m": 1e-3}, "end_plate_m"),
        ({"ring_radius_m": 5.4e-3}, "ring_radius_m = 0.0054 must lie in"),
        ({"ring_count": 160}, "ring_width_m = 0.0005 must be below"),
        ({"ring_count": 0}, "ring_count = 0"),
        ({"gap_start_m": (5.4e-3, 12e-3, 60e-3)}, r"gap_start_m\[1\] = 0.012"),
        ({"gap_start_m": (5.4e-3, 36e-3, 85e-3)}, "must stay 2 mm inside"),
        ({"sector_half_angle_rad": 2.0}, "sector_half_angle_rad = 2.0"),
        ({"actuator_length_m": 90.0}, "are the units metres"),
        ({"clearance_m": -1e-4}, "clearance_m = -0.0001"),
    ],
)
def test_impossible_dimensions_are_refused_by_name(changes, message):
    with pytest.raises(ValueError, match=message):
        replace(FingerGeometry(), **changes)


def test_every_dimension_says_where_it_comes_from():
    assert set(choices()) == {f.name for f in fields(FingerGeometry)}
    assert choices()["ring_count"].startswith("source")
