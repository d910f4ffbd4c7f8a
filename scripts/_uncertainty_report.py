"""Tables of the finger's uncertainty."""

from collections.abc import Mapping, Sequence
from typing import Any

from scripts._finger_markdown import NONE, rows
from softhand_sim.benchmark.report import trial_rows
from softhand_sim.calibration import JOINTS
from softhand_sim.uncertainty import Band, GraspRow, UncertaintyPlan, success_band, success_interval
from softhand_sim.uncertainty.grasps import DRAWN, NOMINAL, SCENARIO, held

Bands = Mapping[str, Mapping[str, Band]]


def band_table(bands: Bands, pressures_pa: Sequence[float]) -> str:
    """Return the bands as Markdown, a row a source."""
    kpa = [f"{1e-3 * p:g}" for p in pressures_pa]
    columns = [(f"tip_angle_deg_at_{p}_kpa", f"{p} kPa, degrees", ".1f", 1.0) for p in kpa]
    columns += [(f"tip_force_n_at_{p}_kpa", f"{p} kPa, mN at the tip", ".0f", 1e3) for p in kpa]
    columns += [(f"{joint}_stiffness_n_m_per_rad", f"{joint}, N mm/rad", ".1f", 1e3) for joint in JOINTS]
    # a tip that does not reach the wall in any finger has no column
    kept = [c for c in columns if any(own[c[0]].high for own in bands.values())]
    first = next(iter(bands.values()))
    body = [["nominal", *(_number(first[key].nominal, form, scale) for key, _, form, scale in kept)]]
    for name, own in bands.items():
        body.append([name, *(_range(own[key], form, scale) for key, _, form, scale in kept)])
    return rows(["source", *(title for _, title, _, _ in kept)], body)


def grasp_result(plan: UncertaintyPlan, found: Sequence[GraspRow]) -> dict[str, Any]:
    """Return settings, success of each object with its intervals, and every finger's trials, JSON ready."""
    return {
        "settings": {
            "trials": plan.trials,
            "fingers": plan.fingers,
            "spread": plan.spread,
            "seed": plan.seed,
            "protocol": plan.protocol.name,
            "set_pressures_of": "each finger" if plan.known_finger else "nominal finger",
        },
        "objects": {model.name: _success(plan, found, model.name) for model in plan.objects},
        "fingers": [
            {
                "name": row.name,
                "kind": row.kind,
                "source": row.source,
                "coordinates": dict(row.coordinates),
                "tip_angle_deg_at_set_pressure": row.tip_angle_deg_at_set_pressure,
                "refused": row.refused,
                "held": {model.name: held(row, model.name) for model in plan.objects} if row.trials else None,
                "trials": trial_rows(row.trials),
            }
            for row in found
        ],
    }


def grasp_table(result: Mapping[str, Any]) -> str:
    """Return success and its intervals as Markdown, and what the interval of the drawn fingers is made of."""
    body, shares = [], []
    for name, own in result["objects"].items():
        drawn = own["tolerances"]
        body.append([name, "nominal finger", _counts(own["nominal"]), _interval(own["nominal"])])
        body.append([name, "fingers within tolerance", _counts(drawn), _interval(drawn)])
        for source, one in own["scenarios"].items():
            rates = f"{one['lowest_rate']:.2f} to {one['highest_rate']:.2f}" if one["members"] else NONE
            number = len(one["members"])
            text = f"{source}: {number} of {number + len(one['without_trials'])} scenarios"
            body.append([name, text, rates, _interval(one) if one["members"] else NONE])
        parts = ", ".join(f"{key} {100.0 * part:.0f} %" for key, part in drawn["variance_shares"].items())
        shares.append(f"{name}: variance within tolerance: {parts}")
    lines = [rows(["object", "finger", "held", "95 % interval"], body), *shares]
    refused = [f"{row['name']}: no trials: {row['refused']}" for row in result["fingers"] if row["refused"]]
    return "\n".join([*lines, *refused])


def _success(plan: UncertaintyPlan, found: Sequence[GraspRow], name: str) -> dict[str, Any]:
    nominal = next(row for row in found if row.kind == NOMINAL)
    drawn = [row for row in found if row.kind == DRAWN]
    band = success_band([held(row, name) for row in drawn], plan.trials, [row.coordinates for row in drawn])
    scenarios = {}
    for source in dict.fromkeys(row.source for row in found if row.kind == SCENARIO):
        own = [row for row in found if row.source == source]
        members = [{"name": row.name, **_plain(held(row, name), plan.trials)} for row in own if row.trials]
        rates = [member["success_rate"] for member in members]
        scenarios[source] = {
            "members": members,
            "without_trials": {row.name: row.refused for row in own if not row.trials},
            "lowest_rate": min(rates, default=None),
            "highest_rate": max(rates, default=None),
            "low": min((member["low"] for member in members), default=None),
            "high": max((member["high"] for member in members), default=None),
        }
    return {
        "nominal": _plain(held(nominal, name), plan.trials),
        "tolerances": {
            "held": band.held,
            "trials": band.trials,
            "success_rate": band.rate,
            "low": band.low,
            "high": band.high,
            "variance_shares": dict(band.shares),
        },
        "scenarios": scenarios,
    }


def _plain(number: int, trials: int) -> dict[str, Any]:
    low, high = success_interval([number], trials)
    return {"held": number, "trials": trials, "success_rate": number / trials, "low": low, "high": high}


def _counts(one: Mapping[str, Any]) -> str:
    return f"{one['held']}/{one['trials']}"


def _interval(one: Mapping[str, Any]) -> str:
    return f"{one['low']:.2f} - {one['high']:.2f}"


def _number(value: float | None, form: str, scale: float) -> str:
    return NONE if value is None else f"{scale * value:{form}}"


def _range(band: Band, form: str, scale: float) -> str:
    text = f"{_number(band.low, form, scale)} to {_number(band.high, form, scale)}"
    return f"{text} ({len(band.missing)} missing)" if band.missing else text
