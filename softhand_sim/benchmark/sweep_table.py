"""Table of a sweep, and how success goes along its conditions."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

_UNITS = {"_pa_gauge": (1e-3, "kPa"), "_m3_per_s_pa": (1.0, "m3/(s Pa)"), "_kg": (1e3, "g"), "_m": (1e3, "mm")}


def label(name: str) -> str:
    """Return a condition's name with the unit that it is shown in."""
    for ending, (_, unit) in _UNITS.items():
        if name.endswith(ending):
            return f"{name.removesuffix(ending).replace('_', ' ')} ({unit})"
    return name.replace("_", " ")


def shown(name: str, value: float | str) -> str:
    """Return a condition's value in the unit of its label."""
    if isinstance(value, str):
        return Path(value).stem
    factor = next((factor for ending, (factor, _) in _UNITS.items() if name.endswith(ending)), 1.0)
    return f"{factor * value:.4g}"


def sweep_table(data: Mapping[str, Any]) -> str:
    """Return a sweep as Markdown: a row a combination, a column an object, with Wilson's 95 % intervals."""
    axes, names = data["settings"]["axes"], data["settings"]["objects"]
    head = [*(label(axis["name"]) for axis in axes), *(f"{name} held" for name in names)]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for row in data["rows"]:
        cells = [shown(axis["name"], row["values"][axis["name"]]) for axis in axes]
        lines.append(f"| {' | '.join([*cells, *(_held(row['objects'][name]) for name in names)])} |")
    for axis in axes:
        for name in names:
            lines += ["", f"{name} along {label(axis['name'])}: {trend(data, axis['name'], name)}"]
    return "\n".join(lines)


def trend(data: Mapping[str, Any], axis: str, name: str) -> str:
    """Say how an object's success goes with a condition's values in their order, all other values alike.

    Two rates differ if their 95 % intervals are apart. ``falls``: some later rate differs downward and none upward;
    ``rises``: the other way; ``level``: none differs; ``both``: some up, some down.
    """
    lines: dict[tuple[Any, ...], list[Mapping[str, Any]]] = {}
    for row in data["rows"]:
        others = tuple(value for key, value in row["values"].items() if key != axis)
        lines.setdefault(others, []).append(row["objects"][name])
    return _word([pair for line in lines.values() for pair in combinations(line, 2)])


def _word(pairs: Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]]) -> str:
    falls = any(later["wilson_high"] < earlier["wilson_low"] for earlier, later in pairs)
    rises = any(later["wilson_low"] > earlier["wilson_high"] for earlier, later in pairs)
    return {(True, False): "falls", (False, True): "rises", (False, False): "level"}.get((falls, rises), "both")


def _held(one: Mapping[str, Any]) -> str:
    return f"{one['held']}/{one['trials']} ({one['wilson_low']:.2f}-{one['wilson_high']:.2f})"
