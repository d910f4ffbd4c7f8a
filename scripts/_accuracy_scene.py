"""The scene's ladder: every point on the same random scenes, the bare engine among them, in changing order."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from scripts import _cli
from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects.bare import BareHand
from softhand_sim.fidelity.fidelity import Fidelity
from softhand_sim.fidelity.front import CONFIDENCE, SCHEMA, SCHEMA_VERSION, SHARE, bound
from softhand_sim.fidelity.points import CANDIDATES, DEFAULT_NAME, EFFECTS, FINEST_NAME, FULL_NAME, NUMERICS, SHAPES
from softhand_sim.fidelity.scenes import BareScene, GraspScene, LadderScene, SceneFigures, draw_scenes, error
from softhand_sim.grasp.stage import SAMPLE_S
from softhand_sim.grasp.trial import run_trial
from softhand_sim.simulation import HandSimulation

ENGINE = "bare engine"
ENGINE_STEPS = 10
"""The engine's steps from each state of the default run, which are 20 ms apart: as many as the run has there."""
COMMAND = "scripts/accuracy_vs_time.py scene --points"
_WARM = BareScene(hand=BareHand(set_angle_deg=(40.0, 40.0, 40.0), close_s=0.1, hold_s=0.1), seed=0)
_SETTINGS = {**NUMERICS, **SHAPES}
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
Row = dict[str, Any]


GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "candidates": CANDIDATES,
        "numerics": tuple(name for name in NUMERICS if name not in CANDIDATES),
        "shapes": tuple(SHAPES),
        "effects": tuple(EFFECTS),
    }
)
"""Points that are measured together; each group on scenes of its own, with the default and the engine among them."""
FRONT_SEED = 2000
"""Added to the seed for the candidates' scenes: not those by which they were made candidates."""


def run_point(name: str, scene: LadderScene, calibration: FingerCalibration) -> SceneFigures:
    """Run one point on one scene."""
    if name in EFFECTS:
        return scene.run(calibration, Fidelity(), EFFECTS[name])
    return scene.run(calibration, _SETTINGS[name])


def base_of(name: str) -> str:
    """Return what a point's errors are measured against: the finest setting, or all effects."""
    return FULL_NAME if name in EFFECTS else FINEST_NAME


def measure(
    calibration: FingerCalibration, names: Sequence[str], scenes: int, seed: int, kept: Path, tick: Callable[[], None]
) -> list[Row]:
    """Run the points on every scene and return a row a scene; what the kept file has isn't run again."""
    wanted = list(dict.fromkeys((*names, *(base_of(name) for name in names), DEFAULT_NAME)))
    drawn = draw_scenes(scenes, seed)
    rows = _read(kept, wanted, seed)
    for _ in rows[:scenes]:
        tick()
    rng = np.random.default_rng(seed + len(rows))
    # kernels are compiled for each number of hinges: no cost of the first scene
    for name in wanted if len(rows) < scenes else ():
        run_point(name, _WARM, calibration)
    for scene in drawn[len(rows) :]:
        runs = _runs(scene, wanted, calibration, rng)
        rows.append({"scene": scene.name, "grasp": isinstance(scene, GraspScene), "runs": runs})
        _cli.write_json(kept, {"points": wanted, "seed": seed, "rows": rows})
        tick()
    return rows[:scenes]


def _read(kept: Path, wanted: Sequence[str], seed: int) -> list[Row]:
    if not kept.exists():
        return []
    content = json.loads(kept.read_text(encoding="utf-8"))
    if content.get("points") != list(wanted) or content.get("seed") != seed:
        raise ValueError(f"{kept}: holds other points or another seed; give another folder")
    return list(content["rows"])


def _runs(scene: LadderScene, names: Sequence[str], calibration: FingerCalibration, rng: np.random.Generator) -> Row:
    runs: Row = {}
    jobs = [*names, *([ENGINE] if isinstance(scene, GraspScene) else [])]
    for k in rng.permutation(len(jobs)):
        name = jobs[k]
        if name == ENGINE and isinstance(scene, GraspScene):
            runs[name] = _engine(scene, calibration)
        else:
            found = run_point(name, scene, calibration)
            runs[name] = asdict(found) | {"tip_angle_deg": [_finite(a) for a in found.tip_angle_deg.tolist()]}
    return {name: runs[name] for name in jobs}


def _digits(value: float) -> float:
    """Return six digits of an error: the file is no larger than it need be."""
    return float(f"{_finite(value):.6g}")


def _finite(value: float) -> float:
    return value if np.isfinite(value) else 1e9


