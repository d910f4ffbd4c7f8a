"""Bench test: pressure up; joint angles, tip angle and chamber volume against the finite elements, for all fingers."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration, FingerEvidence
from softhand_sim.characterize.bench import Bench
from softhand_sim.characterize.five_fingers import ATTITUDES, BENCH_ATTITUDES, pressure_angle
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source
from softhand_sim.elements import FINGERS

Vector = npt.NDArray[np.float64]
STATED_ANGLE_DEG, STATED_PRESSURE_PA_GAUGE = 95.0, 75e3
STATED = ("75 kPa gives 95 degrees (Alves et al.)",)
PRESSURES_PA_GAUGE = tuple(1e3 * p for p in range(0, 81, 10))
TIP_RMS_DEG, TIP_MAX_DEG, JOINT_RMS_DEG, VOLUME_PERCENT, STATED_LIMIT_DEG = 1.5, 3.0, 2.0, 3.0, 1.5
"""Limits of this project for the distance from the finite elements, and of the stated angle."""
# all fingers are identical; the index stands for them
SHOWN = FINGERS.index("index")


def pressure_angle_report(
    calibration: FingerCalibration,
    _evidence: FingerEvidence | None = None,
    *,
    pressures_pa_gauge: Sequence[float] = PRESSURES_PA_GAUGE,
    stated: bool = True,
) -> Report:
    """Hold the loading finger against the calibration's own analysis (iii), at the pressures that the fit did not see.

    ``pressures_pa_gauge`` are those of the five fingers' table. With gravity the angle is that of the stated pressure,
    for each attitude of the palm; it is held against the stated angle where the fingers bend in a level plane. Without
    ``stated`` that is left out: a finger of other materials has another angle, or ends below that pressure.

    Raises
    ------
    ValueError
        If a pressure lies outside the calibration's curve.
    """
    hand = pressure_angle(calibration, pressures_pa_gauge)
    own = [calibration.angle_for_pressure(p) for p in pressures_pa_gauge]
    single = _against_analysis(calibration)
    attitudes = {name: _at_stated(calibration, gravity) for name, gravity in ATTITUDES.items()} if stated else {}
    return Report(
        name="pressure-angle",
        figures={
            "pressure_pa_gauge": hand.pressure_pa_gauge.tolist(),
            "tip_angle_deg": hand.tip_angle_deg[:, SHOWN].tolist(),
            "joint_angle_deg": hand.joint_angle_deg[:, SHOWN].tolist(),
            "calibration_tip_angle_deg": own,
            "tip_angle_spread_between_fingers_deg": float(np.ptp(hand.tip_angle_deg, axis=1).max()),
            "unseen_pressure_pa_gauge": single["pressure"][single["unseen"]].tolist(),
            "unseen_joint_error_deg": single["joint_error_deg"].tolist(),
            "unseen_volume_error_ratio": single["volume_error"].tolist(),
            "tip_angle_deg_at_75_kpa_with_gravity": attitudes,
        },
        checks=(*_checks_against_analysis(single), *([_stated_check(attitudes)] if stated else [])),
        panels=_panels(single, calibration),
        stated=STATED if stated else (),
    )


def _checks_against_analysis(single: dict[str, Any]) -> tuple[Check, ...]:
    joint, tip = single["joint_error_deg"], single["joint_error_deg"].sum(axis=1)
    worst, volume = max(_rms(joint[:, k]) for k in range(3)), 100.0 * float(np.abs(single["volume_error"]).max())
    return (
        Check(name="tip angle, RMS", value=_rms(tip), limit=TIP_RMS_DEG, unit="degrees"),
        Check(name="tip angle, largest error", value=float(np.abs(tip).max()), limit=TIP_MAX_DEG, unit="degrees"),
        Check(name="each joint, largest RMS", value=worst, limit=JOINT_RMS_DEG, unit="degrees"),
        Check(name="volume, largest error", value=volume, limit=VOLUME_PERCENT, unit="%"),
    )


def _stated_check(attitudes: dict[str, list[float]]) -> Check:
    level = np.array([attitudes[name] for name in BENCH_ATTITUDES])
    return Check(
        name="five fingers with gravity, hand on its side, from the stated 95 degrees",
        value=float(np.abs(level - STATED_ANGLE_DEG).max()),
        limit=STATED_LIMIT_DEG,
        unit="degrees",
    )


def _at_stated(calibration: FingerCalibration, gravity: tuple[float, float, float]) -> list[float]:
    rest = pressure_angle(calibration, [STATED_PRESSURE_PA_GAUGE], gravity_m_per_s2=gravity)
    return [float(angle) for angle in rest.tip_angle_deg[0]]


def _against_analysis(calibration: FingerCalibration) -> dict[str, Any]:
    """Take one finger through the loading states of analysis (iii)."""
    analysis, bench = calibration.analysis, Bench(calibration)
    up = analysis.loading
    readings = [bench.go_to(p) for p in analysis.pressure_pa_gauge[up]]
    joints = np.degrees([reading.joint_angle_rad for reading in readings])
    volume = np.array([reading.volume_m3 for reading in readings])
    unseen = analysis.unseen[up]
    return {
        "pressure": analysis.pressure_pa_gauge[up],
        "unseen": unseen,
        "joints": joints,
        "volume": volume,
        "joint_error_deg": (joints - np.degrees(analysis.joint_angle_rad[up]))[unseen],
        "volume_error": (volume / analysis.chamber_volume_m3[up] - 1.0)[unseen],
    }


def _panels(single: dict[str, Any], calibration: FingerCalibration) -> tuple[Panel, ...]:
    analysis = calibration.analysis
    up, unseen = analysis.loading, single["unseen"]
    kpa: Vector = single["pressure"] / 1e3

    def curves(expected: Vector, found: Vector, label: str = "") -> tuple[Curve, ...]:
        groups = ((Source.FEA_FITTED, ~unseen), (Source.FEA, unseen))
        dots = (Curve(source=s, x=kpa[rows].tolist(), y=expected[rows].tolist()) for s, rows in groups)
        return (*dots, Curve(source=Source.SURROGATE, x=kpa.tolist(), y=found.tolist(), label=label))

    stated = Curve(source=Source.PAPER, x=[STATED_PRESSURE_PA_GAUGE / 1e3], y=[STATED_ANGLE_DEG])
    joints = np.degrees(analysis.joint_angle_rad[up])
    each = (curves(joints[:, k], single["joints"][:, k], j.name) for k, j in enumerate(calibration.joints))
    x_label = "pressure / kPa gauge"
    return (
        Panel(
            title="Tip angle, loading",
            x_label=x_label,
            y_label="degrees",
            curves=(*curves(analysis.tip_angle_deg[up], single["joints"].sum(axis=1)), stated),
        ),
        Panel(title="Joint angles", x_label=x_label, y_label="degrees", curves=tuple(c for cs in each for c in cs)),
        Panel(
            title="Chamber volume",
            x_label=x_label,
            y_label="mm3",
            curves=curves(1e9 * analysis.chamber_volume_m3[up], 1e9 * single["volume"]),
        ),
    )


def _rms(error: Vector) -> float:
    return float(np.sqrt(np.mean(error**2)))
