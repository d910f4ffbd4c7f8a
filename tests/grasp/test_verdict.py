import numpy as np
import pytest

from softhand_sim.grasp.verdict import Figures, Outcome, Thresholds, creep_rate_m_per_s, judge

HELD = {
    "commanded_lift_m": 0.15,
    "final_lift_m": 0.149,
    "highest_lift_m": 0.151,
    "slip_m": 0.002,
    "tilt_rad": 0.05,
    "creep_m_per_s": 1e-5,
    "penetration_m": 3e-4,
    "in_hand": True,
    "diverged": False,
}


@pytest.mark.parametrize(
    ("change", "outcome"),
    [
        ({}, Outcome.HELD),
        ({"slip_m": 0.011}, Outcome.SLIPPED),
        ({"tilt_rad": 0.3}, Outcome.SLIPPED),
        ({"creep_m_per_s": 1.1e-3}, Outcome.SLIPPED),
        ({"penetration_m": 2.1e-3}, Outcome.PENETRATED),
        ({"penetration_m": 2.1e-3, "slip_m": 0.011}, Outcome.PENETRATED),
        ({"final_lift_m": 0.05}, Outcome.DROPPED),
        ({"in_hand": False}, Outcome.DROPPED),
        ({"final_lift_m": -0.01, "highest_lift_m": 0.03}, Outcome.DROPPED),
        ({"final_lift_m": 0.0, "highest_lift_m": 0.01}, Outcome.MISSED),
        ({"diverged": True}, Outcome.DIVERGED),
    ],
)
def test_outcome(change, outcome):
    assert judge(Thresholds(), Figures(**{**HELD, **change})) is outcome


def test_creep_of_a_steady_drift_is_its_speed():
    time = np.linspace(0, 3, 151)
    velocity = np.array([2e-5, -1e-5, 2e-5])
    wobble = 1e-7 * np.cos(2 * np.pi * 10 * time)[:, None]
    assert creep_rate_m_per_s(time, time[:, None] * velocity + wobble) == pytest.approx(3e-5, rel=1e-2)


def test_threshold_out_of_range_is_named():
    with pytest.raises(ValueError, match="slip_m = 0"):
        Thresholds(slip_m=0.0)
