"""ISO 6358 flow: closed forms, continuity and symmetry."""

import math

import numpy as np
import pytest

from softhand_sim.air import REFERENCE_DENSITY_KG_PER_M3
from softhand_sim.pneumatics.orifice import Orifice

VALVE = Orifice(sonic_conductance_m3_per_s_pa=2e-10, critical_pressure_ratio=0.35)
CHOKED = 2e-10 * REFERENCE_DENSITY_KG_PER_M3


def test_choked_flow_is_linear_upstream_and_blind_downstream():
    for upstream in (2e5, 3e5, 7e5):
        for ratio in (0.01, 0.2, 0.35):
            assert VALVE.mass_flow_kg_per_s(upstream, ratio * upstream) == pytest.approx(CHOKED * upstream, rel=1e-14)


def test_unchoked_flow_lies_on_the_ellipse():
    upstream = 2.5e5
    for ratio in np.linspace(0.351, 0.998, 40).tolist():
        flow = VALVE.mass_flow_kg_per_s(upstream, ratio * upstream)
        ellipse = (flow / (CHOKED * upstream)) ** 2 + ((ratio - 0.35) / (1.0 - 0.35)) ** 2
        assert ellipse == pytest.approx(1.0, rel=1e-12)


def test_flow_is_linear_near_equilibrium():
    upstream = 2e5
    flows = [VALVE.mass_flow_kg_per_s(upstream, upstream - drop) for drop in (25.0, 50.0, 100.0)]
    assert flows[1] == pytest.approx(2.0 * flows[0], rel=1e-9)
    assert flows[2] == pytest.approx(4.0 * flows[0], rel=1e-9)
    assert VALVE.mass_flow_kg_per_s(upstream, upstream) == 0.0


@pytest.mark.parametrize("ratio", [0.35, 0.999])
def test_flow_is_continuous_between_the_branches(ratio):
    upstream = 2e5
    below, above = (VALVE.mass_flow_kg_per_s(upstream, upstream * ratio * (1.0 + s * 1e-12)) for s in (-1, 1))
    assert below == pytest.approx(above, rel=1e-8)
    assert below > 0.0


def test_flow_is_antisymmetric():
    rng = np.random.default_rng(0)
    for one, other in rng.uniform(5e4, 3e5, (200, 2)).tolist():
        assert VALVE.mass_flow_kg_per_s(one, other) == -VALVE.mass_flow_kg_per_s(other, one)


def test_flow_depends_on_the_root_of_the_temperature():
    hot = Orifice(temperature_k=4.0 * 293.15)
    assert hot.mass_flow_kg_per_s(3e5, 1e4) == pytest.approx(0.5 * Orifice().mass_flow_kg_per_s(3e5, 1e4), rel=1e-14)


def test_slope_is_the_derivative_and_never_positive():
    reservoir = 2e5
    # both directions, choked, unchoked and linear, away from the branch points
    for chamber in (3e4, 9e4, 1.5e5, 1.98e5, 1.9995e5, 2.0005e5, 2.1e5, 3e5, 7e5):
        h = 1e-3 * abs(chamber - reservoir)
        flow = [VALVE.inflow_and_slope(reservoir, chamber + s * h)[0] for s in (-1.0, 1.0)]
        slope = VALVE.inflow_and_slope(reservoir, chamber)[1]
        assert slope == pytest.approx((flow[1] - flow[0]) / (2.0 * h), rel=1e-4, abs=1e-20)
        assert slope <= 0.0


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("sonic_conductance_m3_per_s_pa", 0.0),
        ("sonic_conductance_m3_per_s_pa", -1e-10),
        ("sonic_conductance_m3_per_s_pa", math.nan),
        ("critical_pressure_ratio", 1.0),
        ("laminar_pressure_ratio", 1.0),
        ("temperature_k", 0.0),
    ],
)
def test_bad_parameters_are_named(field, value):
    with pytest.raises(ValueError, match=field):
        Orifice(**{field: value})
