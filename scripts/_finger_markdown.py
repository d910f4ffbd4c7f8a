"""Markdown tables of the runs of analysis (iii)."""

from collections.abc import Sequence
from typing import Any

import numpy as np

Run = dict[str, Any]
NONE = "-"


def rows(header: Sequence[str], body: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [header, ["---"] * len(header), *body]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def at(run: Run, key: str, pressure_pa: float, branch: str = "loading") -> float | None:
    """Return a figure at a pressure of a branch, or None where the run did not get there."""
    if key not in run:
        return None
    for p, b, value in zip(run["pressure_pa_gauge"], run["branch"], run[key], strict=True):
        if b == branch and abs(p - pressure_pa) <= 1e-6 * pressure_pa:
            return float(value)
    return None


def text(value: float | None, form: str = ".1f", scale: float = 1.0) -> str:
    """Return a number as text; a dash for None."""
    return NONE if value is None else f"{scale * value:{form}}"


def outcome(run: Run) -> str:
    """Return how a run ended and the highest pressure that it reached."""
    if "pressure_pa_gauge" not in run:
        return f"{run['status']}: {run['message']}"
    return f"{run['status']}, {1e-3 * max(run['pressure_pa_gauge']):g} kPa"


def convergence(runs: Sequence[Run], pressures_pa: Sequence[float]) -> str:
    """Return densities, formulations and volumetric readings, each against its reading's finest P2 run."""
    last = pressures_pa[-1]
    header = [
        *("mesh", "elements", "volumetric", "dofs"),
        *(f"{1e-3 * p:g} kPa, degrees" for p in pressures_pa),
        *("angle, change", f"volume at {1e-3 * last:g} kPa, ml", "volume, change"),
        *("iterations", "wall, s", "memory, GB", "ended"),
    ]
    body = []
    for run in runs:
        case = run["case"]
        finest = _finest(runs, case["volumetric"], last)
        body.append(
            [
                *(case["mesh"], case["formulation"], case["volumetric"], str(run.get("dofs", NONE))),
                *(text(at(run, "tip_angle_deg", p), ".2f") for p in pressures_pa),
                _change(run, finest, "tip_angle_deg", last),
                text(at(run, "volume_m3", last), ".3f", 1e6),
                _change(run, finest, "volume_m3", last),
                *_cost(run),
                text(run.get("peak_memory_bytes"), ".2f", 1e-9),
                outcome(run),
            ]
        )
    return rows(header, body)


def materials(runs: Sequence[Run], pressures_pa: Sequence[float]) -> str:
    """Return the pairs of material sets; how far the branches part where there is an unloading one."""
    header = [
        *("silicone", "TPU", "mesh", *(f"{1e-3 * p:g} kPa, degrees" for p in pressures_pa)),
        *("branches differ by, degrees", "iterations", "wall, s", "ended"),
    ]
    body = []
    for run in runs:
        case = run["case"]
        body.append(
            [
                *(case["silicone_set"], case["tpu_set"], case["mesh"]),
                *(text(at(run, "tip_angle_deg", p)) for p in pressures_pa),
                *(text(hysteresis_deg(run), ".2f"), *_cost(run), outcome(run)),
            ]
        )
    return rows(header, body)


def hysteresis_deg(run: Run) -> float | None:
    """Return the largest difference of the branches' tip angles at one pressure [degrees], None without unloading."""
    differences = []
    for p, branch in zip(run.get("pressure_pa_gauge", []), run.get("branch", []), strict=True):
        down, up = (at(run, "tip_angle_deg", p, b) for b in ("unloading", "loading"))
        if branch == "unloading" and down is not None and up is not None:
            differences.append(abs(down - up))
    return max(differences, default=None)


def sensitivity(base: Run, varied: Sequence[Run], pressure_pa: float) -> str:
    """Return each dimension's influence on the tip angle at a pressure.

    ``varied`` have ``dimension``, ``value`` (its default), ``unit`` ("m" or "rad") and ``change``, in that unit.
    """
    start = at(base, "tip_angle_deg", pressure_pa)
    header = ["dimension", "default", "change", "angles, degrees", "% per %", "degrees per 0.1 mm or degree", "remarks"]
    body = []
    for name in dict.fromkeys(run["dimension"] for run in varied):
        both = sorted((run for run in varied if run["dimension"] == name), key=lambda run: float(run["change"]))
        unit, value = both[0]["unit"], float(both[0]["value"])
        scale, sign = (1e3, "mm") if unit == "m" else (180.0 / np.pi, "degrees")
        angles = [at(run, "tip_angle_deg", pressure_pa) for run in both]
        slope = slope_per_unit(start, [(float(run["change"]), a) for run, a in zip(both, angles, strict=True)])
        relative = None if slope is None or not start or both[0]["shift"] else slope * value / start
        remarks = [
            f"{scale * run['change']:+.3g} {sign}: {outcome(run)}" for run in both if not _there(run, pressure_pa)
        ]
        body.append(
            [
                *(name, f"{scale * value:.4g} {sign}"),
                " / ".join(f"{scale * run['change']:+.3g}" for run in both),
                " / ".join(text(a, ".2f") for a in angles),
                *(text(relative, "+.2f"), text(slope, "+.3f", 1e-4 if unit == "m" else np.pi / 180.0)),
                "; ".join(remarks),
            ]
        )
    first = f"Unchanged: {text(start, '.2f')} degrees at {1e-3 * pressure_pa:g} kPa ({outcome(base)})\n\n"
    return first + rows(header, body)


def slope_per_unit(start: float | None, changed: Sequence[tuple[float, float | None]]) -> float | None:
    """Return d(angle)/d(dimension) of the outermost known points; the unchanged one stands in for a missing side."""
    known = [(change, angle) for change, angle in [(0.0, start), *changed] if angle is not None]
    if len(known) < 2:
        return None
    (low, a), (high, b) = min(known), max(known)
    return (b - a) / (high - low)


def surrogate(run: Run, curve: dict[str, Any]) -> str:
    """Return one run, with the surrogate of the shipped calibration in the last column."""
    header = [
        *("kPa", "tip, degrees", "joints 1 / 2 / 3", "tip moved, mm", "chamber volume", "least gap, mm", "contact, N"),
        "surrogate, degrees",
    ]
    body = []
    for i, (p, branch) in enumerate(zip(run["pressure_pa_gauge"], run["branch"], strict=True)):
        if i == 0:
            continue
        joints = " / ".join(f"{q:.1f}" for q in np.rad2deg(run["joint_rotation_rad"][i]))
        model = float(np.interp(p, curve["pressure_pa_gauge"], curve["tip_angle_deg"]))
        body.append(
            [
                f"{1e-3 * p:g}{'' if branch == 'loading' else ' ' + branch}",
                *(text(run["tip_angle_deg"][i]), joints, text(run["tip_displacement_m"][i], ".1f", 1e3)),
                f"{100.0 * (run['volume_m3'][i] / run['volume_m3'][0] - 1.0):+.1f} %",
                *(text(run["minimum_gap_m"][i], ".3f", 1e3), text(run["contact_force_n"][i], ".2f"), text(model)),
            ]
        )
    return rows(header, body) + f"\n\n{run['dofs']} dofs, {run['newton_iterations']} iterations, {outcome(run)}"


def _there(run: Run, pressure_pa: float) -> bool:
    return at(run, "tip_angle_deg", pressure_pa) is not None


def _cost(run: Run) -> list[str]:
    return [str(run.get("newton_iterations", NONE)), text(run.get("wall_s"), ".0f")]


def _finest(runs: Sequence[Run], volumetric: str, pressure_pa: float) -> Run | None:
    same = [
        run
        for run in runs
        if (run["case"]["volumetric"], run["case"]["formulation"]) == (volumetric, "P2") and _there(run, pressure_pa)
    ]
    return max(same, key=lambda run: int(run["dofs"]), default=None)


def _change(run: Run, finest: Run | None, key: str, pressure_pa: float) -> str:
    value, true = at(run, key, pressure_pa), None if finest is None else at(finest, key, pressure_pa)
    if run is finest:
        return "finest"
    return NONE if value is None or not true else f"{100.0 * (value / true - 1.0):+.2f} %"
