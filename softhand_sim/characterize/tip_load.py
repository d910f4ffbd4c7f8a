"""Bench test: loads on the tip at constant pressure, towards the back of the hand."""

from typing import Any

import numpy as np

from softhand_sim.calibration import FingerCalibration, FingerEvidence
from softhand_sim.characterize.bench import Bench
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source

LIMIT_PERCENT = 10.0
SEEN_PA_GAUGE = 45e3
"""The identification saw no loaded state, but one of its constants, ``GAP_BULGING``, was chosen at this pressure."""


def tip_load(calibration: FingerCalibration, evidence: FingerEvidence) -> Report:
    """Hold the tip's deflection under load against the finite elements; see ``SEEN_PA_GAUGE``.

    Raises
    ------
    ValueError
        If the evidence is of another finger.
    """
    evidence.require_same_finger(calibration)
    rows: list[dict[str, Any]] = []
    checks, curves = [], []
    for test in evidence.tip_loads:
        bench = Bench(calibration)
        readings = [bench.go_to(test.pressure_pa_gauge, load) for load in test.tip_load_n]
        tip = np.array([reading.tip_displacement_m for reading in readings])
        deflection, expected = tip[0] - tip, test.deflection_m
        error = deflection[1:] / expected[1:] - 1.0
        kpa = f"{test.pressure_pa_gauge / 1e3:g} kPa"
        rows.append(
            {
                "pressure_pa_gauge": test.pressure_pa_gauge,
                "tip_load_n": test.tip_load_n.tolist(),
                "deflection_m": deflection.tolist(),
                "fea_deflection_m": expected.tolist(),
                "joint_angle_deg": np.degrees([reading.joint_angle_rad for reading in readings]).tolist(),
                "fea_joint_angle_deg": np.degrees(test.joint_angle_rad).tolist(),
                "deflection_error_ratio": error.tolist(),
            }
        )
        worst = 100.0 * float(np.abs(error).max())
        checks.append(Check(name=f"deflection at {kpa}, largest error", value=worst, limit=LIMIT_PERCENT, unit="%"))
        load = test.tip_load_n.tolist()
        source = Source.FEA_FITTED if test.pressure_pa_gauge == SEEN_PA_GAUGE else Source.FEA
        curves.append(Curve(source=source, x=load, y=(1e3 * expected).tolist()))
        curves.append(Curve(source=Source.SURROGATE, x=load, y=(1e3 * deflection).tolist(), label=kpa))
    return Report(
        name="tip-load",
        figures={"tests": rows},
        checks=tuple(checks),
        panels=(
            Panel(
                title="Load on the tip at constant pressure",
                x_label="load towards the back of the hand / N",
                y_label="deflection of the tip / mm",
                curves=tuple(curves),
            ),
        ),
    )
