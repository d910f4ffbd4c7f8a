"""The report's frame: style, the script that sorts the table, and the table's cells."""

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome

COLUMNS = (
    "object", "mass g", "friction", "trials", "held", "rate", "95 % Wilson", "slip mm", "creep um/s", "depth mm",
    "force N", "fingers touch", "engine warnings", "other outcomes",
)  # fmt: skip

# the policy lets a browser load nothing from anywhere, so that a page which works is a page that needs no network
_HEAD = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width">
"""
_STYLE = """<style>
body { font-family: sans-serif; color: #222; margin: 2em auto; max-width: 1200px; padding: 0 1em; }
table { border-collapse: collapse; font-size: 14px; }
td, th { padding: 3px 8px; border-bottom: 1px solid #ddd; text-align: right; }
td:first-child, th:first-child, td:last-child, th:last-child { text-align: left; }
th button { font: inherit; font-weight: bold; border: 0; background: none; cursor: pointer; padding: 0; }
th[aria-sort=ascending] button::after { content: " \\2191"; }
th[aria-sort=descending] button::after { content: " \\2193"; }
.grid { display: flex; flex-wrap: wrap; gap: 12px; }
figure { margin: 0; width: 320px; } figure img { width: 100%; } figcaption, summary { font-size: 13px; }
pre { background: #f6f6f6; padding: 1em; overflow-x: auto; font-size: 12px; }
</style>
"""
# a page opened with #sort=rate,descending comes up sorted, as after two clicks
_SCRIPT = """<script>
"use strict";
const table = document.getElementById("summary");
const heads = Array.from(table.tHead.rows[0].cells);
function sortBy(column, direction) {
  const body = table.tBodies[0];
  const value = row => row.cells[column].dataset.value;
  const rows = Array.from(body.rows);
  const numbers = rows.every(row => value(row) === "" || !isNaN(Number(value(row))));
  const sign = direction === "descending" ? -1 : 1;
  rows.sort((one, other) => {
    const a = value(one), b = value(other);
    if (a === "" || b === "") return (a === "") - (b === "");
    return sign * (numbers ? Number(a) - Number(b) : a.localeCompare(b));
  });
  body.append(...rows);
  heads.forEach(head => head.removeAttribute("aria-sort"));
  heads[column].setAttribute("aria-sort", direction);
}
heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
  sortBy(column, head.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending");
}));
const asked = decodeURIComponent(location.hash).match(/^#sort=([^,]+)(,descending)?$/);
const place = asked ? heads.findIndex(head => head.textContent === asked[1]) : -1;
if (place >= 0) sortBy(place, asked[2] ? "descending" : "ascending");
</script>
"""


def page(title: str, body: str) -> str:
    """Return a whole page around a body that has the table ``summary``."""
    head = f"{_HEAD}<title>{escape(title)}</title>\n{_STYLE}</head>"
    return f"{head}\n<body><h1>{escape(title)}</h1>\n{body}\n{_SCRIPT}</body></html>\n"


def summary_cells(name: str, row: Mapping[str, Any], one: TrialResult) -> Iterator[tuple[Any, str]]:
    """Return each cell of an object's row in the order of `COLUMNS`: what sorts it, and its text.

    `row` is one of `summarise`, `one` any trial of the object. Figures that are missing sort last in either direction.
    """
    yield name, name
    yield one.mass_kg, f"{1e3 * one.mass_kg:.4g}"
    yield one.friction, f"{one.friction:g}"
    yield row["trials"], f"{row['trials']}"
    yield row["held"], f"{row['held']}"
    yield row["success_rate"], f"{row['success_rate']:.2f}"
    yield row["wilson_low"], f"{row['wilson_low']:.2f} - {row['wilson_high']:.2f}"
    for key, factor, digits in (
        ("held_median_slip_m", 1e3, 1),
        ("held_median_creep_m_per_s", 1e6, 0),
        ("held_median_penetration_m", 1e3, 2),
        ("held_median_force_n", 1.0, 2),
    ):
        yield ("", "-") if row[key] is None else (row[key], f"{factor * row[key]:.{digits}f}")
    yield row["finger_contact_share"], f"{row['finger_contact_share']:.2f}"
    yield row["engine_warnings"], f"{row['engine_warnings']}"
    others = ", ".join(f"{key} {count}" for key, count in row["outcomes"].items() if count and key != Outcome.HELD)
    yield others, others
