"""Chooses the grasps of catalogue objects and writes them to a file; `assets/grasps/catalogue.toml` is made so.

The best that a search finds is tried beside the scripted grasp in twenty full trials each; the better one is kept.
"""

import argparse
import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
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
from softhand_sim.grasp.choice.grasp_file import GraspFile, write_grasps
from softhand_sim.grasp.choice.kept import kept_or_searched
from softhand_sim.grasp.choice.search import DEFAULT_BUDGET
from softhand_sim.grasp.choice.shipped import hand_sha256, shape_m
from softhand_sim.grasp.proof import TRIALS, ProvenGrasp, proven
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.catalogue import make_object

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
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes side by side (default 1)")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_argument("--out", type=Path, default=Path("out/grasps.toml"), help="file (default %(default)s)")
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
    choose = partial(_chosen, calibration=calibration, budget=args.search, seed=args.seed)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(args.workers, mp_context=context) as pool:
        grasps = dict(zip(names, tqdm(pool.map(choose, names), total=len(names), unit="object"), strict=True))
    file = GraspFile(
        grasps={name: grasp.kept for name, grasp in grasps.items()},
        hand_sha256=hand_sha256(HandAnatomy()),
        calibration_sha256=sha256(calibration.read_bytes()).hexdigest(),
        command=_command(args),
    )
    write_grasps(args.out, file)
    for name, grasp in grasps.items():
        held = f"held of {TRIALS}: {grasp.found_held} found, {grasp.scripted_held} scripted"
        print(f"{name:<20} closings {grasp.kept.closings}  {held}")
    print(args.out)
    if args.json is not None:
        rows = {name: _row(grasp) for name, grasp in grasps.items()}
        _cli.write_json(args.json, {"objects": rows, "seed": args.seed, "search": args.search, "trials": TRIALS})
    return 0


def _command(args: argparse.Namespace) -> str:
    return f"scripts/choose_grasps.py --objects {args.objects} --search {args.search} --seed {args.seed}"


def _row(grasp: ProvenGrasp) -> dict[str, float | int | None]:
    return {
        "score": grasp.kept.score,
        "closings": grasp.kept.closings,
        "found_held": grasp.found_held,
        "scripted_held": grasp.scripted_held,
    }


def _chosen(name: str, *, calibration: Path, budget: int, seed: int) -> ProvenGrasp:
    """Search one object's grasp and try it; runs in a worker process."""
    model, finger, protocol = make_object(name), load_calibration(calibration), load_protocol()
    found = kept_or_searched(model, finger, protocol=protocol, budget=budget, seed=seed)
    grasp = proven(found, model, finger, protocol)
    return replace(grasp, kept=replace(grasp.kept, shape_m=shape_m(model)))


if __name__ == "__main__":
    raise SystemExit(main())
