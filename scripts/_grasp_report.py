"""The HTML report of a benchmark: reads the sweeps to show, makes the films, writes the page."""

import json
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tqdm import tqdm

from scripts import _cli
from softhand_sim.benchmark.films import film_all
from softhand_sim.benchmark.html_report import ReportContent, html_report
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.step_check import StepCheck
from softhand_sim.benchmark.store import conditions
from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.result import TrialResult
from softhand_sim.objects.batch import Batch
from softhand_sim.render import RenderUnavailableError

# of a calibration's notes; the curves of its analyses are pages long
_CALIBRATION = ("content_sha256", "provenance", "targets_used", "fit_rmse")
_ROW = ("success_rate", "wilson_low", "wilson_high", "held", "trials")


def read_sweep(path: Path) -> dict[str, Any]:
    """Return the data of `grasp_sweep.py --json`.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is something else.
    """
    if not path.is_file():
        raise FileNotFoundError(f"--sweeps: no file at {path}")
    try:
        data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        settings = data["settings"]
        names, axes, _ = settings["objects"], settings["axes"], settings["trials"]
        for row in data["rows"]:
            for axis in axes:
                axis["values"].index(row["values"][axis["name"]])
            for name in names:
                [float(row["objects"][name][key]) for key in _ROW]
        if not data["rows"] or len(axes) not in (1, 2):
            raise ValueError("no rows")
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"--sweeps {path}: not a file of grasp_sweep.py ({type(error).__name__}: {error})") from None
    return data


def write_report(
    path: Path,
    plan: BenchmarkPlan,
    results: Sequence[TrialResult],
    batch: Batch,
    *,
    settings: Mapping[str, Any],
    sweeps: Sequence[Mapping[str, Any]] = (),
    check: StepCheck | None = None,
) -> None:
    """Film a trial of each object and write the page, in one piece."""
    no_films, films, notes = "", [], load_calibration(plan.calibration).notes
    try:
        films = list(tqdm(film_all(plan, results), total=len(plan.objects), desc="films", unit="film", disable=None))
    except RenderUnavailableError as error:
        no_films = str(error)
    content = ReportContent(
        protocol=plan.protocol,
        results=results,
        provenance={
            "settings": dict(settings),
            "conditions": conditions(plan),
            "calibration": {key: notes[key] for key in _CALIBRATION if key in notes},
            "effects": {name: repr(getattr(plan.effects, name)) for name in plan.effects.present},
            "versions": {
                "python": platform.python_version(),
                **{name: version(name) for name in ("softhand-sim", "mujoco", "numpy", "scipy", "trimesh", "coacd")},
            },
            "machine": platform.platform(),
        },
        not_tried=batch.failures,
        notes={model.name: model.notes for model in batch.models if model.notes},
        films=films,
        no_films=no_films,
        sweeps=sweeps,
        step_check="" if check is None else check.text(),
    )
    _cli.write_text(path, html_report(content))
