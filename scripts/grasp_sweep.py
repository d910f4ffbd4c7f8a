"""Grasp success over one or two conditions: mass, friction, pressure, offset, calibration (material set), leak."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from scripts import _cli
from scripts._objects import catalogue_names
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.benchmark.store import TrialStore, conditions
from softhand_sim.benchmark.success_plots import success_plots
from softhand_sim.benchmark.sweep import AXES, Axis, SweepPoint, sweep_points, sweep_row
from softhand_sim.benchmark.sweep_table import sweep_table
from softhand_sim.grasp.protocol_file import DEFAULT, load_protocol, protocol_names
from softhand_sim.objects.catalogue import make_object

EXAMPLES = """examples:
  grasp_sweep.py --objects apple,mug --vary mass_scale=0.5,1,2,4 --workers 2
  grasp_sweep.py --objects apple --vary mass_kg=0.05,0.1,0.2,0.4 --vary friction=0.2,0.4,0.8      # a surface
  grasp_sweep.py --objects apple --vary pressure_pa_gauge=40e3,55e3,75e3
  grasp_sweep.py --objects mug --vary offset_x_m=-0.02,-0.01,0,0.01,0.02
  grasp_sweep.py --objects apple --vary leak_thumb_m3_per_s_pa=0,3e-11,1e-10
  grasp_sweep.py --objects apple --vary calibration=shipped,out/wall/finger-01.json    # material sets, dimensions
Trials are kept in OUT/trials: the same command goes on where it was broken off.
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default="apple,mug", help="of the catalogue, comma-separated; or 'all' (%(default)s)")
    text = f"a condition and its values; once or twice. Conditions: {', '.join(AXES)}"
    p.add_argument("--vary", action="append", required=True, metavar="NAME=V,V", help=text)
    text = f"{', '.join(protocol_names())}, or a TOML file (default {DEFAULT})"
    p.add_argument("--protocol", default=DEFAULT, metavar="NAME", help=text)
    p.add_argument("--trials", type=_cli.positive_int, default=20, help="per object and point (default 20)")
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes side by side (default 1)")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    text = "folder of table, plots, trials (default %(default)s)"
    p.add_argument("--out", type=Path, default=Path("out/sweep"), help=text)
    p.add_common(seed="seed of the first trial", json="settings and all rows (default OUT/sweep.json)")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    file = args.json or args.out / "sweep.json"
    for path in (file, args.out / "table.md", args.out / "trials" / "any.sqlite"):
        _cli.check_writable(path, "--json" if path is args.json else "--out")
    names = catalogue_names(args.objects)
    base = BenchmarkPlan(
        objects=tuple(make_object(name) for name in names),
        trials=args.trials,
        seed=args.seed,
        calibration=args.calibration,
        protocol=load_protocol(args.protocol),
    )
    axes = [_axis(text) for text in args.vary]
    points = sweep_points(base, axes)
    data: dict[str, Any] = {
        "settings": {
            "axes": [{"name": axis.name, "values": list(axis.values)} for axis in axes],
            "objects": names,
            "trials": args.trials,
            "seed": args.seed,
            "conditions": conditions(base),
        },
        "rows": [],
    }
    total = len(points) * len(names) * args.trials
    with tqdm(total=total, desc="trials", unit="trial", disable=None) as bar:
        for point in points:
            data["rows"].append(_row(point, args.out / "trials", args.workers, bar))
            _cli.write_json(file, data)
            _cli.write_text(args.out / "table.md", sweep_table(data) + "\n")
    print(sweep_table(data))
    for name, picture in success_plots(data).items():
        _cli.write_text(args.out / f"{name}.svg", picture)
    return 0


def _row(point: SweepPoint, folder: Path, workers: int, bar: Any) -> dict[str, Any]:
    name = hashlib.sha256(json.dumps(point.values).encode()).hexdigest()[:16]
    with TrialStore(folder / f"{name}.sqlite", point.plan) as store:
        results = []
        for result in run_benchmark(point.plan, workers, store):
            results.append(result)
            bar.update()
    return sweep_row(point, in_order(point.plan, results))


def _axis(text: str) -> Axis:
    name, _, listed = text.partition("=")
    items = [item.strip() for item in listed.split(",")]
    if name == "calibration":
        return Axis(name=name, values=tuple(items))
    try:
        values = tuple(float(item) for item in items)
    except ValueError:
        raise ValueError(f"--vary {text}: must read NAME=NUMBER,NUMBER") from None
    return Axis(name=name, values=values)


if __name__ == "__main__":
    raise SystemExit(main())
