"""The tip's force on a plate against the finite elements' blocked test and against the joints' own balance."""

import pytest

from softhand_sim.tip_force import tip_force

# docs/finger-analysis.md, blocked tip: calibration mesh, friction 0.3, sensor at 40 mm
FEA_N = {50e3: 0.056, 60e3: 0.119, 70e3: 0.186, 75e3: 0.221, 80e3: 0.259}


def test_force_is_that_of_the_finite_elements(calibration):
    found = tip_force(calibration, list(FEA_N))
    assert found == pytest.approx(list(FEA_N.values()), rel=0.1)


def test_a_plate_out_of_reach_feels_nothing(calibration):
    assert tip_force(calibration, [30e3]) == pytest.approx([0.0])
    assert tip_force(calibration, [75e3], distance_m=0.12) == pytest.approx([0.0])


def test_force_falls_with_the_distance(calibration):
    """A finger that has bent more before it meets the plate has spent more of its thrust on its own joints."""
    near, far = tip_force(calibration, [75e3], distance_m=0.02), tip_force(calibration, [75e3], distance_m=0.04)
    assert near > 1.2 * far


def test_pressure_beyond_the_curve_and_a_wrong_distance_are_refused(calibration):
    with pytest.raises(ValueError, match="pressure_pa_gauge = 90000"):
        tip_force(calibration, [90e3])
    with pytest.raises(ValueError, match=r"distance_m = 40"):
        tip_force(calibration, [75e3], distance_m=40.0)
