"""Sliding friction of the actuators in their exoskeletons: the finger's hysteresis."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import ChamberCalibration, SlidingCalibration

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class SlidingFriction:
    """Elastic-perfectly plastic friction along each finger's tendon, as a rope's around a pulley.

    The force is that of a spring between the elongation and the slip, and the slip follows as soon as the force would
    pass ``c p A(delta) sum |theta_i|``, a share of the thrust that grows with the bending. It does no work but on the
    slip, against it, so it never gives energy away. The engine's own dry friction (``frictionloss``) has one bound for
    all pressures and creeps below it; this force goes through an actuator's ``ctrl`` instead.
    """

    law: SlidingCalibration
    chamber: ChamberCalibration

    def step(
        self, slip_m: Vector, elongation_m: Vector, bend_rad: Vector, pressure_pa_gauge: Vector
    ) -> tuple[Vector, Vector]:
        """Return slip [m] and force [N] along the elongation, each of the fingers' shape (n,).

        Parameters
        ----------
        slip_m
            Slip so far.
        elongation_m, bend_rad, pressure_pa_gauge
            Elongation of the tendon, sum of the joints' absolute angles, and pressure of each finger (0 or above).
        """
        stiffness = self.law.stiffness_n_per_m
        area = self.chamber.area_m2 + self.chamber.area_slope_m * elongation_m
        reach = (self.law.coefficient_per_rad / stiffness) * bend_rad * pressure_pa_gauge * area
        # twice as fast as np.clip on five numbers
        stretch = np.minimum(np.maximum(elongation_m - slip_m, -reach), reach)
        return elongation_m - stretch, -stiffness * stretch


def sliding_friction(law: SlidingCalibration, chamber: ChamberCalibration) -> SlidingFriction | None:
    """Return the friction of a calibration, None if it has none."""
    return SlidingFriction(law=law, chamber=chamber) if law.coefficient_per_rad > 0.0 else None