def _engine(scene: GraspScene, calibration: FingerCalibration) -> Row:
    """Step the bare engine through the states of the default run, nothing between its steps."""
    setup = scene.prepare(calibration, Fidelity())
    model, states = setup.scene.model, list[npt.NDArray[np.float64]]()

    def watch(simulation: HandSimulation) -> None:
        states.append(np.empty(mujoco.mj_stateSize(model, _STATE)))
        mujoco.mj_getState(model, simulation.data, states[-1], _STATE)

    run_trial(setup, scene.seed, watch)
    data = mujoco.MjData(model)
    began = time.thread_time()
    for state in states:
        mujoco.mj_setState(model, data, state, _STATE)
        mujoco.mj_step(model, data, ENGINE_STEPS)
    return {"processor_s": time.thread_time() - began, "simulated_s": len(states) * SAMPLE_S}


def points(rows: Sequence[Row], names: Sequence[str]) -> list[Row]:
    """Return errors and costs of points over all scenes, one row each, JSON ready; candidates with every scene's."""
    rate, found = _rate(rows, ENGINE), []
    for name in names:
        errors = [error(_figures(row, name), _figures(row, base_of(name))) for row in rows]
        angle, slip = [e.angle_deg for e in errors], [e.slip_m for e in errors]
        held = [_figures(row, name).creep_m_per_s for row in rows if row["runs"][name]["verdict"] == "HELD"]
        point: Row = {
            "name": name,
            "kind": "numerics" if name in NUMERICS else "shapes" if name in SHAPES else "effects",
            "against": base_of(name),
            "scenes": len(rows),
            "angle_error_deg": bound(angle),
            "angle_error_median_deg": float(np.median(angle)),
            "slip_error_m": bound(slip),
            "slip_error_median_m": float(np.median(slip)),
            "creep_error_median_m_per_s": float(np.median([e.creep_m_per_s for e in errors])),
            "held_creep_median_m_per_s": float(np.median(held)) if held else None,
            "flips": sum(e.flipped for e in errors),
            "cost_ratio": _rate(rows, name) / rate,
            "cost_ratio_quartiles": [float(q) for q in np.percentile(_ratios(rows, name), [25, 75])],
            "command": f'{COMMAND} "{name}"',
        }
        if name not in EFFECTS:
            fidelity = _SETTINGS[name].data()
            point["fidelity"] = {k: v for k, v in fidelity.items() if k not in ("measured", "auto_effects")}
        if name in CANDIDATES:
            point["scene_angle_error_deg"] = [_digits(value) for value in angle]
            point["scene_slip_error_m"] = [_digits(value) for value in slip]
        found.append(point)
    _add_error_bar(found)
    return found


def front(found: Sequence[Row], seed: int) -> Row:
    """Return the contents of the front's file."""
    names = ("mujoco", "numpy", "softhand-sim")
    versions = {name: version(name) for name in names}
    about = {"schema": SCHEMA, "schema_version": SCHEMA_VERSION, "seed": seed}
    return {**about, "share_within": SHARE, "confidence": CONFIDENCE, "points": list(found), "versions": versions}


def _add_error_bar(points: list[Row]) -> None:
    """Give the finest setting the distance of the next finer one for an error: it has none of its own."""
    finest = next((p for p in points if p["name"] == FINEST_NAME), None)
    coarser = next(
        (p for p in points if p["name"] == f"0.5 ms, noslip {NUMERICS[FINEST_NAME].noslip_iterations}"), None
    )
    if finest is not None and coarser is not None:
        keys = ("angle_error_deg", "angle_error_median_deg", "slip_error_m", "slip_error_median_m")
        for key in (*keys, "scene_angle_error_deg", "scene_slip_error_m"):
            finest[key] = coarser[key]


def _figures(row: Row, name: str) -> SceneFigures:
    run = row["runs"][name]
    return SceneFigures(**run | {"tip_angle_deg": np.array(run["tip_angle_deg"])})


def _rate(rows: Sequence[Row], name: str) -> float:
    """Processor time for a simulated second, over all grasps."""
    runs = [row["runs"][name] for row in rows if row["grasp"]]
    return float(sum(r["processor_s"] for r in runs) / sum(r["simulated_s"] for r in runs))


def _ratios(rows: Sequence[Row], name: str) -> list[float]:
    def rate(run: Row) -> float:
        return float(run["processor_s"] / run["simulated_s"])

    return [rate(row["runs"][name]) / rate(row["runs"][ENGINE]) for row in rows if row["grasp"]]
