"""Bench test: what the finger's own weight does, against the finite elements under the same gravity."""

from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration, FingerEvidence, WeightEvidence, load_weight_evidence
from softhand_sim.calibration.weight import weightless_deg
from softhand_sim.characterize.bench import Bench
from softhand_sim.characterize.five_fingers import ATTITUDES, pressure_angle
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source
from softhand_sim.elements import FINGERS
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene

Vector = npt.NDArray[np.float64]
PRESSURE_PA_GAUGE = 75e3
ANGLE_LIMIT_DEG, SHARE_LIMIT_PERCENT = 3.0, 35.0
"""Limits of this project: of any angle from the finite elements; of the change by the weight (choice: the surrogate's
joints share one thrust, the finite elements' hardly do, docs/fidelity.md)."""
_SAME_DIRECTION = np.cos(np.radians(3.0))
"""Choice: fingers of the hand whose gravity, in the plane in which they bend, is that of an attitude."""


def weight(
    calibration: FingerCalibration, _evidence: FingerEvidence | None = None, *, weighed: WeightEvidence | None = None
) -> Report:
    """Hold the change of the tip angle by the weight against the finite elements, then the hand's five fingers.

    ``weighed`` is the evidence, the shipped one by default. Of the hand those fingers are held against an attitude that
    bend under its gravity: the four long ones.

    Raises
    ------
    ValueError
        If the evidence is of another finger.
    """
    weighed = load_weight_evidence() if weighed is None else weighed
    weighed.require_same_finger(calibration)
    rows = [_attitude(calibration, weighed, k) for k in range(len(weighed.attitudes))]
    hand = hand_rows(calibration, weighed)
    change, expected = (np.array([row[key] for row in rows]) for key in ("change_deg", "fea_change_deg"))
    last = np.abs(change[:, -1] / expected[:, -1] - 1.0)
    off = [angle - row["fea_deg"] for row in hand.values() for angle in row["tip_angle_deg"].values()]
    return Report(
        name="weight",
        figures={
            "attitudes": rows,
            "hand_tip_angle_deg_at_75_kpa": hand,
        },
        checks=(
            Check(
                name="change of the tip angle by weight at 75 kPa, largest error",
                value=100.0 * float(last.max()),
                limit=SHARE_LIMIT_PERCENT,
                unit="%",
            ),
            Check(
                name="tip angle under its weight, from the finite elements",
                value=max(float(np.abs(np.subtract(r["tip_angle_deg"], r["fea_tip_angle_deg"])).max()) for r in rows),
                limit=ANGLE_LIMIT_DEG,
                unit="degrees",
            ),
            Check(
                name="long fingers of the hand at 75 kPa, from the finite elements",
                value=float(np.abs(off).max()),
                limit=ANGLE_LIMIT_DEG,
                unit="degrees",
            ),
        ),
        panels=(_panel(rows),),
    )


def _attitude(calibration: FingerCalibration, weighed: WeightEvidence, k: int) -> dict[str, Any]:
    """Take one finger through an attitude's pressures, with its weight and without."""
    evidence = weighed.attitudes[k]
    pressures, expected = evidence.pressure_pa_gauge[1:], evidence.tip_angle_deg[1:]
    across, along = evidence.gravity_m_per_s2.tolist()
    heavy, light = Bench(calibration, gravity_m_per_s2=(across, 0.0, along)), Bench(calibration)
    bent = np.array([heavy.go_to(p).tip_angle_deg for p in pressures])
    change = bent - [light.go_to(p).tip_angle_deg for p in pressures]
    return {
        "name": evidence.name,
        "gravity_m_per_s2": [across, along],
        "pressure_pa_gauge": pressures.tolist(),
        "tip_angle_deg": bent.tolist(),
        "change_deg": change.tolist(),
        "fea_tip_angle_deg": expected.tolist(),
        "fea_change_deg": (expected - [weightless_deg(calibration, p) for p in pressures]).tolist(),
    }


def hand_rows(calibration: FingerCalibration, weighed: WeightEvidence) -> dict[str, dict[str, Any]]:
    """Return for each attitude the finite elements' angle at 75 kPa and those of the fingers that are in it [deg]."""
    model = compile_scene(build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))).model
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found = {}
    for evidence in weighed.attitudes:
        gravity, pull = ATTITUDES[evidence.name], evidence.gravity_m_per_s2
        angle = pressure_angle(calibration, [PRESSURE_PA_GAUGE], gravity_m_per_s2=gravity).tip_angle_deg[0]
        same = {}
        for finger, tip in zip(FINGERS, angle.tolist(), strict=True):
            own = (data.body(f"{finger}_base").xmat.reshape(3, 3).T @ np.array(gravity))[[0, 2]]
            if own @ pull >= _SAME_DIRECTION * np.linalg.norm(own) * np.linalg.norm(pull):
                same[finger] = tip
        row = int(np.flatnonzero(evidence.pressure_pa_gauge == PRESSURE_PA_GAUGE)[0])
        found[evidence.name] = {"fea_deg": float(evidence.tip_angle_deg[row]), "tip_angle_deg": same}
    return found


def _panel(rows: list[dict[str, Any]]) -> Panel:
    curves = []
    for row in rows:
        kpa = [1e-3 * p for p in row["pressure_pa_gauge"]]
        curves.append(Curve(source=Source.FEA, x=kpa, y=row["fea_change_deg"]))
        curves.append(Curve(source=Source.SURROGATE, x=kpa, y=row["change_deg"], label=row["name"]))
    return Panel(
        title="Change of the tip angle by the finger's own weight",
        x_label="pressure / kPa gauge",
        y_label="degrees",
        curves=tuple(curves),
    )
