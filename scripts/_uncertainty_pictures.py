"""Pictures of the finger's uncertainty; they need matplotlib."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scripts import _cli
from scripts._uncertainty_report import Bands
from softhand_sim.calibration import load_calibration
from softhand_sim.uncertainty import GraspRow
from softhand_sim.uncertainty.grasps import DRAWN, NOMINAL, SCENARIO

_NAMES = {DRAWN: "within tolerance"}


def angle_curves(folder: Path, found: Sequence[GraspRow]) -> list[tuple[str, list[float], list[float]]]:
    """Return kind (or source), pressures [Pa gauge] and tip angles [degrees] of the fingers in a folder."""
    curves = []
    for row in found:
        file = folder / f"{row.name}.json"
        if file.is_file() and (row.trials or row.tip_angle_deg_at_set_pressure is not None or row.kind == SCENARIO):
            curve = load_calibration(file).curve
            label = row.source or row.kind
            curves.append((label, curve.pressure_pa_gauge.tolist(), curve.tip_angle_deg.tolist()))
    return curves


def draw_grasps(
    path: Path, result: Mapping[str, Any], curves: Sequence[tuple[str, Sequence[float], Sequence[float]]]
) -> None:
    """Draw angle over pressure of every finger, and the intervals of success. Needs matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency

    figure = Figure(figsize=(10.0, 4.2), dpi=130, layout="constrained")
    left, right = figure.subplots(1, 2)
    labels = list(dict.fromkeys(label for label, _, _ in curves))
    scenarios = [label for label in labels if label not in (NOMINAL, DRAWN)]
    colours = {NOMINAL: "black", DRAWN: "C0", **{label: f"C{k + 1}" for k, label in enumerate(scenarios)}}
    # nominal last, on top of the others
    for label in sorted(labels, key=lambda one: one == NOMINAL):
        style = {"color": colours[label], "lw": 2.0 if label == NOMINAL else 0.9}
        for k, (_, pressure, angle) in enumerate(curve for curve in curves if curve[0] == label):
            left.plot([1e-3 * p for p in pressure], angle, label=None if k else _NAMES.get(label, label), **style)
    left.set_xlabel("pressure (kPa gauge)")
    left.set_ylabel("tip angle (degrees)")
    left.grid(alpha=0.3)
    left.legend(fontsize=8)
    place, ticks = 0.0, []
    for name, own in result["objects"].items():
        bars = {NOMINAL: own["nominal"], DRAWN: own["tolerances"], **own["scenarios"]}
        for label, one in bars.items():
            marks = [one["success_rate"]] if "success_rate" in one else [m["success_rate"] for m in one["members"]]
            if not marks:
                continue
            ends, colour = [one["low"], one["high"]], colours[label]
            right.plot(ends, [place, place], color=colour, lw=5.0, alpha=0.5, solid_capstyle="butt")
            right.plot(marks, [place] * len(marks), "o", color=colour, ms=4.0)
            ticks.append((place, f"{name}: {_NAMES.get(label, label)}"))
            place -= 1.0
        place -= 0.6
    right.set_yticks([at for at, _ in ticks], [text for _, text in ticks], fontsize=8)
    right.set_xlim(-0.03, 1.03)
    right.set_xlabel("share held, 95 % interval")
    right.grid(alpha=0.3, axis="x")
    _save(figure, path)


def draw_bands(path: Path, bands: Bands, pressures_pa: Sequence[float]) -> None:
    """Draw the bands of angle and tip force over pressure. Needs matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency

    figure = Figure(figsize=(10.0, 4.2), dpi=130, layout="constrained")
    kpa = [1e-3 * p for p in pressures_pa]
    for axes, what, title in zip(
        figure.subplots(1, 2),
        ("tip_angle_deg", "tip_force_n"),
        ("tip angle (degrees)", "blocked tip force (N)"),
        strict=True,
    ):
        for k, (name, own) in enumerate(bands.items()):
            found = [own[f"{what}_at_{p:g}_kpa"] for p in kpa]
            known = [
                (p + 0.5 * (k - len(bands) / 2), b) for p, b in zip(kpa, found, strict=True) if b.nominal is not None
            ]
            x, middle = [p for p, _ in known], [b.nominal for _, b in known]
            low = [(b.nominal or 0.0) - (b.low or 0.0) for _, b in known]
            high = [(b.high or 0.0) - (b.nominal or 0.0) for _, b in known]
            axes.errorbar(x, middle, yerr=[low, high], fmt="o", ms=3.0, capsize=2.5, label=name)
        axes.set_xlabel("pressure (kPa gauge; sources side by side)")
        axes.set_ylabel(title)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7)
    _save(figure, path)


def _save(figure: Any, path: Path) -> None:
    partial = path.with_name(f".{path.name}")
    figure.savefig(partial, format="png")
    _cli.write_bytes(path, partial.read_bytes())
    partial.unlink()
