"""Pictures of bench tests; needs matplotlib (extra ``plots``)."""

import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from softhand_sim.characterize.report import Report, Source

_STYLE: dict[Source, dict[str, Any]] = {
    Source.FEA_FITTED: {"color": "black", "marker": "o", "linestyle": "none", "markersize": 5},
    Source.FEA: {"color": "black", "marker": "o", "linestyle": "none", "markersize": 5, "fillstyle": "none"},
    Source.SURROGATE: {"color": "tab:blue", "linewidth": 1.6},
    Source.COMMAND: {"color": "gray", "linewidth": 1.0, "linestyle": "--"},
    Source.PAPER: {"color": "tab:red", "marker": "*", "linestyle": "none", "markersize": 14},
}


def draw(report: Report, path: Path) -> None:
    """Draw a report's panels side by side into a PNG file."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency

    figure = Figure(figsize=(5.2 * len(report.panels), 4.6), layout="constrained")
    for axes, panel in zip(figure.subplots(1, len(report.panels), squeeze=False)[0], report.panels, strict=True):
        named: set[Source] = set()
        for curve in panel.curves:
            label = "" if curve.source in named else curve.source.value
            named.add(curve.source)
            axes.plot(curve.x, curve.y, label=label or None, **_STYLE[curve.source])
            if curve.half_width:
                low, high = np.subtract(curve.y, curve.half_width), np.add(curve.y, curve.half_width)
                axes.fill_between(curve.x, low, high, color=_STYLE[curve.source]["color"], alpha=0.3, linewidth=0)
            if curve.label:
                axes.annotate(curve.label, (curve.x[-1], curve.y[-1]), xytext=(4, 0), textcoords="offset points")
        axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label)
        axes.grid(visible=True, alpha=0.3)
        axes.margins(x=0.1)
        axes.legend(fontsize="small")
    if report.stated:
        words = [textwrap.fill(f"Stated: {line}", 75 * len(report.panels)) for line in report.stated]
        figure.supxlabel("\n".join([*words, *map(str, report.checks)]), fontsize="small", ha="left", x=0.01)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
