"""Grasp trials with fingers of an ensemble: those drawn from the tolerances, and the scenarios."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.plan import FIRM_ANGLE_DEG
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.model import ObjectModel
from softhand_sim.uncertainty.blend import blended, drawn_coordinates
from softhand_sim.uncertainty.ensemble import SCENARIOS, Ensemble

NOMINAL, DRAWN, SCENARIO = "nominal", "drawn", "scenario"


@dataclass(frozen=True, kw_only=True)
class UncertaintyPlan:
    """What to run.

    Attributes
    ----------
    objects, trials, seed, protocol
        Trials of each finger, the same for all of them.
    fingers
        Number drawn from the tolerances.
    spread
        Half width of the draw, 1 for the tolerances as they are, 0 for the nominal finger alone.
    known_finger
        The controller knows each finger's own pressure-angle curve; by default it knows the nominal one.
    scenarios
        Names of the sources whose scenarios are tried.
    """

    objects: tuple[ObjectModel, ...]
    trials: int = 4
    seed: int = 0
    fingers: int = 8
    spread: float = 1.0
    known_finger: bool = False
    scenarios: tuple[str, ...] = ()
    protocol: GraspProtocol = field(default_factory=load_protocol)

    def __post_init__(self) -> None:
        if self.fingers < 1 or self.trials < 1:
            raise ValueError(f"fingers: {self.fingers}, trials: {self.trials} must be 1 or above")


@dataclass(frozen=True, kw_only=True)
class GraspRow:
    """A finger and its trials; ``kind`` is nominal, drawn or scenario, ``refused`` why there are no trials."""

    name: str
    kind: str
    source: str
    coordinates: Mapping[str, float]
    tip_angle_deg_at_set_pressure: float | None
    trials: tuple[TrialResult, ...]
    refused: str = ""


@dataclass(frozen=True, kw_only=True)
class _Finger:
    name: str
    kind: str
    source: str
    coordinates: Mapping[str, float]
    content: Mapping[str, Any] | None
    refused: str = ""


def finger_count(ensemble: Ensemble, plan: UncertaintyPlan) -> int:
    """Return how many different fingers have trials at most."""
    return len({_physics(finger.content) for finger in _fingers(ensemble, plan) if finger.content is not None})


def grasp_rows(ensemble: Ensemble, plan: UncertaintyPlan, folder: Path, *, workers: int = 1) -> Iterator[GraspRow]:
    """Yield the fingers with their trials: the nominal one, those drawn, the scenarios.

    Their calibration files are written to ``folder``. Results do not depend on ``workers``. Fingers that are the same
    have their trials run once.

    Raises
    ------
    ValueError
        If a drawn finger is refused by the calibration's reader, or a scenario's source is unknown.
    """
    fingers = list(_fingers(ensemble, plan))
    folder.mkdir(parents=True, exist_ok=True)
    files = [None if finger.content is None else _written(folder, finger) for finger in fingers]
    calibrations = [None if file is None else load_calibration(file) for file in files]
    nominal, known = calibrations[0], dict[str, tuple[TrialResult, ...]]()
    assert nominal is not None
    for finger, file, calibration in zip(fingers, files, calibrations, strict=True):
        if file is None or calibration is None:
            yield _row(finger, refused=finger.refused)
            continue
        known_to_controller = calibration if plan.known_finger else nominal
        (pressure,) = plan.protocol.closing_pressures_pa_gauge(known_to_controller, (FIRM_ANGLE_DEG,)).tolist()
        highest = float(calibration.curve.pressure_pa_gauge[-1])
        if pressure > highest:
            lost = f"set to {1e-3 * pressure:.1f} kPa, calibrated up to {1e-3 * highest:g} kPa"
            yield _row(finger, refused=lost)
            continue
        key = _physics(finger.content)
        if key not in known:
            known[key] = _trials(plan, file, None if plan.known_finger else files[0], workers)
        yield _row(finger, angle_deg=calibration.angle_for_pressure(pressure), trials=known[key])


def held(row: GraspRow, name: str) -> int:
    """Return how many trials of an object a finger held."""
    return sum(trial.object == name and trial.outcome is Outcome.HELD for trial in row.trials)


def _fingers(ensemble: Ensemble, plan: UncertaintyPlan) -> Iterator[_Finger]:
    yield _Finger(name=NOMINAL, kind=NOMINAL, source="", coordinates={}, content=ensemble.nominal.content)
    drawn = drawn_coordinates(ensemble, plan.fingers, np.random.default_rng(plan.seed), spread=plan.spread)
    for number, at in enumerate(drawn):
        content = blended(ensemble, at)
        yield _Finger(name=f"{DRAWN}-{number:02d}", kind=DRAWN, source="", coordinates=at, content=content)
    known = {source.name: source for source in ensemble.sources if source.kind == SCENARIOS}
    for name in plan.scenarios:
        if name not in known:
            raise ValueError(f"scenarios: {name!r} is not one of {list(known)}")
        for member in known[name].members:
            yield _Finger(
                name=member.name,
                kind=SCENARIO,
                source=name,
                coordinates={},
                content=member.content,
                refused=member.refused,
            )


def _trials(plan: UncertaintyPlan, file: Path, control: Path | None, workers: int) -> tuple[TrialResult, ...]:
    benchmark = BenchmarkPlan(
        objects=plan.objects,
        trials=plan.trials,
        seed=plan.seed,
        calibration=file,
        control=control,
        protocol=plan.protocol,
    )
    return tuple(in_order(benchmark, list(run_benchmark(benchmark, workers))))


def _row(
    finger: _Finger, *, angle_deg: float | None = None, trials: Sequence[TrialResult] = (), refused: str = ""
) -> GraspRow:
    return GraspRow(
        name=finger.name,
        kind=finger.kind,
        source=finger.source,
        coordinates=finger.coordinates,
        tip_angle_deg_at_set_pressure=angle_deg,
        trials=tuple(trials),
        refused=refused,
    )


def _physics(content: Mapping[str, Any] | None) -> str:
    """Return what a trial depends on, as text."""
    parts = ("finger", "joints", "tendon", "chamber", "sliding", "curve")
    return "" if content is None else json.dumps([content[part] for part in parts])


def _written(folder: Path, finger: _Finger) -> Path:
    """Write a finger's calibration in one piece."""
    file = folder / f"{finger.name}.json"
    partial = file.with_name(f".{file.name}.{os.getpid()}.partial")
    partial.write_text(json.dumps(dict(finger.content or {}), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    partial.replace(file)
    return file
