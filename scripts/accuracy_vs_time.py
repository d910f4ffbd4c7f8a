"""What accuracy costs in time: the finger's ladder, the scene's ladder, cost growth; tables, plots, and the front's file."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from scripts import _accuracy_scene, _cli
from softhand_sim.calibration import load_calibration

EXAMPLES = """examples:
  accuracy_vs_time.py                                    # all parts but the finite elements, about 30 minutes
  accuracy_vs_time.py scene --scenes 40 --front assets/accuracy/front.json
  accuracy_vs_time.py scene --points "1 ms" "4 ms" --scenes 4 --json out/two.json
"""
PARTS = ("scene",)


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("part", nargs="*", choices=PARTS, help="which parts (all)")
    p.add_argument("--scenes", type=_cli.positive_int, default=40, help="scenes of the scene's ladder (%(default)s)")
    p.add_argument("--points", nargs="+", metavar="NAME", help="points of the scene's ladder (all)")
    p.add_argument("--front", type=Path, metavar="FILE", help="write the scene's points to this file as well")
    p.add_argument("--out", type=Path, default=Path("out/accuracy"), help="folder of plots and runs (%(default)s)")
    p.add_common(seed="of the drawn scenes", json="write all tables to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    parts = args.part or PARTS
    for path in (args.json, args.front, args.out / "scene.json"):
        _cli.check_writable(path)
    names = tuple(args.points or _accuracy_scene.point_names())
    unknown = [name for name in names if name not in _accuracy_scene.point_names()]
    if unknown:
        raise ValueError(f"--points {unknown[0]!r}: must be one of {', '.join(_accuracy_scene.point_names())}")
    data: dict[str, Any] = {}
    if "scene" in parts:
        data["scene"] = _scene(args, names)
        if args.front is not None:
            _cli.write_json(args.front, data["scene"])
    if args.json is not None:
        _cli.write_json(args.json, data)
    return 0


def _scene(args: Any, names: Sequence[str]) -> dict[str, Any]:
    with tqdm(total=args.scenes, desc="scenes", unit="scene") as bar:
        rows = _accuracy_scene.measure(
            load_calibration(), names, args.scenes, args.seed, args.out / "scene.json", lambda: bar.update(1) or None
        )
    return _accuracy_scene.front(rows, names, {"seed": args.seed})


if __name__ == "__main__":
    raise SystemExit(main())
