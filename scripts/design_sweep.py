"""From a finger's TOML file to bending, tip force and grasp success, for the finger or for variations of it."""

import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from assets import asset_path
from fea.density import DENSITIES
from fea.finger_design import load_design
from fea.solved import solve_finger
from scripts import _cli, _solving, _sweep_report
from scripts._objects import catalogue_names
from scripts._sweep_measure import Plan, measured
from scripts._sweep_points import Variable, designs, variable
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.model import ObjectModel

EXAMPLES = """examples:
  python scripts/design_sweep.py --finger my_finger.toml --objects apple,mug     # one finger: its grasp table
  python scripts/design_sweep.py --vary tube_wall_m=2.0e-3,2.5e-3,3.0e-3 --out out/wall
  python scripts/design_sweep.py --vary gap_length_m=4e-3,5e-3 --vary tpu=ninjaflex/set2,ninjaflex/set3
  python scripts/design_sweep.py --vary ring_count=30,44,60 --density coarse     # ring pitch = 87 mm / ring_count
Solved fingers are kept in the store: the same command goes on where it was broken off.
"""
MOST_VARIED = 2


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--finger", type=Path, metavar="TOML", help="the finger (default: assets/fingers/default.toml)")
    text = "a dimension (SI), or silicone, tpu or pet, and its values; up to two times"
    p.add_argument("--vary", action="append", default=[], metavar="NAME=V,V", help=text)
    p.add_argument("--density", choices=sorted(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    p.add_argument("--pressures", default="75", metavar="KPA,KPA", help="of angle and tip force (%(default)s)")
    p.add_argument("--objects", default="apple,mug", help="of the catalogue, comma-separated; 'none' (%(default)s)")
    p.add_argument("--trials", type=_cli.positive_int, default=4, help="grasps per object (default %(default)s)")
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes for the grasps (%(default)s)")
    _solving.add_store(p)
    text = "folder of table, plot, calibrations (default %(default)s)"
    p.add_argument("--out", type=Path, default=Path("out/design"), help=text)
    p.add_argument("--no-plot", action="store_true", help="draw nothing")
    p.add_common(seed="seed of the first trial", json="rows with all figures and every trial (OUT/sweep.json)")
    return p


def job(argv: Sequence[str] | None = None, analyses: _solving.Analyses = solve_finger) -> int:
    """Run the sweep; return the exit status: 1 if no finger got a result."""
    args = parser().parse_args(argv)
    file = args.json or args.out / "sweep.json"
    for path in (file, args.out / "table.md"):
        _cli.check_writable(path, "--json" if path is args.json else "--out")
    variables, pressures, objects = _variables(args.vary), _cli.rising_pressures(args.pressures), _objects(args.objects)
    plot = not args.no_plot and bool(variables)
    if plot and find_spec("matplotlib") is None:
        raise ValueError("--no-plot: needed, matplotlib is missing (pip install 'softhand-sim[plots]')")
    base = load_design(args.finger or asset_path("fingers", "default.toml"))
    points = designs(base, variables)
    plan = Plan(
        density=DENSITIES[args.density],
        pressures_pa_gauge=pressures,
        objects=objects,
        trials=args.trials,
        seed=args.seed,
        workers=args.workers,
        folder=args.out,
    )
    solve, found = _solving.solver(args, analyses), list[_sweep_report.Row]()
    names = [v.name for v in variables]
    shown = [model.name for model in objects]
    for number, (values, design) in enumerate(points):
        found.append({"values": values, **measured(plan, number, values, design, solve)})
        _cli.write_json(file, {"settings": _settings(args, plan), "rows": found})
        _cli.write_text(args.out / "table.md", _sweep_report.table(names, found, pressures, shown) + "\n")
    print(_sweep_report.table(names, found, pressures, shown))
    if plot:
        _sweep_report.draw(args.out / "sweep.png", names, found, pressures, shown)
    return 0 if any("calibration" in row for row in found) else 1


def _variables(texts: Sequence[str]) -> list[Variable]:
    variables = [variable(text) for text in texts]
    if len(variables) > MOST_VARIED:
        raise ValueError(f"--vary: {len(variables)} parameters given; at most {MOST_VARIED}")
    if len({v.name for v in variables}) < len(variables):
        raise ValueError(f"--vary {variables[0].name}: given twice; list all its values in one")
    return variables


def _objects(text: str) -> tuple[ObjectModel, ...]:
    if text == "none":
        return ()
    return tuple(make_object(name) for name in catalogue_names(text))


def _settings(args: Any, plan: Plan) -> dict[str, Any]:
    return {
        "finger": None if args.finger is None else str(args.finger),
        "vary": args.vary,
        "density": plan.density.name,
        "pressure_pa_gauge": list(plan.pressures_pa_gauge),
        "objects": [model.name for model in plan.objects],
        "trials": plan.trials,
        "seed": plan.seed,
    }


def main(argv: list[str] | None = None, analyses: _solving.Analyses = solve_finger) -> int:
    """Entry point."""
    return _cli.run(lambda given: job(given, analyses), argv)


if __name__ == "__main__":
    sys.exit(main())
