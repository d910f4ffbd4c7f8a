"""What a design sweep measures of one finger: bending, tip force, grasp success."""

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from fea.density import Density
from fea.finger_design import FingerDesign
from fea.tip_wall import SENSOR_DISTANCE_M
from scripts import _cli, _solving
from scripts._sweep_report import Row, shown
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.report import summarise, trial_rows
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.calibration import FingerCalibration
from softhand_sim.grasp.plan import FIRM_ANGLE_DEG
from softhand_sim.objects.model import ObjectModel
from softhand_sim.uncertainty import measure


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What is measured of each finger, and where its files go."""

    density: Density
    pressures_pa_gauge: tuple[float, ...]
    objects: tuple[ObjectModel, ...]
    trials: int
    seed: int
    workers: int
    folder: Path


def measured(
    plan: Plan, number: int, values: dict[str, Any], design: FingerDesign | ValueError, solve: _solving.Solver
) -> Row:
    """Return the figures of one finger; without ``calibration``, and with the reason in ``ended``, if it has none."""
    if isinstance(design, ValueError):
        return {"ended": f"impossible: {design}"}
    start, start_process = time.perf_counter(), _process_s()
    label = ", ".join(f"{name} {shown(name, value)}" for name, value in values.items()) or "finger"
    try:
        solved, stored = solve(design, plan.density, label=label)
        calibration = _solving.checked(solved.artifact)
        file = plan.folder / f"finger-{number:02d}.json"
        _cli.write_json(file, dict(solved.artifact))
        row = {"calibration": str(file), "from_store": stored, **_bending(plan, solved.artifact, calibration)}
        row["solve_s"] = round(time.perf_counter() - start, 2)
        row |= _grasps(plan, file)
    except (ValueError, RuntimeError) as error:
        return {"ended": f"no result: {error}"}
    row["wall_s"] = round(time.perf_counter() - start, 2)
    row["process_s"] = round(_process_s() - start_process, 2)
    return row


def _bending(plan: Plan, artifact: Any, calibration: FingerCalibration) -> Row:
    """Return angles and tip forces, None beyond the pressure that the complete finger reached, and how it ended."""
    figures = measure(calibration, plan.pressures_pa_gauge, sensor_distance_m=SENSOR_DISTANCE_M)
    finger = artifact["fea"]["finger"]
    reached = max(finger["pressure_pa_gauge"])
    return {
        "pressure_pa_gauge": list(plan.pressures_pa_gauge),
        "tip_angle_deg": list(figures.tip_angle_deg),
        "fea_tip_angle_deg": [_fea_angle_deg(finger, p) for p in plan.pressures_pa_gauge],
        "tip_force_n": list(figures.tip_force_n),
        "closing_pressure_pa_gauge": calibration.closing_pressure(FIRM_ANGLE_DEG),
        "highest_pressure_pa_gauge": float(calibration.curve.pressure_pa_gauge[-1]),
        "ended": f"{finger['status']}, {1e-3 * reached:g} kPa",
    }


def _fea_angle_deg(finger: Any, pressure_pa: float) -> float | None:
    """Return the complete finger's angle while loading, linear between its load steps; None beyond them."""
    branch = finger.get("branch", ["loading"] * len(finger["pressure_pa_gauge"]))
    kept = [k for k, b in enumerate(branch) if b == "loading"]
    pressures = [finger["pressure_pa_gauge"][k] for k in kept]
    if pressure_pa > pressures[-1]:
        return None
    angles = [finger["tip_angle_rad"][k] for k in kept]
    return float(np.rad2deg(np.interp(pressure_pa, pressures, angles)))


def _grasps(plan: Plan, file: Path) -> Row:
    if not plan.objects:
        return {"objects": {}, "trials": []}
    benchmark = BenchmarkPlan(objects=plan.objects, trials=plan.trials, seed=plan.seed, calibration=file)
    total = len(plan.objects) * plan.trials
    results = list(tqdm(run_benchmark(benchmark, plan.workers), total=total, desc="trials", unit="trial"))
    results = in_order(benchmark, results)
    return {"objects": summarise(results), "trials": trial_rows(results)}


def _process_s() -> float:
    """Return the processor time of this process and of those it waited for [s]."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system
