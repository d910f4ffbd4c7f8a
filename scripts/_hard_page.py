"""The hard cases' heat map and page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fea.stability.cases import SOLID_CASES
from softhand_sim.stability import hard_cases

DESCRIBED = {
    "finite": "within its criteria",
    "warned": "the product said that the result is not verified, or told what went beyond its calibration",
    "typed": "refused by name, or ended by a typed outcome",
    "diverged": "not finite, and nothing said so",
    "wrong": "outside its criteria, and nothing said so",
}
_COLOURS = {"finite": "#7fbf7f", "warned": "#f2d06b", "typed": "#7fa8d9", "diverged": "#c05fc0", "wrong": "#d9534f"}
_COMMAND = "scripts/hard_cases.py --creep lemon,tennis_ball --page docs/hard-cases.md"

Rows = Sequence[dict[str, Any]]


def draw(path: Path, rows: Rows, steps: Sequence[float]) -> None:
    """Draw the heat map: a row a case, a column a time step, cases of the solid in one of their own.

    Raises
    ------
    ValueError
        If matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure  # noqa: PLC0415 - optional dependency
        from matplotlib.patches import Patch  # noqa: PLC0415 - optional dependency
    except ImportError:
        raise ValueError(f"{path}: pictures need matplotlib (pip install 'softhand-sim[plots]')") from None
    names = list(dict.fromkeys(row["name"] for row in rows))
    columns: list[float | None] = [None, *steps]
    figure = Figure(figsize=(8.4, 1.6 + 0.2 * len(names)), dpi=110, layout="constrained")
    axes = figure.subplots()
    for row in rows:
        x, y = columns.index(row["timestep_s"]), names.index(row["name"])
        axes.add_patch(_square(x, y, _COLOURS[row["outcome"]]))
    axes.set_xlim(0, len(columns))
    axes.set_ylim(len(names), 0)
    axes.set_xticks([k + 0.5 for k in range(len(columns))], ["solid", *(f"{1e3 * s:g} ms" for s in steps)])
    axes.set_yticks([k + 0.5 for k in range(len(names))], names, fontsize=7)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.axvline(1.0, color="black", lw=0.8)
    if 2e-3 in steps:
        axes.axvline(2.0 + steps.index(2e-3), color="black", lw=1.5)
    patches = [Patch(color=colour, label=word) for word, colour in _COLOURS.items()]
    figure.legend(handles=patches, loc="outside lower center", ncols=len(patches), fontsize=8, frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def _square(x: int, y: int, colour: str) -> Any:
    from matplotlib.patches import Rectangle  # noqa: PLC0415 - optional dependency

    return Rectangle((x + 0.03, y + 0.06), 0.94, 0.88, color=colour, lw=0)


def page(rows: Rows, steps: Sequence[float], held: Rows, picture: str) -> str:
    """Return the page as Markdown."""
    about = {name: (case.hard, case.correctness) for name, case in SOLID_CASES.items()}
    about |= {name: (case.hard, case.correctness) for name, case in hard_cases().items()}
    lines = [
        "# Hard cases",
        "",
        "Each case is named in code (`fea/stability/cases`, `softhand_sim/stability/cases`: a new one is a file), "
        "with what makes it hard and two criteria: that it stays stable, and that it is right. Written by",
        "",
        "```",
        _COMMAND,
        "```",
        "",
        *(f"- **{word}**: {text}" for word, text in DESCRIBED.items()),
        "",
        "Up to the default step of 2 ms (thick line) every case has to end within its criteria or typed; above it a "
        "result that is off must say so. `tests/stability` runs all cases at the default step.",
        "",
        f"![Outcome of every case at every time step]({picture})",
        "",
        *_holding(held),
        "## The cases",
        "",
        f"| case | what makes it hard | right means | {' | '.join(['solid', *(f'{1e3 * s:g} ms' for s in steps)])} |",
        "|" + "---|" * (4 + len(steps)),
    ]
    found = {(row["name"], row["timestep_s"]): row for row in rows}
    for name in dict.fromkeys(row["name"] for row in rows):
        hard, right = about[name]
        cells = [_cell(found.get((name, step))) for step in (None, *steps)]
        lines.append(f"| {name} | {hard} | {right} | {' | '.join(cells)} |")
    lines += ["", "Figures, and what they may be at most:", ""]
    for name in dict.fromkeys(row["name"] for row in rows):
        own = [row for row in rows if row["name"] == name]
        values = ", ".join(f"{row['figure']:.3g}" for row in own)
        lines.append(f"- {name}: {own[0]['criterion']}: {values}")
    return "\n".join(lines) + "\n"


def _cell(row: dict[str, Any] | None) -> str:
    if row is None:
        return ""
    word = str(row["outcome"])
    if word != "typed":
        return word
    # the first word of a typed end is its name
    return f"typed: {str(row['detail']).split(' at ')[0].split(':')[0]}"


def _holding(held: Rows) -> list[str]:
    if not held:
        return []
    names = [name for name in held[0] if isinstance(held[0][name], dict)]
    lines = [
        f"## Holding for {held[0]['hold_s'] / 60:g} minutes",
        "",
        "Creep is the steady drift of the object in the hand over the second half of the hold, slip the way since "
        "the start of the lift; the cone's share is what the grasp uses of its friction at the end.",
        "",
    ]
    for name in names:
        engine = held[0][name]["engine"]
        lines.append(
            f"- {name.replace('_', ' ')}: time step {1e3 * engine['timestep_s']:g} ms, "
            f"{engine['noslip_iterations']} noslip iterations, impratio {engine['impratio']:g}"
        )
    lines += [
        "",
        f"| object | {' | '.join(name.replace('_', ' ') for name in names)} |",
        "|" + "---|" * (1 + len(names)),
    ]
    for one in held:
        cells = [
            f"{one[name]['outcome']}, {1e6 * one[name]['creep_m_per_s']:.2f} um/s, {1e3 * one[name]['slip_m']:.2f} mm, "
            f"{one[name]['cone_share']:.0%} of the cone"
            for name in names
        ]
        lines.append(f"| {one['object']} | {' | '.join(cells)} |")
    return [*lines, ""]
