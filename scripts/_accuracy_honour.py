"""Whether `Fidelity.for_tolerance` keeps its word on scenes that the front was not built from."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from scripts import _cli
from softhand_sim.benchmark.report import wilson_interval
from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import FINEST, HIGH_ACCURACY, Fidelity
from softhand_sim.fidelity.front import Front
from softhand_sim.fidelity.points import NUMERICS
from softhand_sim.fidelity.scenes import LadderScene, SceneError, draw_scenes, error

ALWAYS = ("0.5 ms, noslip 10", "2 ms", "4 ms", "5 ms")
"""Points that run on every unseen scene whatever is picked: other tolerances and a new front cost no new runs."""
UNSEEN_SEED = 1000
"""Added to the seed: scenes of the front are those of the seed itself."""
Row = dict[str, Any]


def honour(
    calibration: FingerCalibration,
    front: Front[Fidelity],
    tolerances: Sequence[Tolerance],
    scenes: int,
    seed: int,
    kept: Path,
    tick: Callable[[], None],
) -> list[Row]:
    """Return a row a tolerance: what it picked, and the share of unseen scenes that are within it.

    A scene is decided if half the finest setting's resolution gives the same verdict and is within the tolerance: of
    the others no setting could be within it but by luck. The share is of all scenes, theirs included. A tolerance that
    the front refuses has the reason instead.
    """
    picked = [_picked(front, tolerance) for tolerance in tolerances]
    rows = _rows(calibration, [p for p in picked if isinstance(p, Fidelity)], scenes, seed + UNSEEN_SEED, kept, tick)
    found: list[Row] = []
    for tolerance, fidelity in zip(tolerances, picked, strict=True):
        asked = {"tolerance_angle_deg": tolerance.angle_deg, "tolerance_slip_m": tolerance.slip_m}
        if isinstance(fidelity, str):
            found.append(asked | {"refused": fidelity})
            continue
        errors = [row["errors"][_key(fidelity)] for row in rows]
        next_finest = [row["errors"][_key(HIGH_ACCURACY)] for row in rows]
        kept_word = [_within(e, tolerance) for e in errors]
        decided = [_within(e, tolerance) and not e["flipped"] for e in next_finest]
        low, high = wilson_interval(sum(kept_word), len(rows))
        found.append(
            asked
            | {
                "picked": fidelity.data()["measured"],
                "scenes": len(rows),
                "honoured": sum(kept_word),
                "honoured_share": sum(kept_word) / len(rows),
                "wilson_low": low,
                "wilson_high": high,
                "undecided": len(rows) - sum(decided),
                "honoured_of_decided": sum(k for k, d in zip(kept_word, decided, strict=True) if d),
                "flips": sum(e["flipped"] for e in errors),
                "broken": [row["scene"] for row, k in zip(rows, kept_word, strict=True) if not k],
                "processor_s": sum(row["processor_s"][_key(fidelity)] for row in rows),
                "finest_processor_s": sum(row["processor_s"][_key(FINEST)] for row in rows),
            }
        )
    return found


def _picked(front: Front[Fidelity], tolerance: Tolerance) -> Fidelity | str:
    """Return what is picked, or why nothing is."""
    try:
        return front.for_tolerance(tolerance)
    except ValueError as error:
        return str(error)


def _rows(
    calibration: FingerCalibration,
    picked: Sequence[Fidelity],
    scenes: int,
    seed: int,
    kept: Path,
    tick: Callable[[], None],
) -> list[Row]:
    settings = {_key(fidelity): fidelity for fidelity in (*(NUMERICS[name] for name in ALWAYS), *picked)}
    rows: list[Row] = []
    if kept.exists():
        content = json.loads(kept.read_text(encoding="utf-8"))
        if content.get("settings") != list(settings) or content.get("seed") != seed:
            raise ValueError(f"{kept}: holds other settings or another seed; give another --out")
        rows = list(content["rows"])
    for _ in rows[:scenes]:
        tick()
    for scene in draw_scenes(scenes, seed)[len(rows) :]:
        rows.append(_row(scene, settings, calibration))
        _cli.write_json(kept, {"settings": list(settings), "seed": seed, "rows": rows})
        tick()
    return rows[:scenes]


def _row(scene: LadderScene, settings: dict[str, Fidelity], calibration: FingerCalibration) -> Row:
    finest = scene.run(calibration, FINEST)
    row: Row = {"scene": scene.name, "errors": {}, "processor_s": {_key(FINEST): finest.processor_s}}
    for key, fidelity in settings.items():
        found = scene.run(calibration, fidelity)
        row["errors"][key] = _plain(error(found, finest))
        row["processor_s"][key] = found.processor_s
    return row


def _plain(found: SceneError) -> Row:
    return {k: v if np.isfinite(v) else 1e9 for k, v in asdict(found).items()}


def _within(found: Row, tolerance: Tolerance) -> bool:
    return bool(found["angle_deg"] <= tolerance.angle_deg and found["slip_m"] <= tolerance.slip_m)


def _key(fidelity: Fidelity) -> str:
    """Return a setting's own fields as text: what was measured of it is no part of it."""
    data = fidelity.data()
    return json.dumps({k: v for k, v in data.items() if k not in ("measured", "auto_effects")}, sort_keys=True)
