"""Pictures of the pressure tests, the paper's observations beside them; needs matplotlib (extra ``plots``)."""

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from softhand_sim.characterize.bands import confidence_band
from softhand_sim.characterize.pressure_run import PressureRecord
from softhand_sim.elements import ELEMENTS


def draw_pressures(
    path: Path,
    runs: dict[str, tuple[Sequence[PressureRecord], int]],
    *,
    title: str,
    stated: Sequence[str],
    ours: Sequence[str],
) -> None:
    """Draw set and true pressures over time: mean and 95 % band over repeats of each run.

    Parameters
    ----------
    path
        Picture to write.
    runs
        Label: its repeats, two or more, and which element is shown.
    title
        What was done.
    stated
        The paper's observations, in words.
    ours
        What came out here, in words, one for each.

    Raises
    ------
    ModuleNotFoundError
        If matplotlib is missing.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency

    figure = Figure(figsize=(8.0, 6.0), dpi=130)
    axes, words = figure.subplots(2, 1, height_ratios=(3, 1))
    for label, (records, element) in runs.items():
        first = records[0]
        band = confidence_band(np.stack([r.pressure_pa_gauge[:, element] for r in records]))
        line = axes.plot(first.time_s, 1e-3 * band.mean, lw=1.2, label=f"{label} ({len(records)} repeats)")[0]
        low, high = band.mean - band.half_width, band.mean + band.half_width
        axes.fill_between(first.time_s, 1e-3 * low, 1e-3 * high, alpha=0.3, color=line.get_color(), lw=0)
    axes.step(first.time_s, 1e-3 * first.set_pa_gauge, where="pre", color="black", lw=0.8, ls="--", label="set")
    axes.set_xlabel("time (s)")
    axes.set_ylabel("pressure (kPa gauge)")
    axes.set_title(title)
    axes.grid(alpha=0.3)
    axes.legend()
    _write(words, "Stated in the paper", stated, 0.0)
    _write(words, "Here", ours, 0.52)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def element_runs(records: Sequence[PressureRecord]) -> dict[str, tuple[Sequence[PressureRecord], int]]:
    """Return the runs of one finger's element and of the one with three fingers."""
    return {name: (records, ELEMENTS.index(name)) for name in ("index", "middle_ring_little")}


def _write(axes: Any, head: str, lines: Sequence[str], x: float) -> None:
    axes.axis("off")
    text = "\n".join(textwrap.fill(f"- {line}", 56, subsequent_indent="  ") for line in lines)
    axes.text(x, 1.0, f"{head}\n{text}", va="top", fontsize=8, transform=axes.transAxes)
