"""Histogram of a figure over trials, with the limit that a verdict sets."""

import math
from collections.abc import Sequence

import numpy as np

from softhand_sim.benchmark.svg import COLOURS, GRID, INK, Drawing

BINS = 24
LEFT, TOP, WIDTH, HEIGHT = 50.0, 30.0, 420.0, 180.0
DECADES = 6
"""Choice: what lies further down than so many decades counts in the first bin."""


def histogram(title: str, unit: str, values: Sequence[float], limit: float, *, log: bool = False) -> str:
    """Return a histogram as SVG; `limit` is drawn as a line, `log` spaces the bins evenly in the logarithm.

    Parameters
    ----------
    title, unit: of the horizontal axis.
    values: finite numbers of 0 or above, in `unit`.
    limit: above 0, in `unit`.
    """
    largest = max([1.05 * limit, *values])
    if log:
        decade = math.ceil(math.log10(largest))
        edges = np.logspace(decade - DECADES, decade, BINS + 1)
    else:
        edges = np.linspace(0.0, largest, BINS + 1)
    counts, _ = np.histogram(np.clip(values, edges[0], edges[-1]), bins=edges)
    most = max(int(counts.max()), 1)
    drawing = Drawing(width=LEFT + WIDTH + 30.0, height=TOP + HEIGHT + 50.0)

    def across(value: float) -> float:
        share = np.log(value / edges[0]) / np.log(edges[-1] / edges[0]) if log else value / edges[-1]
        return LEFT + WIDTH * float(share)

    for count in sorted({0, most // 2, most}):
        y = TOP + HEIGHT * (1.0 - count / most)
        drawing.line(LEFT, y, LEFT + WIDTH, y, colour=GRID)
        drawing.text(LEFT - 6.0, y + 4.0, f"{count}", anchor="end")
    for k, count in enumerate(counts.tolist()):
        high = HEIGHT * count / most
        left, right = across(float(edges[k])), across(float(edges[k + 1]))
        drawing.box(left + 0.5, TOP + HEIGHT - high, right - left - 1.0, high, colour=COLOURS[0])
    for value in edges[:: BINS // 6].tolist():
        drawing.text(across(value), TOP + HEIGHT + 18.0, f"{value:.3g}", size=11.0)
    drawing.line(across(limit), TOP - 6.0, across(limit), TOP + HEIGHT, colour=COLOURS[1], width=2.0)
    drawing.text(across(limit), TOP - 10.0, f"limit {limit:g}", size=11.0, colour=COLOURS[1])
    drawing.text(LEFT + WIDTH / 2.0, TOP + HEIGHT + 40.0, f"{title} ({unit}), {len(values)} trials", colour=INK)
    return str(drawing)
