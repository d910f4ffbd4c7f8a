"""Pictures of a sweep: success curves over one condition, success surfaces over two."""

from collections.abc import Mapping, Sequence
from typing import Any

from softhand_sim.benchmark.svg import COLOURS, GRID, INK, Drawing
from softhand_sim.benchmark.sweep_table import label, shown

LEFT, TOP, BOTTOM, STEP, HEIGHT = 70.0, 30.0, 60.0, 110.0, 260.0
CELL = (120.0, 52.0)


def success_plots(data: Mapping[str, Any]) -> dict[str, str]:
    """Return SVG by name: ``success`` for a sweep over one condition, ``success_<object>`` each for one over two.

    Values stand side by side in their order, at equal distances. Bars and small print are Wilson's 95 % intervals.
    """
    axes = data["settings"]["axes"]
    if len(axes) == 1:
        return {"success": _curves(axes[0], data["rows"])}
    names = data["settings"]["objects"]
    return {f"success_{name}": _surface(name, axes, data["rows"]) for name in names}


def _curves(axis: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> str:
    names = list(rows[0]["objects"]) if rows else []
    right = LEFT + STEP * len(axis["values"])
    drawing = Drawing(width=right + 170.0, height=max(TOP + HEIGHT + BOTTOM, TOP + 18.0 * len(names) + 20.0))

    def height(share: float) -> float:
        return TOP + HEIGHT * (1.0 - share)

    for tenth in range(0, 11, 2):
        drawing.line(LEFT, height(tenth / 10), right, height(tenth / 10), colour=GRID)
        drawing.text(LEFT - 8.0, height(tenth / 10) + 4.0, f"{tenth / 10:g}", anchor="end")
    drawing.text(20.0, TOP + HEIGHT / 2.0, "share held, 95 % Wilson", turned=True)
    drawing.text((LEFT + right) / 2.0, TOP + HEIGHT + 45.0, label(axis["name"]))
    for place, value in enumerate(axis["values"]):
        drawing.text(LEFT + STEP * (place + 0.5), TOP + HEIGHT + 20.0, shown(axis["name"], value))
    for number, name in enumerate(names):
        colour = COLOURS[number % len(COLOURS)]
        shift = 5.0 * (number - 0.5 * (len(names) - 1))
        before: tuple[float, float] | None = None
        for place, row in enumerate(rows):
            one = row["objects"][name]
            x, y = LEFT + STEP * (place + 0.5) + shift, height(one["success_rate"])
            drawing.line(x, height(one["wilson_low"]), x, height(one["wilson_high"]), colour=colour)
            drawing.dot(x, y, colour=colour)
            if before is not None:
                drawing.line(*before, x, y, colour=colour, width=1.5)
            before = (x, y)
        drawing.dot(right + 18.0, TOP + 18.0 * number + 4.0, colour=colour, radius=5.0)
        drawing.text(right + 30.0, TOP + 18.0 * number + 8.0, name, anchor="start")
    return str(drawing)


def _surface(name: str, axes: Sequence[Mapping[str, Any]], rows: Sequence[Mapping[str, Any]]) -> str:
    first, second = axes
    wide, high = CELL
    left = LEFT + 50.0
    drawing = Drawing(
        width=left + wide * len(second["values"]) + 20.0, height=TOP + high * len(first["values"]) + BOTTOM
    )
    drawing.text(drawing.width / 2.0, 18.0, f"{name}: share held, 95 % Wilson", size=13.0)
    for k, value in enumerate(first["values"]):
        drawing.text(left - 10.0, TOP + high * (k + 0.5) + 4.0, shown(first["name"], value), anchor="end")
    for k, value in enumerate(second["values"]):
        x = left + wide * (k + 0.5)
        drawing.text(x, TOP + high * len(first["values"]) + 18.0, shown(second["name"], value))
    drawing.text(20.0, TOP + high * len(first["values"]) / 2.0, label(first["name"]), turned=True)
    drawing.text(left + wide * len(second["values"]) / 2.0, drawing.height - 14.0, label(second["name"]))
    for row in rows:
        one = row["objects"][name]
        x = left + wide * second["values"].index(row["values"][second["name"]])
        y = TOP + high * first["values"].index(row["values"][first["name"]])
        rate = one["success_rate"]
        drawing.box(x, y, wide, high, colour=_shade(rate), edge="white")
        ink = "white" if rate > 0.6 else INK
        drawing.text(x + wide / 2.0, y + high / 2.0 - 1.0, f"{rate:.2f}", size=15.0, colour=ink)
        interval = f"{one['wilson_low']:.2f} - {one['wilson_high']:.2f}"
        drawing.text(x + wide / 2.0, y + high / 2.0 + 15.0, interval, size=10.0, colour=ink)
    return str(drawing)


def _shade(share: float) -> str:
    """Return a colour from white (0) to deep blue (1)."""
    ends = ((247, 251, 255), (8, 69, 148))
    return "rgb({})".format(",".join(str(round(a + (b - a) * share)) for a, b in zip(*ends, strict=True)))
