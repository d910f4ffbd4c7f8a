"""A benchmark as one web page that needs nothing else: no network, no file beside it."""

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

from softhand_sim.benchmark.films import Film
from softhand_sim.benchmark.histogram import histogram
from softhand_sim.benchmark.html_frame import COLUMNS, page, summary_cells
from softhand_sim.benchmark.report import beyond_calibration, conditions, summarise
from softhand_sim.benchmark.success_plots import success_plots
from softhand_sim.benchmark.sweep_table import label, trend
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome


@dataclass(frozen=True, kw_only=True)
class ReportContent:
    """What a report shows.

    Attributes
    ----------
    protocol, results: of the run.
    provenance: settings, versions, calibration, effects; JSON-ready.
    not_tried: reason by object.
    notes: what was repaired or assumed on loading, by object.
    films: pictures and films, by object; may be fewer than the objects.
    no_films: why there are none, if so.
    sweeps: data of `scripts/grasp_sweep.py`.
    step_check: line of the check on the time step; empty without.
    """

    protocol: GraspProtocol
    results: Sequence[TrialResult]
    provenance: Mapping[str, Any]
    not_tried: Mapping[str, str] = field(default_factory=dict)
    notes: Mapping[str, Sequence[str]] = field(default_factory=dict)
    films: Sequence[Film] = ()
    no_films: str = ""
    sweeps: Sequence[Mapping[str, Any]] = ()
    step_check: str = ""


def html_report(content: ReportContent) -> str:
    """Return the page."""
    trials, objects = len(content.results), len({result.object for result in content.results})
    parts = [
        f"<p>{trials} trials of {objects} objects. {escape(conditions(content.protocol))}.</p>",
        _summary(content.results),
        _lines("Beyond the calibrated range", beyond_calibration(content.results).splitlines()),
        _lines("Time step", content.step_check.splitlines()),
        _lines("Not tried", [f"{name}: {reason}" for name, reason in content.not_tried.items()]),
        _lines("Notes on meshes", [f"{name}: {'; '.join(notes)}" for name, notes in content.notes.items()]),
        _films(content),
        _histograms(content),
        *(_sweep(sweep) for sweep in content.sweeps),
        "<h2>Provenance</h2>",
        f"<pre id='provenance'>{escape(json.dumps(content.provenance, indent=1))}</pre>",
    ]
    return page(f"Grasp benchmark: {content.protocol.name}", "\n".join(part for part in parts if part))


def _summary(results: Sequence[TrialResult]) -> str:
    heads = "".join(f"<th><button type='button'>{escape(name)}</button></th>" for name in COLUMNS)
    rows = []
    for name, row in summarise(results).items():
        first = next(result for result in results if result.object == name)
        cells = "".join(
            f"<td data-value='{escape(str(value))}'>{escape(text)}</td>"
            for value, text in summary_cells(name, row, first)
        )
        rows.append(f"<tr>{cells}</tr>")
    body = "\n".join(rows)
    return (
        "<h2>Summary</h2><p>A click on a column's head sorts by it. Medians are over held trials.</p>"
        f"<table id='summary'><thead><tr>{heads}</tr></thead><tbody>\n{body}\n</tbody></table>"
    )


def _lines(title: str, lines: Sequence[str]) -> str:
    if not lines:
        return ""
    return f"<h2>{escape(title)}</h2><ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"


def _films(content: ReportContent) -> str:
    if not content.films:
        return _lines("Pictures", [f"none: {content.no_films}"] if content.no_films else [])
    figures = []
    for film in content.films:
        result = film.result
        caption = f"{result.object}, seed {result.seed}: {result.outcome.value}"
        alt = escape(caption, quote=True)
        figures.append(
            f"<figure><img alt='{alt}' src='{_data_uri(film.picture)}'><figcaption>{escape(caption)}</figcaption>"
            f"<details><summary>film</summary><img alt='film of {alt}' src='{_data_uri(film.film)}'></details></figure>"
        )
    text = "At the verdict; a held trial where there is one, else the first. Films run at twice the speed."
    return f"<h2>Pictures</h2><p>{text}</p><div class='grid'>{''.join(figures)}</div>"


def _data_uri(webp: bytes) -> str:
    return f"data:image/webp;base64,{base64.b64encode(webp).decode('ascii')}"


def _histograms(content: ReportContent) -> str:
    limits = content.protocol.thresholds
    in_hand = [r for r in content.results if r.outcome in (Outcome.HELD, Outcome.SLIPPED, Outcome.PENETRATED)]
    if not in_hand:
        return _lines("Slip and creep", ["no object was in the hand at the end"])
    slip = [1e3 * (r.worst_slip_m if limits.at_any_time else r.slip_m) for r in in_hand]
    drawings = (
        histogram("slip", "mm", slip, 1e3 * limits.slip_m),
        histogram("creep", "um/s", [1e6 * r.creep_m_per_s for r in in_hand], 1e6 * limits.creep_m_per_s, log=True),
        histogram("depth in holds", "mm", [1e3 * r.hold_penetration_m for r in in_hand], 1e3 * limits.penetration_m),
    )
    text = "Trials that ended with the object in the hand, held or not."
    return f"<h2>Slip, creep, depth</h2><p>{text}</p><div class='grid'>{''.join(drawings)}</div>"


def _sweep(sweep: Mapping[str, Any]) -> str:
    settings = sweep["settings"]
    axes = [axis["name"] for axis in settings["axes"]]
    told = [f"{name} along {label(axis)}: {trend(sweep, axis, name)}" for axis in axes for name in settings["objects"]]
    lines = "".join(f"<li>{escape(line)}</li>" for line in told)
    title = f"Sweep over {' and '.join(label(axis) for axis in axes)}, {settings['trials']} trials each"
    pictures = "".join(success_plots(sweep).values())
    return f"<h2>{escape(title)}</h2><div class='grid'>{pictures}</div><ul>{lines}</ul>"
