"""What is compared between fingers: bending, blocked tip force, stiffness of the joints."""

from collections.abc import Sequence
from dataclasses import dataclass

from softhand_sim.calibration import JOINTS, FingerCalibration
from softhand_sim.characterize.bench import Bench

SENSOR_DISTANCE_M = 0.040
"""Clamped 40 mm from the force sensor: Alves et al., section 3.3."""
STIFFNESS_ANGLE_RAD = 0.15
"""Choice: 9 degrees, which the joints of the stiffest pair of materials reach at 80 kPa; beyond, its laws are carried
on by their polynomials."""


@dataclass(frozen=True, kw_only=True)
class FingerFigures:
    """A finger in numbers; None beyond the pressures that it was calibrated for.

    Attributes
    ----------
    pressure_pa_gauge : tuple (n,)
    tip_angle_deg, tip_force_n : tuples (n,)
        Free bending, and force on a frictionless wall in front of the tip.
    joint_stiffness_n_m_per_rad : tuple (3,)
        Torque over angle at 0.15 rad, proximal to distal.
    """

    pressure_pa_gauge: tuple[float, ...]
    tip_angle_deg: tuple[float | None, ...]
    tip_force_n: tuple[float | None, ...]
    joint_stiffness_n_m_per_rad: tuple[float, ...]

    def as_dict(self) -> dict[str, float | None]:
        """Return every figure by a name with its unit, JSON ready."""
        named: dict[str, float | None] = {}
        for pressure, angle, force in zip(self.pressure_pa_gauge, self.tip_angle_deg, self.tip_force_n, strict=True):
            named[f"tip_angle_deg_at_{1e-3 * pressure:g}_kpa"] = angle
            named[f"tip_force_n_at_{1e-3 * pressure:g}_kpa"] = force
        stiffness = zip(JOINTS, self.joint_stiffness_n_m_per_rad, strict=True)
        return named | {f"{joint}_stiffness_n_m_per_rad": value for joint, value in stiffness}


def measure(
    calibration: FingerCalibration,
    pressures_pa_gauge: Sequence[float],
    *,
    sensor_distance_m: float = SENSOR_DISTANCE_M,
) -> FingerFigures:
    """Measure a finger at increasing pressures."""
    highest = float(calibration.curve.pressure_pa_gauge[-1])
    within = [p for p in pressures_pa_gauge if p <= highest]
    beyond = (None,) * (len(pressures_pa_gauge) - len(within))
    bench = Bench(calibration, wall_distance_m=sensor_distance_m)
    return FingerFigures(
        pressure_pa_gauge=tuple(pressures_pa_gauge),
        tip_angle_deg=(*(calibration.angle_for_pressure(p) for p in within), *beyond),
        tip_force_n=(*(bench.go_to(p).wall_force_n for p in within), *beyond),
        joint_stiffness_n_m_per_rad=tuple(
            sum(k * STIFFNESS_ANGLE_RAD**n for n, k in enumerate(joint.polynomial)) for joint in calibration.joints
        ),
    )
