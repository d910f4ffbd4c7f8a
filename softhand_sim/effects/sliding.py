"""Sliding hysteresis: friction of the actuators in their exoskeletons."""

import math
from dataclasses import dataclass

from softhand_sim.effects.kind import ActsOn, Closing, Estimate

ACTS_ON = ActsOn.TORQUE


@dataclass(frozen=True, kw_only=True)
class SlidingHysteresis:
    """Friction with the coefficient of the calibration (`SlidingFriction`); it has no parameters of its own."""


def question(scene: Closing) -> Estimate:
    """Bound what friction holds back: its largest share of the thrust, taken as pressure that is missing."""
    calibration, set_pa = scene.calibration, float(scene.set_pa_gauge.max())
    bend = math.radians(calibration.angle_for_pressure(set_pa))
    share = calibration.sliding.coefficient_per_rad * bend
    own = scene.angle_change_deg(share * set_pa)
    reason = f"friction takes up to {share:.1%} of the thrust at the set pressure"
    return Estimate(own_deg=own, redraws=share > 0.0, reason=reason)
