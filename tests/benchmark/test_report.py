import math

import pytest

from softhand_sim.benchmark.report import wilson_interval


@pytest.mark.parametrize(("held", "trials"), [(0, 20), (13, 20), (20, 20)])
def test_wilson_interval_matches_its_formula(held, trials):
    z, rate = 1.959963984540054, held / trials
    centre = (rate + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z / (1 + z * z / trials) * math.sqrt(rate * (1 - rate) / trials + z * z / (4 * trials**2))
    assert wilson_interval(held, trials) == pytest.approx((max(0.0, centre - half), min(1.0, centre + half)), abs=1e-12)
