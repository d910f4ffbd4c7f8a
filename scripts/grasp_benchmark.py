"""Grasp trials of the soft hand: a table of success rates, JSON, and a picture of each object in the hand."""

import argparse
import hashlib
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import asdict
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tqdm import tqdm

from assets import asset_path
from scripts import _cli
from scripts._grasp_report import read_sweep, write_report
from scripts._grasps import ChosenGrasp, add_grasps, check_search, choose_grasps, cost
from scripts._objects import catalogue_names
from scripts._replay import tell_repeat
from scripts._tolerance import add_tolerance, chosen_fidelity, tell_picked
from softhand_sim.benchmark.halves import DEVELOPMENT, REPORT, half, held_in_halves
from softhand_sim.benchmark.pictures import draw
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.ray_engine import LOCAL
from softhand_sim.benchmark.report import beyond_calibration, conditions, summarise, table, told_by_guards, trial_rows
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.benchmark.step_check import StepCheck, compare, drawn, finer, repeat
from softhand_sim.benchmark.store import TrialStore
from softhand_sim.grasp.protocol_file import DEFAULT, load_protocol, protocol_names
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.stage import Phase
from softhand_sim.objects.batch import Batch, load_all
from softhand_sim.objects.catalogue import load_catalogue, make_object
from softhand_sim.objects.loader import load_mesh_object
from softhand_sim.objects.model import DEFAULT_FRICTION, ObjectModel
from softhand_sim.objects.ycb import load_ycb_object, ycb_names
from softhand_sim.policy.policy_file import load_policy
from softhand_sim.render import RenderUnavailableError

