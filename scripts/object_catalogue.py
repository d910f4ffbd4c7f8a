"""The objects of the catalogue: a table of what each one is, and one picture of all at the same scale."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from scripts import _cli
from softhand_sim.benchmark.sheet import object_tile, sheet
from softhand_sim.objects.catalogue import CatalogueEntry, load_catalogue, make_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.render import RenderUnavailableError, save_png

EXAMPLES = """examples:
  object_catalogue.py                                                    # the table
  object_catalogue.py --markdown docs/objects.md --picture docs/objects.png
  object_catalogue.py --objects apple,mug --json out/objects.json
"""
COLUMNS = 8
TITLE = """# Objects

What `scripts/object_catalogue.py --markdown docs/objects.md --picture docs/objects.png` found in
`assets/objects/catalogue.toml`, where the source of every value stands. All objects are modelled after the YCB object
set; each rests as the benchmark starts with it. A new object is one more table in that file; a new family of shapes is
one more file in `softhand_sim/objects/shapes/`.
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default="all", help="names from the catalogue, comma-separated, or 'all' (default)")
    p.add_argument("--picture", type=Path, metavar="PNG", help="draw all objects on one sheet")
    p.add_argument("--markdown", type=Path, metavar="MD", help="write the table, with the picture if drawn, as a page")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the table to this file, in SI units")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    for option, path in (("--json", args.json), ("--picture", args.picture), ("--markdown", args.markdown)):
        _cli.check_writable(path, option)
    entries = load_catalogue()
    names = list(entries) if args.objects == "all" else [name.strip() for name in args.objects.split(",")]
    models = [make_object(name) for name in names]
    rows = {model.name: facts(model, entries[model.name]) for model in models}
    text = table(rows)
    print(text)
    if args.picture is not None:
        try:
            tiles = [object_tile(model) for model in tqdm(models, desc="pictures", unit="object")]
        except RenderUnavailableError as error:
            raise ValueError(f"--picture {args.picture}: {error}") from error
        save_png(args.picture, sheet(tiles, COLUMNS))
    if args.markdown is not None:
        shown = "" if args.picture is None else f"\n![All objects at one scale]({args.picture.name})\n"
        _cli.write_text(args.markdown, f"{TITLE}{shown}\n{text}\n")
    if args.json is not None:
        _cli.write_json(args.json, {"objects": rows})
    return 0


def facts(model: ObjectModel, entry: CatalogueEntry) -> dict[str, Any]:
    """Return what the table says of an object, in SI units."""
    return {
        "ycb": entry.ycb,
        "kind": entry.kind,
        "mass_kg": model.mass_kg,
        "friction": model.friction,
        "extents_m": [float(side) for side in model.extents_m],
        "volume_m3": float(model.mesh.volume),
        "principal_inertia_kg_m2": [float(value) for value in np.linalg.eigvalsh(model.inertia_kg_m2)],
        "convex_parts": len(model.convex_parts),
    }


def table(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the facts as a Markdown table."""
    lines = [
        "| object | YCB | shape | mass (g) | friction | box (mm) | volume (mL) | principal inertia (g cm2) | parts |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name, row in rows.items():
        box = " x ".join(f"{1e3 * side:.0f}" for side in row["extents_m"])
        inertia = ", ".join(f"{1e7 * value:.3g}" for value in row["principal_inertia_kg_m2"])
        lines.append(
            f"| {name} | {row['ycb']} | {row['kind']} | {1e3 * row['mass_kg']:.4g} | {row['friction']:g} | {box} "
            f"| {1e6 * row['volume_m3']:.1f} | {inertia} | {row['convex_parts']} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    raise SystemExit(main())
