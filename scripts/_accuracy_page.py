"""Tables of accuracy against time as Markdown."""

from collections.abc import Mapping, Sequence
from typing import Any

from softhand_sim.fidelity.front import non_dominated

Row = dict[str, Any]


def finger(table: Row) -> str:
    """Return the finger's ladder, a row a rung by rising cost; a star on those that none beats in angle and cost."""
    rows = sorted(table["rungs"], key=lambda row: row["processor_s_per_sweep"])
    best = non_dominated([r["angle_error_deg"] for r in rows], [r["processor_s_per_sweep"] for r in rows])
    bar = table["error_bar"]
    own = "unknown"
    if bar["angle_deg"] is not None:
        own = f"{bar['angle_deg']:.2f} degrees, {1e3 * bar['tip_m']:.2f} mm, from the next coarser mesh"
    force_bar = "unknown" if bar["force_ratio"] is None else f"{100 * bar['force_ratio']:.1f} %"
    lines = [
        f"Reference: FEA {table['reference']}; error bar: {own}. Force: FEA {table['force_reference']}; error bar: "
        f"{force_bar}.",
        "",
        "| rung | tip angle, degrees RMS (max) | tip position, mm RMS | blocked force, % | processor s a sweep "
        "| s a simulated s | repeat |",
        "|---|---|---|---|---|---|---|",
    ]
    for k, row in enumerate(rows):
        force = "-" if row["force_error_ratio"] is None else f"{100 * row['force_error_ratio']:.1f}"
        second = row["processor_s_per_simulated_s"]
        cells = (
            f"{row['name']}{' *' if k in best else ''}",
            f"{row['angle_error_deg']:.2f} ({row['angle_error_max_deg']:.2f})",
            f"{1e3 * row['tip_error_m']:.2f}",
            force,
            f"{row['processor_s_per_sweep']:.2g}",
            "-" if second is None else f"{second:.2g}",
            f"`{row['command']}`",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def scene(points: Sequence[Row]) -> str:
    """Return the scene's ladder, numerical settings first; a star where none beats it in angle or slip and cost.

    Stars are for settings of equally many scenes, the most: the largest of a few errors says little beside a bound.
    """
    own = front_of(points)
    costs = [p["cost_ratio"] for p in own]
    best = {
        own[k]["name"]
        for key in ("angle_error_deg", "slip_error_m")
        for k in non_dominated([p[key] for p in own], costs)
    }
    lines = [
        "| setting | against | scenes | angle, degrees: bound, median | slip, mm: bound, median | creep of held, um/s "
        "| other verdict | cost (quartiles) | repeat |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for kind in ("numerics", "shapes", "effects"):
        for p in sorted((p for p in points if p["kind"] == kind), key=lambda p: -p["cost_ratio"]):
            creep = p["held_creep_median_m_per_s"]
            low, high = p["cost_ratio_quartiles"]
            lines.append(
                f"| {p['name']}{' *' if p['name'] in best else ''} | {p['against']} | {p['scenes']} "
                f"| {p['angle_error_deg']:.2f}, {p['angle_error_median_deg']:.2f} "
                f"| {1e3 * p['slip_error_m']:.2f}, {1e3 * p['slip_error_median_m']:.2f} "
                f"| {'-' if creep is None else f'{1e6 * creep:.0f}'} | {p['flips']} "
                f"| {p['cost_ratio']:.2f} ({low:.2f} to {high:.2f}) | `{p['command']}` |"
            )
    return "\n".join(lines)


def front_of(points: Sequence[Row]) -> list[Row]:
    """Return the numerical settings that were measured on the most scenes."""
    own = [p for p in points if p["kind"] == "numerics"]
    return [p for p in own if p["scenes"] == max(q["scenes"] for q in own)]


def growth(rows: Sequence[Row]) -> str:
    """Return the exponents."""
    lines = ["| cost | sizes | processor time | exponent | repeat |", "|---|---|---|---|---|"]
    for row in rows:
        sizes = ", ".join(f"{size:g}" for size in row["size"])
        times = ", ".join(_time(seconds) for seconds in row["processor_s"])
        exponent = f"{row['exponent']:.2f} +- {row['exponent_standard_error']:.2f}"
        lines.append(f"| {row['name']} | {sizes} | {times} | {exponent} | `{row['command']}` |")
    return "\n".join(lines)


def _time(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds > 0.1 else f"{1e6 * seconds:.0f} us"


def honour(rows: Sequence[Row]) -> str:
    """Return how often the choice by tolerance kept its word."""
    lines = [
        "| tolerance | picked | honoured (95 % Wilson) | of the decided ones | other verdict "
        "| processor time over the finest's |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        asked = f"{row['tolerance_angle_deg']:g} degrees, {1e3 * row['tolerance_slip_m']:g} mm"
        if "refused" in row:
            lines.append(f"| {asked} | refused | - | - | - | - |")
            continue
        decided = row["scenes"] - row["undecided"]
        share = f"({100 * row['wilson_low']:.0f} to {100 * row['wilson_high']:.0f} %)"
        lines.append(
            f"| {asked} | {row['picked']['name']} | {row['honoured']} of {row['scenes']} {share} "
            f"| {row['honoured_of_decided']} of {decided} | {row['flips']} "
            f"| {row['processor_s'] / row['finest_processor_s']:.2f} |"
        )
    return "\n".join(lines)


def with_tables(page: str, tables: Mapping[str, str]) -> str:
    """Return a page with its tables replaced: what stands between ``<!-- NAME -->`` and ``<!-- end -->``.

    Raises
    ------
    ValueError
        If the page has no place for one of them.
    """
    for name, table in tables.items():
        begin, end = f"<!-- {name} -->\n", "\n<!-- end -->"
        start = page.find(begin)
        stop = page.find(end, start)
        if start < 0 or stop < 0:
            raise ValueError(f"the page has no {begin.strip()} ... {end.strip()}")
        page = page[: start + len(begin)] + table + page[stop:]
    return page
