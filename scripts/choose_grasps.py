"""Chooses the grasps of catalogue objects and writes them to a file; `assets/grasps/catalogue.toml` is made so.

The best that a search finds is tried beside the scripted grasp in twenty full trials each; the better one is kept.
"""

import argparse
import multiprocessing
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from hashlib import sha256
from pathlib import Path

from tqdm import tqdm

from assets import asset_path
from scripts import _cli
from scripts._grasps import check_search
from scripts._objects import catalogue_names
from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.choice.grasp_file import GraspFile, KeptGrasp, load_grasps, write_grasps
from softhand_sim.grasp.choice.kept import kept_or_searched
from softhand_sim.grasp.choice.search import DEFAULT_BUDGET
from softhand_sim.grasp.choice.shipped import hand_sha256, shape_m
from softhand_sim.grasp.proof import TRIALS, ProvenGrasp, proven
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.catalogue import make_object

Chosen = Mapping[str, tuple[ProvenGrasp, float]]
MOST_TRIED = 24
"""Choice: grasps of all searches of an object that go through full trials."""
EXAMPLES = """examples:
  choose_grasps.py --objects all --workers 2 --out assets/grasps/catalogue.toml    # the shipped grasps
  choose_grasps.py --objects mug --search 2000 --seed 1 --out out/mug.toml         # then: grasp_benchmark.py --grasps
Searches that were done before come from the cache; a killed run goes on.
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default="all", help="of the catalogue, comma-separated; or 'all' (%(default)s)")
    text = "closings an object at most (default %(default)s)"
    p.add_argument("--search", type=_cli.positive_int, default=DEFAULT_BUDGET, metavar="N", help=text)
    text = "searches an object, each from a seed of its own; the best of all go through full trials (default 1)"
    p.add_argument("--searches", type=_cli.positive_int, default=1, metavar="N", help=text)
    text = "full trials an object for variations of the best grasps (default 0)"
    p.add_argument("--refine", type=_cli.non_negative_int, default=0, metavar="N", help=text)
    text = "grasps that go through the full trials, too, such as those that were chosen before"
    p.add_argument("--beside", type=Path, nargs="+", default=[], metavar="FILE", help=text)
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes side by side (default 1)")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    text = "file; grasps of other objects that it has stay in it (default %(default)s)"
    p.add_argument("--out", type=Path, default=Path("out/grasps.toml"), help=text)
    p.add_common(seed="seed of the searches", json="scores and closings of each object")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.out, "--out")
    _cli.check_writable(args.json)
    check_search(args.search)
    names = catalogue_names(args.objects)
    if args.objects == "all":
        names = sorted(names)
    calibration = args.calibration or asset_path("calibration", "finger.json")
    load_calibration(calibration)
    beside = [load_grasps(file).grasps for file in args.beside]
    choose = partial(_chosen, calibration=calibration, args=args, beside=beside)
    context = multiprocessing.get_context("spawn")
    chosen: dict[str, tuple[ProvenGrasp, float]] = {}
    before = _before(args, calibration)
    with ProcessPoolExecutor(args.workers, mp_context=context) as pool:
        jobs = {pool.submit(choose, name): name for name in names}
        for job in tqdm(as_completed(jobs), total=len(names), unit="object"):
            chosen[jobs[job]] = job.result()
            tqdm.write(_told(jobs[job], *job.result()))
            # a killed run leaves the objects that are done
            done = {name: chosen[name] for name in names if name in chosen}
            _write(args, before, _file(args, calibration, done), done)
    print(args.out)
    return 0


def _before(args: argparse.Namespace, calibration: Path) -> GraspFile | None:
    """Return what the file has; raise ValueError, before any search, if that is of another hand or finger."""
    if not args.out.exists():
        return None
    before = load_grasps(args.out)
    try:
        before.joined(_file(args, calibration, {}))
    except ValueError as error:
        raise ValueError(f"{args.out}: {error}; remove it, or give another --out") from error
    return before


def _told(name: str, grasp: ProvenGrasp, cpu_s: float) -> str:
    held = f"held of {TRIALS}: {grasp.found_held} found, {grasp.scripted_held} scripted"
    return f"{name:<20} closings {grasp.kept.closings}  trials {grasp.trials}  {cpu_s:.0f} s of processor  {held}"


def _file(args: argparse.Namespace, calibration: Path, chosen: Chosen) -> GraspFile:
    return GraspFile(
        grasps={name: grasp.kept for name, (grasp, _) in chosen.items()},
        hand_sha256=hand_sha256(HandAnatomy()),
        calibration_sha256=sha256(calibration.read_bytes()).hexdigest(),
        command=_command(args),
    )


def _write(args: argparse.Namespace, before: GraspFile | None, file: GraspFile, chosen: Chosen) -> None:
    """Write the grasps, beside those of other objects that the file had, and the figures."""
    write_grasps(args.out, file if before is None else before.joined(file))
    if args.json is not None:
        rows = {name: _row(*one) for name, one in chosen.items()}
        _cli.write_json(args.json, {"objects": rows, "seed": args.seed, "search": args.search, "trials": TRIALS})


def _command(args: argparse.Namespace) -> str:
    words = [f"--objects {args.objects}", f"--search {args.search}", f"--seed {args.seed}"]
    words += [f"--searches {args.searches}"] if args.searches > 1 else []
    words += [f"--refine {args.refine}"] if args.refine else []
    words += ["--beside FILE"] if args.beside else []
    return f"scripts/choose_grasps.py {' '.join(words)}"


def _row(grasp: ProvenGrasp, cpu_s: float) -> dict[str, float | int | None]:
    return {
        "score": grasp.kept.score,
        "closings": grasp.kept.closings,
        "found_held": grasp.found_held,
        "scripted_held": grasp.scripted_held,
        "trials": grasp.trials,
        "cpu_s": cpu_s,
    }


def _chosen(
    name: str, *, calibration: Path, args: argparse.Namespace, beside: Sequence[Mapping[str, KeptGrasp]]
) -> tuple[ProvenGrasp, float]:
    """Search one object's grasp and try it; return it, and the processor time (s); runs in a worker process."""
    started = time.process_time()
    model, finger, protocol = make_object(name), load_calibration(calibration), load_protocol()
    found = [
        one
        for seed in range(args.seed, args.seed + args.searches)
        for one in kept_or_searched(model, finger, protocol=protocol, budget=args.search, seed=seed)
    ]
    found = sorted(found, key=lambda one: -(one.score or 0.0))[:MOST_TRIED]
    found += [file[name] for file in beside if name in file]
    grasp = proven(found, model, finger, protocol, refine=args.refine, seed=args.seed)
    return replace(grasp, kept=replace(grasp.kept, shape_m=shape_m(model))), time.process_time() - started


if __name__ == "__main__":
    raise SystemExit(main())
