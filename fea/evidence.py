"""Evidence: what the finite-element finger does on bench tests, as a file that the runtime is held against.

Five runs of analysis (iii): a closed pressure cycle, of which the identification has seen every second state down to
40 kPa on the way back, and four that it never sees: the blocked tip, and loads on the tip at three pressures.
"""

import json
from dataclasses import asdict, dataclass, replace
from typing import Any

from fea.study import FingerCase, Setup
from fea.tip_wall import SENSOR_DISTANCE_M

SCHEMA, SCHEMA_VERSION = "softhand-sim/finger-evidence", 1


@dataclass(frozen=True, kw_only=True)
class Run:
    """One run: the finger's case and its pressures [Pa gauge]."""

    case: FingerCase
    pressures_pa_gauge: tuple[float, ...]


def _kpa(*values: float) -> tuple[float, ...]:
    return tuple(1e3 * value for value in values)


def _tip_load(pressures_pa_gauge: tuple[float, ...], *loads_n: float) -> Run:
    return Run(case=FingerCase(unload=False, tip_loads_n=loads_n), pressures_pa_gauge=pressures_pa_gauge)


TIP_LOADS = ("tip_load_30_kpa", "tip_load_45_kpa", "tip_load_60_kpa")
RUNS = {
    "cycle": Run(case=FingerCase(unload=True), pressures_pa_gauge=_kpa(*range(5, 85, 5))),
    "blocked": Run(
        case=FingerCase(unload=False, sensor_distance_m=SENSOR_DISTANCE_M),
        pressures_pa_gauge=_kpa(10, 20, 30, 40, 45, 50, 55, 60, 65, 70, 75, 80),
    ),
    "tip_load_30_kpa": _tip_load(_kpa(10, 20, 30), 0.01, 0.02, 0.03, 0.04, 0.06, 0.08),
    "tip_load_45_kpa": _tip_load(_kpa(15, 30, 45), 0.02, 0.05, 0.1, 0.15, 0.2),
    "tip_load_60_kpa": _tip_load(_kpa(10, 20, 30, 40, 50, 60), 0.02, 0.04, 0.06, 0.08, 0.1, 0.15),
}
"""Choices: every 5 kPa, twice as dense as the fit; blocked from where the tip arrives, at 40 mm as in the paper; loads
that bend the finger back by half or so, but for the last ones at 45 kPa, which straighten it."""


def check_run(name: str, run: Run, figures: dict[str, Any], setup: Setup, *, any_code: bool) -> None:
    """Check that figures, as ``scripts/fea.py finger --json`` writes them, are those of a run with this setup.

    With ``any_code`` what older code did not know of a finger's case has its default.

    Raises
    ------
    ValueError
        If they are of another finger, material, mesh, case, code (unless ``any_code``), or ended early.
    """
    case = replace(setup, finger=run.case)
    wanted = json.loads(json.dumps(case.provenance()))
    keys = ["geometry", "materials", "density", "rings", "finger"] + ([] if any_code else ["code_sha256"])
    found = figures.get("provenance", {})
    if any_code and isinstance(found.get("finger"), dict):
        found = found | {"finger": json.loads(json.dumps(asdict(FingerCase()))) | found["finger"]}
    for key in keys:
        if found.get(key) != wanted[key]:
            raise ValueError(f"{name}: provenance.{key} is not that of this run")
    path = run.case.path(run.pressures_pa_gauge)
    targets = [0.0, *path.targets]
    for field, value in (("pressure_pa_gauge", path.pressure), ("tip_load_n", path.tip_load)):
        if figures.get(field) != [value(target) for target in targets]:
            raise ValueError(f"{name}: {field} is not that of this run, or it ended early")


def evidence(runs: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Return the file's contents from the figures of all runs; deterministic, SI units, JSON ready."""
    cycle, blocked = runs["cycle"], runs["blocked"]
    first = cycle["provenance"]
    kept = ("linear_solver", "element_kernels", "code_sha256", "finger")
    cost = ("dofs", "elements", "newton_iterations", "wall_s", "status")
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "geometry": first["geometry"],
        "cycle": {
            "branch": cycle["branch"],
            "pressure_pa_gauge": cycle["pressure_pa_gauge"],
            "joint_angle_rad": cycle["joint_rotation_rad"],
            "chamber_volume_m3": cycle["volume_m3"],
        },
        "blocked": {
            "sensor_distance_m": blocked["provenance"]["finger"]["sensor_distance_m"],
            "pressure_pa_gauge": blocked["pressure_pa_gauge"],
            "joint_angle_rad": blocked["joint_rotation_rad"],
            "tip_force_n": blocked["tip_force_n"],
        },
        "tip_loads": [_loaded_rows(runs[name]) for name in TIP_LOADS],
        "provenance": {
            "materials": first["materials"],
            "density": first["density"],
            "runs": {
                name: {key: figures["provenance"][key] for key in kept} | {key: figures[key] for key in cost}
                for name, figures in runs.items()
            },
        },
    }


def _loaded_rows(figures: dict[str, Any]) -> dict[str, Any]:
    """Return the rows at the last pressure: unloaded first, then loaded."""
    pressure = max(figures["pressure_pa_gauge"])
    start = figures["pressure_pa_gauge"].index(pressure)
    return {
        "pressure_pa_gauge": pressure,
        "tip_load_n": figures["tip_load_n"][start:],
        "joint_angle_rad": figures["joint_rotation_rad"][start:],
        "tip_displacement_m": figures["tip_displacement_m"][start:],
    }
