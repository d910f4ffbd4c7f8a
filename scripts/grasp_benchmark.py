"""Grasp trials of the soft hand: a table of success rates, JSON, and a picture of each object in the hand."""

import argparse
import hashlib
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tqdm import tqdm

from assets import asset_path
from scripts import _cli
from softhand_sim.benchmark.pictures import draw
from softhand_sim.benchmark.report import beyond_calibration, summarise, table, trial_rows
from softhand_sim.benchmark.runner import BenchmarkPlan, in_order, run_benchmark
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.catalogue import load_catalogue, make_object
from softhand_sim.objects.loader import load_mesh_object
from softhand_sim.objects.model import DEFAULT_FRICTION, ObjectModel
from softhand_sim.render import RenderUnavailableError

EXAMPLES = """examples:
  grasp_benchmark.py --objects all --trials 20 --workers 2 --json out/grasps.json
  grasp_benchmark.py --objects apple --friction 0.05            # an oiled apple
  grasp_benchmark.py --mesh scan.obj --mass 0.068 --trials 5    # any mesh, in metres
  grasp_benchmark.py --mesh scan.stl --scale 0.001 --mass 0.2   # in millimetres
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", help="names from the catalogue, comma-separated, or 'all' (default without --mesh)")
    p.add_argument("--mesh", type=Path, help="a mesh of your own (OBJ, STL, PLY, GLB), in metres")
    p.add_argument("--scale", type=_cli.positive_float, default=1.0, help="metres per unit of --mesh (default 1)")
    p.add_argument("--keep-upright", action="store_true", help="let --mesh stand as in its file (z up)")
    p.add_argument("--mass", type=_cli.positive_float, help="mass in kg; needed with --mesh, else an override")
    p.add_argument("--friction", type=_cli.non_negative_float, help="sliding friction coefficient, an override")
    p.add_argument("--trials", type=_cli.positive_int, default=20, help="trials per object (default 20)")
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes side by side (default 1)")
    p.add_argument("--timestep", type=_cli.positive_float, default=2.0, metavar="MS", help="in ms (default 2)")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_common(seed="seed of the first trial", json="write settings, summary and every trial to this file")
    p.add_argument("--pictures", type=Path, default=Path("out/grasps"), help="folder (default out/grasps)")
    p.add_argument("--no-pictures", action="store_true", help="draw nothing")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    plan = BenchmarkPlan(
        engine=EngineSettings(timestep_s=1e-3 * args.timestep),
        objects=tuple(_objects(args)),
        trials=args.trials,
        seed=args.seed,
        calibration=args.calibration,
    )
    total = len(plan.objects) * plan.trials
    running = run_benchmark(plan, args.workers)
    results = in_order(plan, list(tqdm(running, total=total, desc="trials", unit="trial")))
    summary = summarise(results)
    print(table(summary))
    if flags := beyond_calibration(results):
        print(flags)
    if args.json is not None:
        data = {"settings": _settings(args), "objects": summary, "trials": trial_rows(results)}
        _cli.write_json(args.json, data)
    if not args.no_pictures:
        try:
            files = draw(plan, results, args.pictures)
            print("pictures:", " ".join(str(file) for file in files))
        except RenderUnavailableError as error:
            print(f"no pictures: {error}", file=sys.stderr)
    return 0


def _objects(args: argparse.Namespace) -> list[ObjectModel]:
    models = []
    if args.mesh is not None:
        if args.mass is None:
            raise ValueError(f"--mass: needed with --mesh {args.mesh} (kg, above 0)")
        models.append(
            load_mesh_object(
                args.mesh,
                mass_kg=args.mass,
                friction=DEFAULT_FRICTION if args.friction is None else args.friction,
                scale=args.scale,
                keep_upright=args.keep_upright,
            )
        )
    if args.objects is not None or args.mesh is None:
        known = list(load_catalogue())
        asked = known if args.objects in (None, "all") else [name.strip() for name in args.objects.split(",")]
        for name in asked:
            if name not in known:
                raise ValueError(f"--objects: {name!r} is not in the catalogue {known}")
        models += [make_object(name).with_overrides(mass_kg=args.mass, friction=args.friction) for name in asked]
    return models


def _settings(args: argparse.Namespace) -> dict[str, Any]:
    file = args.calibration or asset_path("calibration", "finger.json")
    return {
        "trials": args.trials,
        "seed": args.seed,
        "mass_kg": args.mass,
        "friction": args.friction,
        "timestep_s": 1e-3 * args.timestep,
        "mesh": None if args.mesh is None else str(args.mesh),
        "calibration_sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
        "mujoco_version": version("mujoco"),
        "numpy_version": version("numpy"),
    }


if __name__ == "__main__":
    raise SystemExit(main())
