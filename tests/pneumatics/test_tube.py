"""Friction flow in a tube: Hagen-Poiseuille and Blasius, in either direction."""

import math

import numpy as np
import pytest

from softhand_sim.air import VISCOSITY_PA_S
from softhand_sim.pneumatics.tube import Tube, Tubing, tube_volume_m3

RT = 287.05 * 293.15
TUBE = Tube(length_m=0.8)


def test_small_drops_follow_hagen_and_poiseuille_at_the_mean_density():
    """Volume flow pi d^4 dp / (128 mu L), which is the integral's limit for a small drop."""
    for upstream in (1e5, 2.5e5):
        drop = 20.0
        volume_flow = math.pi * 3e-3**4 * drop / (128.0 * VISCOSITY_PA_S * 0.8)
        density = (upstream - 0.5 * drop) / RT
        flow = TUBE.mass_flow_kg_per_s(upstream, upstream - drop)
        assert flow == pytest.approx(density * volume_flow, rel=1e-12)


def test_turbulent_flow_satisfies_darcy_with_the_friction_factor_of_blasius():
    upstream, downstream = 2.5e5, 1.0e5
    flow = TUBE.mass_flow_kg_per_s(upstream, downstream)
    re = 4.0 * flow / (math.pi * 3e-3 * VISCOSITY_PA_S)
    assert re > 4000.0
    difference = 16.0 * 0.316 * re**-0.25 * 0.8 * RT * flow**2 / (math.pi**2 * 3e-3**5)
    assert difference == pytest.approx(upstream**2 - downstream**2, rel=1e-12)


def test_flow_is_antisymmetric_and_continuous_between_the_branches():
    for one, other in np.random.default_rng(0).uniform(5e4, 3e5, (200, 2)).tolist():
        assert TUBE.mass_flow_kg_per_s(one, other) == -TUBE.mass_flow_kg_per_s(other, one)
    below, above = (TUBE.flow_and_slope(TUBE.crossing_pa2 * (1.0 + s * 1e-12))[0] for s in (-1, 1))
    assert below == pytest.approx(above, rel=1e-10)


def test_slope_is_the_derivative_and_never_positive():
    for chamber in (5e4, 1.9e5, 1.9999e5, 2.0001e5, 2.1e5, 3e5):
        h = 1e-4 * abs(chamber - 2e5)
        flow = [TUBE.inflow_and_slope(2e5, chamber + s * h)[0] for s in (-1.0, 1.0)]
        slope = TUBE.inflow_and_slope(2e5, chamber)[1]
        assert slope == pytest.approx((flow[1] - flow[0]) / (2.0 * h), rel=1e-5)
        assert slope < 0.0


def test_resistance_of_the_shared_tube_counts_once_for_each_finger():
    """Laminar: shared tube with the flow of three, then one's own, drop as much as the branch."""
    tubing, hub = Tubing(shared_length_m=0.4, finger_length_m=0.7), 2e5
    shared, own = Tube(length_m=0.4), Tube(length_m=0.7)
    flow = 1e-6
    middle = math.sqrt(hub**2 - 3.0 * flow / shared.laminar_kg_per_s_pa2)
    end = math.sqrt(middle**2 - flow / own.laminar_kg_per_s_pa2)
    assert tubing.branch(3).mass_flow_kg_per_s(hub, end) == pytest.approx(flow, rel=1e-6)
    assert tubing.volume_m3(3) == pytest.approx(shared.volume_m3 + 3 * own.volume_m3, rel=1e-14)
    assert tube_volume_m3(3) == pytest.approx(math.pi / 4.0 * 9e-6 * 2.0, rel=1e-14)


@pytest.mark.parametrize(
    ("cls", "field", "value"),
    [
        (Tube, "length_m", 0.0),
        (Tube, "length_m", math.nan),
        (Tube, "bore_m", -1e-3),
        (Tubing, "finger_length_m", 0.0),
        (Tubing, "shared_length_m", -0.1),
        (Tubing, "bore_m", 0.0),
    ],
)
def test_bad_parameters_are_named(cls, field, value):
    with pytest.raises(ValueError, match=field):
        cls(**({"length_m": 1.0} if cls is Tube else {}) | {field: value})
