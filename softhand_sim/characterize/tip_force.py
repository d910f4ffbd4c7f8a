"""Bench test: the tip pushes against a force sensor in front of it."""

import numpy as np

from softhand_sim.calibration import FingerCalibration, FingerEvidence
from softhand_sim.characterize.bench import Bench
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source

# neither the finite elements nor the surrogate level off there
STATED = (
    "clamped 40 mm from the sensor the tip's force is quasi-linear in pressure and levels off at 80 kPa (Alves et al.)",
)
FORCE_LIMIT, LINEAR_LIMIT = 0.10, 0.05
"""Shares: error of the force against the finite elements; distance from a straight line for "quasi-linear" (choice)."""


def tip_force(calibration: FingerCalibration, evidence: FingerEvidence) -> Report:
    """Hold the force of the blocked tip against the finite elements, none of which the fit has seen.

    Raises
    ------
    ValueError
        If the evidence is of another finger.
    """
    evidence.require_same_finger(calibration)
    blocked = evidence.blocked
    bench = Bench(calibration, wall_distance_m=blocked.sensor_distance_m)
    readings = [bench.go_to(pressure) for pressure in blocked.pressure_pa_gauge]
    force = np.array([reading.wall_force_n for reading in readings])
    angle = np.array([reading.joint_angle_rad for reading in readings])
    pressure, expected = blocked.pressure_pa_gauge, blocked.tip_force_n
    touching = expected > 0.0
    error = force[touching] / expected[touching] - 1.0
    line = np.polynomial.Polynomial.fit(pressure[touching], force[touching], 1)
    bent = float(np.abs(force[touching] - line(pressure[touching])).max() / force.max())
    return Report(
        name="tip-force",
        figures={
            "sensor_distance_m": blocked.sensor_distance_m,
            "pressure_pa_gauge": pressure.tolist(),
            "tip_force_n": force.tolist(),
            "fea_tip_force_n": expected.tolist(),
            "joint_angle_deg": np.degrees(angle).tolist(),
            "fea_joint_angle_deg": np.degrees(blocked.joint_angle_rad).tolist(),
            "force_error_ratio": error.tolist(),
        },
        checks=(
            Check(
                name="blocked tip force, largest error", value=100.0 * float(np.abs(error).max()), limit=10, unit="%"
            ),
            Check(name="distance from a line", value=100.0 * bent, limit=100.0 * LINEAR_LIMIT, unit="% of the largest"),
            Check(
                name="force before the tip arrives",
                value=float(np.max(force[~touching], initial=0.0)),
                limit=0.0,
                unit="N",
            ),
        ),
        panels=(
            Panel(
                title=f"Blocked tip, sensor at {1e3 * blocked.sensor_distance_m:g} mm",
                x_label="pressure / kPa gauge",
                y_label="force on the sensor / N",
                curves=(
                    Curve(source=Source.FEA, x=(pressure / 1e3).tolist(), y=expected.tolist()),
                    Curve(source=Source.SURROGATE, x=(pressure / 1e3).tolist(), y=force.tolist()),
                ),
            ),
        ),
        stated=STATED,
    )
