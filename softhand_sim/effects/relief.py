"""Relief at the proximal joint; the parameters are `ProximalRelief`."""

import numpy as np

from softhand_sim.effects.kind import ActsOn, Closing, Estimate
from softhand_sim.relief import ProximalRelief, Relief

ACTS_ON = ActsOn.TORQUE


def question(scene: Closing, law: ProximalRelief) -> Estimate:
    """Bound what the relief takes: from a finger held straight at the set pressure, taken as pressure that is missing.

    A bent finger's wall carries more of the pressure, so its thrust, and what the relief takes of it, is smaller.
    """
    calibration, set_pa = scene.calibration, float(scene.set_pa_gauge.max())
    relief = Relief(law=law, chamber=calibration.chamber, tendon=calibration.tendon)
    thrust = float(relief.thrust_n(np.zeros(1), np.array([set_pa]))[0])
    missing = max(0.0, thrust - law.thrust_n) / calibration.chamber.area_m2
    if missing == 0.0:
        reason = f"even a straight finger's thrust, {thrust:.2f} N, does not reach the relief's {law.thrust_n:.2f} N"
        return Estimate(own_deg=0.0, redraws=False, reason=reason)
    reason = f"the relief takes up to {missing / 1e3:.1f} kPa from a finger that is held straight"
    return Estimate(own_deg=scene.angle_change_deg(missing), redraws=True, reason=reason)
