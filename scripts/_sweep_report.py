"""Table and plot of a design sweep."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from scripts import _cli
from scripts._finger_markdown import NONE, rows, text

Row = dict[str, Any]
_MM, _DEG = 1e3, 180.0 / np.pi


def label(name: str) -> str:
    """Return a variable's name with the unit that it is shown in."""
    return {"_m": f"{name[:-2]} (mm)", "_rad": f"{name[:-4]} (degrees)"}.get(_unit(name), name)


def shown(name: str, value: Any) -> str:
    """Return a variable's value in the unit of its label."""
    return value if isinstance(value, str) else f"{_scale(name) * value:.4g}"


def table(variables: Sequence[str], found: Sequence[Row], pressures_pa: Sequence[float], objects: Sequence[str]) -> str:
    """Return the rows as Markdown: angle and tip force at each pressure, grasp success with Wilson's 95 % interval."""
    kpa = [f"{1e-3 * p:g} kPa" for p in pressures_pa]
    header = [
        *(label(name) for name in variables),
        *(f"{p}, degrees" for p in kpa),
        *(f"{p}, N at the tip" for p in kpa),
        "closes at, kPa",
        *(f"{name} held" for name in objects),
        *(["trials beyond calibration"] if objects else []),
        "ended",
    ]
    body = [
        [
            *(shown(name, row["values"][name]) for name in variables),
            *_numbers(row, "tip_angle_deg", len(kpa), ".1f"),
            *_numbers(row, "tip_force_n", len(kpa), ".3f"),
            text(row.get("closing_pressure_pa_gauge"), ".1f", 1e-3),
            *(_held(row, name) for name in objects),
            *([_beyond(row)] if objects else []),
            row["ended"],
        ]
        for row in found
    ]
    return rows(header, body)


def draw(
    path: Path,
    variables: Sequence[str],
    found: Sequence[Row],
    pressures_pa: Sequence[float],
    objects: Sequence[str],
) -> None:
    """Draw angle, tip force and grasp success over the first variable, a line each value of the second one.

    Needs matplotlib. Rows without a result are gaps.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency

    groups = _groups(variables, found)
    figure = Figure(figsize=(7.5, 8.5 if objects else 6.0), dpi=130, layout="constrained")
    panels = figure.subplots(3 if objects else 2, 1, sharex=True)
    for place, (group, own) in enumerate(groups.items()):
        x = _abscissa(variables[0], own, found)
        for k, pressure in enumerate(pressures_pa):
            name = ", ".join(part for part in (group, f"{1e-3 * pressure:g} kPa") if part)
            for axes, key in zip(panels, ("tip_angle_deg", "tip_force_n"), strict=False):
                axes.plot(x, [_or_nan(row, key, k) for row in own], marker="o", label=name)
        for number, item in enumerate(objects):
            name = ", ".join(part for part in (group, item) if part)
            shift = place * len(objects) + number - 0.5 * (len(groups) * len(objects) - 1)
            _draw_success(panels[-1], np.asarray(x, dtype=np.float64), own, item, name, shift)
    for axes, title in zip(panels, ("tip angle (degrees)", "tip force (N)", "share held, 95 % Wilson"), strict=False):
        axes.set_ylabel(title)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    if objects:
        panels[-1].set_ylim(-0.05, 1.05)
    panels[-1].set_xlabel(label(variables[0]))
    values = _values(variables[0], found)
    if isinstance(values[0], str):
        panels[-1].set_xticks(range(len(values)), values, rotation=15, ha="right")
    partial = path.with_name(f".{path.name}")
    figure.savefig(partial, format="png")
    _cli.write_bytes(path, partial.read_bytes())
    partial.unlink()


def _draw_success(axes: Any, x: Any, own: Sequence[Row], item: str, name: str, shift: float) -> None:
    """Draw success rates with their intervals, shifted a little so that bars of different objects stay apart."""
    step = float(np.min(np.diff(np.unique(x)))) if len(np.unique(x)) > 1 else 1.0
    rate = np.array([[row.get("objects", {}).get(item, {}).get(k, np.nan) for k in _WILSON] for row in own])
    low, high = rate[:, 0] - rate[:, 1], rate[:, 2] - rate[:, 0]
    axes.errorbar(x + 0.02 * step * shift, rate[:, 0], yerr=[low, high], marker="o", capsize=3, label=name)


_WILSON = ("success_rate", "wilson_low", "wilson_high")


def _groups(variables: Sequence[str], found: Sequence[Row]) -> dict[str, list[Row]]:
    groups: dict[str, list[Row]] = {}
    for row in found:
        name = f"{label(variables[1])} = {shown(variables[1], row['values'][variables[1]])}" if variables[1:] else ""
        groups.setdefault(name, []).append(row)
    return groups


def _values(name: str, found: Sequence[Row]) -> list[Any]:
    return list(dict.fromkeys(row["values"][name] for row in found))


def _abscissa(name: str, own: Sequence[Row], found: Sequence[Row]) -> list[float]:
    values = _values(name, found)
    if isinstance(values[0], str):
        return [float(values.index(row["values"][name])) for row in own]
    return [_scale(name) * row["values"][name] for row in own]


def _numbers(row: Row, key: str, count: int, form: str) -> list[str]:
    return [text(value, form) for value in row.get(key, [None] * count)]


def _or_nan(row: Row, key: str, k: int) -> float:
    value = row[key][k] if key in row else None
    return float("nan") if value is None else float(value)


def _held(row: Row, name: str) -> str:
    one = row.get("objects", {}).get(name)
    if one is None:
        return NONE
    return f"{one['held']}/{one['trials']} ({one['wilson_low']:.2f}-{one['wilson_high']:.2f})"


def _beyond(row: Row) -> str:
    if "objects" not in row:
        return NONE
    return str(sum(one["trials_beyond_calibration"] for one in row["objects"].values()))


def _unit(name: str) -> str:
    return next((unit for unit in ("_rad", "_m") if name.endswith(unit)), "")


def _scale(name: str) -> float:
    return {"_m": _MM, "_rad": _DEG}.get(_unit(name), 1.0)
