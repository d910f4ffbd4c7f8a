"""Relaxation of the actuators' walls; the parameters are `MaxwellBranch`."""

import numpy as np

from softhand_sim.effects.kind import ActsOn, Closing, Estimate

ACTS_ON = ActsOn.TORQUE


def question(scene: Closing) -> Estimate:
    """Bound what the branches hold back right after a closing at once: taken as pressure that is missing."""
    calibration, curve = scene.calibration, scene.calibration.curve
    set_pa = float(scene.set_pa_gauge.max())
    joints = [np.interp(set_pa, curve.pressure_pa_gauge, column) for column in curve.joint_angle_deg.T]
    elongation = calibration.elongation_m((np.radians(joints[0]), np.radians(joints[1]), np.radians(joints[2])))
    ratio = sum(branch.stiffness_ratio for branch in scene.relaxation)
    force = ratio * calibration.tendon.stiffness_n_per_m * elongation
    missing = float(force / calibration.chamber.area_m2_at(elongation))
    reason = f"relaxing walls hold back up to {missing / 1e3:.1f} kPa"
    return Estimate(own_deg=scene.angle_change_deg(missing), redraws=True, reason=reason)
