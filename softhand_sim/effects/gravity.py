"""Gravity on the fingers."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from softhand_sim.effects.kind import ActsOn, Closing, Estimate
from softhand_sim.elements import FINGERS

ACTS_ON = ActsOn.MODEL


@dataclass(frozen=True, kw_only=True)
class FingerGravity:
    """The fingers' own weight bends them; it has no parameters of its own (see `EngineSettings`)."""


def without_gravity(root: Any) -> None:
    """Take the weight off the fingers of a hand's MJCF, before it is compiled; palm and object keep theirs."""
    for finger in FINGERS:
        for body in root.find_all("body"):
            if body.name is not None and body.name.startswith(f"{finger}_"):
                body.gravcomp = 1.0


def weight_bend_deg(scene: Closing) -> float:
    """Bound what the weight bends: each joint's softest state up to the set pressure, the rest of the finger level.

    A joint's compliance is that of the calibration's curve, ``d(theta)/dp`` over the moment ``A r`` of a pascal.
    """
    calibration = scene.calibration
    curve, finger = calibration.curve, calibration.finger
    reached = curve.pressure_pa_gauge <= scene.set_pa_gauge.max() + 1e3
    angle = np.radians(curve.joint_angle_deg)
    area = np.array([calibration.chamber.area_m2_at(calibration.elongation_m(tuple(row.tolist()))) for row in angle])
    arm = np.array([joint.offset_m for joint in calibration.joints])
    softness = np.gradient(angle, curve.pressure_pa_gauge, axis=0) / (area[:, None] * arm)
    beyond = finger.length_m - np.array(finger.joint_position_m)
    weight = 9.81 * finger.mass_kg * beyond / finger.length_m
    return float(np.degrees(softness[reached].max(axis=0) @ (weight * 0.5 * beyond)))


def question(scene: Closing) -> Estimate:
    """Ask for what the weight bends; the engine takes longer to take it off than to leave it on."""
    bent = weight_bend_deg(scene)
    reason = f"their weight bends the fingers by at most {bent:.1f} degrees"
    return Estimate(own_deg=bent, redraws=True, saves=False, reason=f"{reason}; leaving it out saves no time")
