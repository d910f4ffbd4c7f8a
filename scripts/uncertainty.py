"""How uncertain the calibrated finger is: an ensemble of calibrations, bands of its figures, grasp success with it."""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from assets import asset_path
from fea.density import DENSITIES
from fea.finger_design import load_design
from fea.solved import solve_finger
from scripts import _cli, _solving, _uncertainty_pictures, _uncertainty_report
from scripts._ensemble import Job, assemble, solve_members
from scripts._objects import catalogue_names
from softhand_sim.checks import require_in
from softhand_sim.grasp.protocol_file import DEFAULT, load_protocol, protocol_names
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.uncertainty import (
    Band,
    Ensemble,
    UncertaintyPlan,
    combined_band,
    grasp_rows,
    load_ensemble,
    measure,
    scenario_band,
    tolerance_band,
)
from softhand_sim.uncertainty.blend import FURTHEST
from softhand_sim.uncertainty.ensemble import SCENARIOS, TOLERANCE
from softhand_sim.uncertainty.grasps import finger_count

EXAMPLES = """examples:
  python scripts/uncertainty.py grasps --objects apple,mug --workers 2 --json out/uncertainty.json   # no solving
  python scripts/uncertainty.py grasps --objects all --fingers 16 --trials 20 --spread 0.5 --scenarios none
  python scripts/uncertainty.py bands --pressures 30,45,60,75 --picture out/bands.png
  python scripts/uncertainty.py solve --density coarse --out out/ensemble     # 15 fingers; goes on where it was
  python scripts/uncertainty.py assemble --out out/ensemble                   # calibrations about the nominal finger
bands and grasps take the shipped ensemble, or that of --ensemble. The picture needs matplotlib.
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("command", choices=list(_COMMANDS), help="what to do")
    p.add_argument("--calibration", type=Path, help="the nominal finger (default: the shipped calibration)")
    p.add_argument("--json", type=Path, metavar="FILE", help="write all figures to this file")
    text = "draws of fingers, and seed of the first trial (default 0); solve and assemble draw nothing"
    p.add_argument("--seed", type=_cli.non_negative_int, default=0, help=text)
    made = p.add_argument_group("solve, assemble")
    made.add_argument("--finger", type=Path, metavar="TOML", help="the finger (assets/fingers/default.toml)")
    made.add_argument("--density", choices=sorted(DENSITIES), default="coarse", help="mesh density (%(default)s)")
    made.add_argument("--only", metavar="NAME,NAME", default="", help="members to solve (all)")
    text = "runs of the nine pairs by finger_table.py materials --unload; analysis (iii) is taken from there"
    made.add_argument("--runs", type=Path, metavar="JSON", help=text)
    text = (
        "folder of the ensemble (solve, assemble: assets/calibration/ensemble; grasps: calibrations, out/uncertainty)"
    )
    made.add_argument("--out", type=Path, help=text)
    _solving.add_store(p)
    used = p.add_argument_group("bands, grasps")
    used.add_argument("--ensemble", type=Path, metavar="FOLDER", help="ensemble (default: the shipped one)")
    used.add_argument("--pressures", default="30,45,60,75", metavar="KPA,KPA", help="of the bands (%(default)s)")
    used.add_argument("--spread", type=float, default=1.0, help="factor on every tolerance, 0 to 2 (%(default)s)")
    used.add_argument("--picture", type=Path, metavar="PNG", help="draw the result")
    grasp = p.add_argument_group("grasps")
    grasp.add_argument("--objects", default="apple,mug", help="of the catalogue, comma-separated, or all (%(default)s)")
    grasp.add_argument("--trials", type=_cli.positive_int, default=4, help="per finger and object (%(default)s)")
    grasp.add_argument("--fingers", type=_cli.positive_int, default=8, help="drawn from the tolerances (%(default)s)")
    grasp.add_argument("--scenarios", default="all", help="sources of scenarios, comma-separated; all, none (all)")
    text = "set pressures from each finger's own curve (default: from the nominal finger's, as the controller has it)"
    grasp.add_argument("--known-finger", action="store_true", help=text)
    text = f"{', '.join(protocol_names())}, or a TOML file (%(default)s)"
    grasp.add_argument("--protocol", default=DEFAULT, metavar="NAME", help=text)
    grasp.add_argument("--workers", type=_cli.positive_int, default=1, help="processes for the grasps (%(default)s)")
    return p


def job(argv: Sequence[str] | None = None, analyses: _solving.Analyses = solve_finger) -> int:
    """Run a command; return the exit status."""
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    _cli.check_writable(args.picture, "--picture")
    require_in("--spread", args.spread, 0.0, FURTHEST)
    if args.picture is not None and find_spec("matplotlib") is None:
        raise ValueError("--picture: matplotlib is missing (pip install 'softhand-sim[plots]')")
    return _COMMANDS[args.command](args, analyses)


def _solve(args: Any, analyses: _solving.Analyses) -> int:
    work = _job(args, analyses)
    solve_members(work, tuple(filter(None, args.only.split(","))))
    return _assemble(args, analyses)


def _assemble(args: Any, analyses: _solving.Analyses) -> int:
    work = _job(args, analyses)
    nominal = args.calibration or asset_path("calibration", "finger.json")
    manifest = assemble(work, nominal)
    ensemble = load_ensemble(work.folder, nominal)
    _say_refused(ensemble)
    if args.json is not None:
        _cli.write_json(args.json, json.loads(manifest.read_text(encoding="utf-8")))
    print(f"{manifest}: {sum(len(s.solved) for s in ensemble.sources)} calibrations")
    return 0


def _job(args: Any, analyses: _solving.Analyses) -> Job:
    folder = args.out or asset_path("calibration") / "ensemble"
    _cli.check_writable(folder / "solved" / "nominal.json", "--out")
    runs = []
    if args.runs is not None:
        if not args.runs.is_file():
            raise FileNotFoundError(f"--runs {args.runs}: no such file")
        try:
            runs = json.loads(args.runs.read_text(encoding="utf-8"))["runs"]
        except (ValueError, KeyError, TypeError):
            raise ValueError(f"--runs {args.runs}: not what finger_table.py --json writes") from None
    return Job(
        base=load_design(args.finger or asset_path("fingers", "default.toml")),
        density=DENSITIES[args.density],
        folder=folder,
        solve=_solving.solver(args, analyses),
        runs=runs,
    )


def _bands(args: Any, analyses: _solving.Analyses) -> int:  # noqa: ARG001 - the commands' common signature
    pressures = _cli.rising_pressures(args.pressures)
    ensemble = load_ensemble(args.ensemble, args.calibration)
    members = [ensemble.nominal, *(m for s in ensemble.sources for m in s.solved)]
    figures = {}
    for member in tqdm(members, desc="fingers", unit="finger"):
        assert member.calibration is not None
        figures[member.name] = measure(member.calibration, pressures).as_dict()
    bands: dict[str, dict[str, Band]] = {}
    for source in ensemble.of_kind(TOLERANCE):
        bands[source.name] = tolerance_band(ensemble, source, figures, spread=args.spread)
    if bands:
        rng = np.random.default_rng(args.seed)
        bands["tolerances"] = combined_band(ensemble, figures, rng, spread=args.spread)
    for source in ensemble.of_kind(SCENARIOS):
        bands[source.name] = scenario_band(ensemble, source, figures)
    print(_uncertainty_report.band_table(bands, pressures))
    _say_refused(ensemble)
    if args.json is not None:
        rows = {name: {key: asdict(band) for key, band in own.items()} for name, own in bands.items()}
        _cli.write_json(args.json, {"spread": args.spread, "seed": args.seed, "bands": rows, "members": figures})
    if args.picture is not None:
        _uncertainty_pictures.draw_bands(args.picture, bands, pressures)
    return 0


def _grasps(args: Any, analyses: _solving.Analyses) -> int:  # noqa: ARG001 - the commands' common signature
    ensemble = load_ensemble(args.ensemble, args.calibration)
    plan = UncertaintyPlan(
        objects=_objects(args.objects),
        trials=args.trials,
        seed=args.seed,
        fingers=args.fingers,
        spread=args.spread,
        known_finger=args.known_finger,
        scenarios=_scenarios(args.scenarios, ensemble),
        protocol=load_protocol(args.protocol),
    )
    folder = args.out or Path("out/uncertainty")
    _cli.check_writable(folder / "nominal.json", "--out")
    rows = []
    with tqdm(total=finger_count(ensemble, plan), desc="fingers", unit="finger") as bar:
        for row in grasp_rows(ensemble, plan, folder, workers=args.workers):
            rows.append(row)
            bar.update(int(bool(row.trials) and bar.n < (bar.total or 0)))
    result = _uncertainty_report.grasp_result(plan, rows)
    print(_uncertainty_report.grasp_table(result))
    _say_refused(ensemble)
    if args.json is not None:
        _cli.write_json(args.json, result)
    if args.picture is not None:
        _uncertainty_pictures.draw_grasps(args.picture, result, _uncertainty_pictures.angle_curves(folder, rows))
    return 0


def _say_refused(ensemble: Ensemble) -> None:
    for source, member in ensemble.members():
        if member.refused:
            then = "; its side mirrors the other one" if source.kind == TOLERANCE else ""
            print(f"{source.name}: {member.name} has no calibration{then}: {member.refused}")


def _objects(text: str) -> tuple[ObjectModel, ...]:
    return tuple(make_object(name) for name in catalogue_names(text))


def _scenarios(text: str, ensemble: Ensemble) -> tuple[str, ...]:
    known = tuple(source.name for source in ensemble.sources if source.kind == SCENARIOS)
    asked = {"all": known, "none": ()}.get(text, tuple(text.split(",")))
    for name in asked:
        if name not in known:
            raise ValueError(f"--scenarios: {name!r} is not one of {list(known)}, all, none")
    return asked


_COMMANDS = {"grasps": _grasps, "bands": _bands, "solve": _solve, "assemble": _assemble}


def main(argv: list[str] | None = None, analyses: _solving.Analyses = solve_finger) -> int:
    """Entry point."""
    return _cli.run(lambda given: job(given, analyses), argv)


if __name__ == "__main__":
    sys.exit(main())