EXAMPLES = """examples:
  grasp_benchmark.py --objects all --trials 20 --workers 2 --json out/grasps.json
  grasp_benchmark.py --objects apple --friction 0.05            # an oiled apple
  grasp_benchmark.py --mesh scan.obj --mass 0.068 --trials 5    # any mesh, in metres
  grasp_benchmark.py --mesh scan.stl --scale 0.001 --mass 0.2   # in millimetres
  grasp_benchmark.py --ycb ycb/models --trials 5                # the YCB set as downloaded
  grasp_benchmark.py --trials 100 --workers 2 --store out/run.sqlite   # killed? the same line goes on
  grasp_benchmark.py --protocol six_forces                      # or a TOML file of your own
  grasp_benchmark.py --objects mug --search 2000                # a longer search for the grasp; 0: scripted
  grasp_benchmark.py --objects mug --grasps mine.toml           # your own grasps
  grasp_benchmark.py --objects apple --policy mine.npz          # reach and close by a learned policy
  grasp_benchmark.py --tolerance 2,1                            # the cheapest setting within 2 degrees and 1 mm
  grasp_benchmark.py --effects auto --tolerance 15,25           # and of all effects those that each object calls for
  grasp_benchmark.py --trials 10 --check-steps 300 --workers 2  # do verdicts depend on the time step?
  grasp_benchmark.py --trials 100 --engine ray --ray-address auto --workers 64 --store out/run.sqlite
  grasp_benchmark.py --trials 10 --report out/grasps.html --sweeps out/mass/sweep.json
  grasp_benchmark.py --trials 5 --replays out/replays           # keep what a guard ends
  grasp_benchmark.py --replay out/replays/tuna_can_paper_0_extrapolated.npz   # and repeat it from its saved state
An object that cannot be loaded is set aside, the rest of the run goes on; the exit status is then 1.
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument(
        "--objects",
        help="catalogue names, comma-separated, 'all' (default without meshes), or a half: 'development', 'report'",
    )
    p.add_argument(
        "--mesh", type=Path, nargs="+", default=[], help="meshes of your own (OBJ, STL, PLY, GLB), in metres"
    )
    p.add_argument(
        "--ycb", type=Path, metavar="DIR", help="folder of the YCB set as downloaded; objects stand as scanned"
    )
    p.add_argument("--scale", type=_cli.positive_float, default=1.0, help="metres per unit of --mesh (default 1)")
    p.add_argument("--keep-upright", action="store_true", help="let --mesh stand as in its file (z up)")
    p.add_argument("--mass", type=_cli.positive_float, help="mass in kg; needed with --mesh, else an override")
    p.add_argument("--friction", type=_cli.non_negative_float, help="sliding friction coefficient, an override")
    p.add_argument(
        "--protocol",
        default=DEFAULT,
        metavar="NAME",
        help=f"{', '.join(protocol_names())}, or a TOML file (default {DEFAULT})",
    )
    add_grasps(p)
    text = "learned policy that reaches and closes in the place of the script (.npz; docs/learning.md)"
    p.add_argument("--policy", type=Path, metavar="FILE", help=text)
    p.add_argument("--trials", type=_cli.positive_int, default=20, help="trials per object (default 20)")
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes side by side (default 1)")
    text = "who runs the trials: processes of this machine, or a Ray cluster, an extra (default local)"
    p.add_argument("--engine", choices=("local", "ray"), default="local", help=text)
    text = "of the cluster, such as 10.0.0.1:6379 or auto (default: a cluster of its own on this machine)"
    p.add_argument("--ray-address", metavar="ADDRESS", help=text)
    p.add_argument(
        "--store", type=Path, metavar="FILE", help="SQLite file that keeps each trial; a killed run goes on from there"
    )
    p.add_argument("--timestep", type=_cli.positive_float, metavar="MS", help="in ms (default 2)")
    add_tolerance(p)
    p.add_argument(
        "--check-steps",
        type=_cli.positive_int,
        metavar="N",
        help="repeat N trials at a quarter of the time step with more noslip iterations; say how many verdicts differ",
    )
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_common(seed="seed of the first trial", json="write settings, summary and every trial to this file")
    p.add_argument("--report", type=Path, metavar="HTML", help="write a web page: table, films, histograms, provenance")
    text = "folder for replay files of trials that a guard ends (docs/hard-cases.md)"
    p.add_argument("--replays", type=Path, metavar="DIR", help=text)
    p.add_argument("--replay", type=Path, metavar="FILE", help="run such a file again from its state, and nothing else")
    text = "results of grasp_sweep.py that the report shows"
    p.add_argument("--sweeps", type=Path, nargs="+", default=[], metavar="JSON", help=text)
    p.add_argument("--pictures", type=Path, default=Path("out/grasps"), help="folder (default out/grasps)")
    p.add_argument("--no-pictures", action="store_true", help="draw nothing")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    if args.replay is not None:
        return tell_repeat(args.replay, args.json)
    _cli.check_writable(args.replays and args.replays / "replay.npz", "--replays")
    _cli.check_writable(args.store, "--store")
    _cli.check_writable(args.report, "--report")
    if args.sweeps and args.report is None:
        raise ValueError(f"--sweeps {args.sweeps[0]}: needs --report")
    sweeps = [read_sweep(path) for path in args.sweeps]
    _ray_address(args)
    args.fidelity = chosen_fidelity(args)
    engine = args.fidelity.engine
    if args.check_steps and engine.timestep_s < 0.4e-3:
        raise ValueError(f"--check-steps: a quarter of {1e3 * engine.timestep_s:g} ms is below 0.1 ms")
    check_search(args.search)
    args.protocol = load_protocol(args.protocol)
    policy = None if args.policy is None else load_policy(args.policy)
    batch = load_all(_loaders(args))
    grasps = choose_grasps(
        batch.models, own=args.grasps, search=args.search, calibration=args.calibration, protocol=args.protocol
    )
    plan = BenchmarkPlan(
        engine=engine,
        effects=args.fidelity.scene_effects,
        tolerance=args.fidelity.auto_effects,
        objects=batch.models,
        trials=args.trials,
        seed=args.seed,
        calibration=args.calibration,
        protocol=args.protocol,
        grasps={name: grasp.kept.plan for name, grasp in grasps.items()},
        policy=policy,
        replays=args.replays,
    )
    total = len(plan.objects) * plan.trials
    with nullcontext() if args.store is None else TrialStore(args.store, plan) as store:
        running = run_benchmark(plan, args.workers, store, ray_address=_ray_address(args))
        results = in_order(plan, list(tqdm(running, total=total, desc="trials", unit="trial")))
    check = None if args.check_steps is None else _step_check(plan, results, args)
    summary = summarise(results)
    _tell(plan, results, batch, summary, grasps, check)
    tell_picked(args.fidelity)
    if args.json is not None:
        notes = {model.name: list(model.notes) for model in plan.objects if model.notes}
        data: dict[str, Any] = {"settings": _settings(args), "not_tried": dict(batch.failures), "notes": notes}
        data["grasps"] = {name: grasp.data() for name, grasp in grasps.items()}
        data["step_check"] = None if check is None else check.data()
        _cli.write_json(args.json, {**data, "objects": summary, "trials": trial_rows(results)})
    if args.report is not None:
        write_report(args.report, plan, results, batch, settings=_settings(args), sweeps=sweeps, check=check)
        print(f"report: {args.report}")
    if not args.no_pictures:
        try:
            files = draw(plan, results, args.pictures)
            print("pictures:", " ".join(str(file) for file in files))
        except RenderUnavailableError as error:
            print(f"no pictures: {error}", file=sys.stderr)
    return _cli.INCOMPLETE if batch.failures else 0


def _tell(
    plan: BenchmarkPlan,
    results: Sequence[TrialResult],
    batch: Batch,
    summary: dict[str, dict[str, Any]],
    grasps: dict[str, ChosenGrasp],
    check: StepCheck | None,
) -> None:
    """Print the table and what belongs below it."""
    below = (
        told_by_guards(results),
        beyond_calibration(results),
        conditions(plan.protocol),
        cost(grasps),
        held_in_halves(results, load_catalogue()),
        "" if check is None else check.text(),
    )
    print("\n".join([table(summary), *(line for line in below if line)]))
    for name, reason in batch.failures.items():
        # a mesh file's reason begins with its path already
        print(f"not tried: {reason if reason.startswith(name) else f'{name}: {reason}'}", file=sys.stderr)


def _ray_address(args: argparse.Namespace) -> str | None:
    if args.engine == "ray":
        return LOCAL if args.ray_address is None else str(args.ray_address)
    if args.ray_address is not None:
        raise ValueError(f"--ray-address {args.ray_address}: needs --engine ray")
    return None


def _step_check(plan: BenchmarkPlan, results: Sequence[TrialResult], args: argparse.Namespace) -> StepCheck:
    """Repeat some trials with the finer engine; with a store, they are kept in one beside it."""
    keys = drawn(results, args.check_steps, args.seed)
    path = None if args.store is None else args.store.with_name(f"{args.store.name}.steps")
    with nullcontext() if path is None else TrialStore(path, finer(plan)) as store:
        running = repeat(plan, keys, args.workers, store, _ray_address(args))
        return compare(results, list(tqdm(running, total=len(keys), desc="step check", unit="trial")))


def _loaders(args: argparse.Namespace) -> dict[str, Callable[[], ObjectModel]]:
    """Return by name how each object asked for is loaded; wrong names of the catalogue are refused at once."""
    for option, own in (("--mass", args.protocol.mass_kg), ("--friction", args.protocol.friction)):
        if own is not None and getattr(args, option[2:]) is not None:
            raise ValueError(f"{option}: the protocol {args.protocol.name} prescribes {own:g}")
    if args.mesh and args.mass is None and args.protocol.mass_kg is None:
        raise ValueError(f"--mass: needed with --mesh {args.mesh[0]} (kg, above 0)")
    loaders: dict[str, Callable[[], ObjectModel]] = {}
    for path in args.mesh:
        loaders[str(path)] = partial(_mesh, path, args)
    if args.ycb is not None:
        mass = args.protocol.mass_kg if args.mass is None else args.mass
        for name in ycb_names(args.ycb):
            loaders[name] = partial(load_ycb_object, args.ycb, name, mass_kg=mass, friction=args.friction)
    if args.objects is not None or not (args.mesh or args.ycb):
        for name in _catalogue_names(args.objects):
            loaders[name] = partial(_from_catalogue, name, args)
    return loaders


def _catalogue_names(objects: str | None) -> list[str]:
    if objects in (DEVELOPMENT, REPORT):
        return half(list(load_catalogue()), objects)
    return catalogue_names("all" if objects is None else objects)


def _mesh(path: Path, args: argparse.Namespace) -> ObjectModel:
    return load_mesh_object(
        path,
        mass_kg=args.protocol.mass_kg if args.mass is None else args.mass,
        friction=DEFAULT_FRICTION if args.friction is None else args.friction,
        scale=args.scale,
        keep_upright=args.keep_upright,
    )


def _from_catalogue(name: str, args: argparse.Namespace) -> ObjectModel:
    return make_object(name).with_overrides(mass_kg=args.mass, friction=args.friction)


def _settings(args: argparse.Namespace) -> dict[str, Any]:
    file = args.calibration or asset_path("calibration", "finger.json")
    return {
        "trials": args.trials,
        "seed": args.seed,
        "mass_kg": args.mass,
        "friction": args.friction,
        "timestep_s": args.fidelity.timestep_s,
        "fidelity": args.fidelity.data(),
        "mesh": [str(path) for path in args.mesh],
        "ycb": None if args.ycb is None else str(args.ycb),
        "protocol": asdict(args.protocol) | {"phases": [_phase(phase) for phase in args.protocol.phases]},
        "policy_sha256": None if args.policy is None else hashlib.sha256(args.policy.read_bytes()).hexdigest(),
        "calibration_sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
        "mujoco_version": version("mujoco"),
        "numpy_version": version("numpy"),
    }


def _phase(phase: Phase) -> dict[str, Any]:
    values = {key: value for key, value in vars(phase).items() if key != "needs_object"}
    return {"do": type(phase).__name__.lower(), **values}


if __name__ == "__main__":
    raise SystemExit(main())
