"""Plots of accuracy against time: named points, error bars, the front drawn; log-log."""

from collections.abc import Sequence
from math import log10
from pathlib import Path
from typing import Any

from scripts._accuracy_page import front_of
from softhand_sim.fidelity.front import non_dominated

Row = dict[str, Any]
LINE = 0.033
"""Height of a line of names, as a share of the plot's."""
_KINDS = {"closed": "#8c6bb1", "calibrated": "#8c6bb1", "three": "#e6550d", "links": "#e6550d", "FEA": "#3182bd"}


def draw_finger(table: Row, file: Path) -> None:
    """Draw the finger's ladder, angle and force error against processor time of a sweep, and write a PNG."""
    import matplotlib  # noqa: PLC0415 - an optional dependency

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # noqa: PLC0415

    figure, axes = plt.subplots(1, 2, figsize=(13, 5.4), constrained_layout=True)
    rows = table["rungs"]
    _panel(axes[0], rows, "angle_error_deg", 1.0, table["error_bar"]["angle_deg"] or 0.0)
    axes[0].set(ylabel="RMS error of the tip angle / degrees")
    forced = [row for row in rows if row["force_error_ratio"]]
    _panel(axes[1], forced, "force_error_ratio", 100.0, 100.0 * (table["error_bar"]["force_ratio"] or 0.0))
    axes[1].set(ylabel="RMS error of the blocked force / % of the largest")
    for axis in axes:
        axis.set(xlabel="processor time of a sweep to 75 kPa / s")
    figure.suptitle("One finger: error against the reference finite elements, and what it costs")
    figure.savefig(file, dpi=110)
    plt.close(figure)


def _panel(axis: Any, rows: Sequence[Row], key: str, scale: float, bar: float) -> None:
    errors, costs = [scale * row[key] for row in rows], [row["processor_s_per_sweep"] for row in rows]
    for row, error, cost in zip(rows, errors, costs, strict=True):
        colour = next(c for word, c in _KINDS.items() if word in row["name"])
        # below the reference's own error bar nothing can be told
        low = min(error - 1e-3 * error, bar)
        axis.errorbar(cost, error, yerr=[[low], [bar]], fmt="o", color=colour, ms=6, lw=0.8, capsize=2)
    names = [row["name"].replace("closed form, ", "") for row in rows]
    _label(axis, names, costs, errors)
    chosen = non_dominated(errors, costs)
    axis.step([costs[k] for k in chosen], [errors[k] for k in chosen], where="post", color="0.4", lw=1.0, zorder=0)
    axis.axhspan(0.0, bar, color="0.92", zorder=-1)
    axis.set(
        xscale="log",
        yscale="log",
        xlim=(0.5 * min(costs), 6.0 * max(costs)),
        ylim=(0.4 * min([*errors, bar or errors[0]]), 2.5 * max(errors)),
    )
    axis.grid(visible=True, which="major", lw=0.3)


def _label(axis: Any, names: Sequence[str], x: Sequence[float], y: Sequence[float]) -> None:
    """Write names beside points, each as near as it goes without lying on one written before (axes are logarithmic)."""
    taken: list[tuple[float, float, float]] = []
    for k in sorted(range(len(names)), key=lambda k: -y[k]):
        # in widths and heights of the plot, roughly: a name is as wide as its letters
        across, up, wide = log10(x[k] / min(x)) / _spread(x), log10(y[k] / min(y)) / _spread(y), 0.017 * len(names[k])
        shift = next(
            d
            for d in sorted(range(-40, 41), key=abs)
            if not any(
                abs(up + 0.01 * d - other) < LINE and left < across + wide and across < left + width
                for left, other, width in taken
            )
        )
        taken.append((across, up + 0.01 * shift, wide))
        line = {"arrowstyle": "-", "lw": 0.3, "color": "0.6"} if abs(shift) > 3 else None
        place = (6.0, 3.0 * shift)
        axis.annotate(
            names[k], (x[k], y[k]), fontsize=6.5, va="bottom", xytext=place, textcoords="offset points", arrowprops=line
        )


def _spread(values: Sequence[float]) -> float:
    return max(log10(max(values) / min(values)), 1e-6)


def draw_scene(points: Sequence[Row], file: Path) -> None:
    """Draw the scene's ladder, angle and slip error against cost in bare engines, and write a PNG."""
    import matplotlib  # noqa: PLC0415

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # noqa: PLC0415

    figure, axes = plt.subplots(1, 2, figsize=(13, 5.4), constrained_layout=True)
    rows = [point for point in points if point["kind"] != "effects"]
    for axis, key, median, scale, label in (
        (axes[0], "angle_error_deg", "angle_error_median_deg", 1.0, "error of the tip angle / degrees"),
        (axes[1], "slip_error_m", "slip_error_median_m", 1e3, "error of the slip / mm"),
    ):
        errors, costs = [scale * row[key] for row in rows], [row["cost_ratio"] for row in rows]
        for row, error, cost in zip(rows, errors, costs, strict=True):
            colour = "#e6550d" if row["kind"] == "numerics" else "#31a354"
            middle = max(scale * row[median], 1e-3 * error)
            axis.errorbar(cost, error, yerr=[[error - middle], [0.0]], fmt="o", color=colour, ms=5, lw=0.6)
        _label(axis, [row["name"] for row in rows], costs, errors)
        own = front_of(rows)
        chosen = [own[k] for k in non_dominated([row[key] for row in own], [row["cost_ratio"] for row in own])]
        x, y = [row["cost_ratio"] for row in chosen], [scale * row[key] for row in chosen]
        axis.step(x, y, where="post", color="0.4", lw=1.0, zorder=0)
        axis.set(
            xscale="log",
            yscale="log",
            xlabel="processor time over that of the bare engine at the default",
            ylabel=label,
        )
        axis.set_xlim(0.8 * min(costs), 2.2 * max(costs))
        axis.grid(visible=True, which="major", lw=0.3)
    figure.suptitle("Scenes: error that bounds 95 % of them (down to the median), and what it costs")
    figure.savefig(file, dpi=110)
    plt.close(figure)
