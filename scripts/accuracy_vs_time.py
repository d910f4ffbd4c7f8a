"""What accuracy costs in time: ladders of the finger and of the scene, cost growth; tables, plots, the front's file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from assets import asset_path
from scripts import (
    _accuracy_finger,
    _accuracy_growth,
    _accuracy_honour,
    _accuracy_page,
    _accuracy_pictures,
    _accuracy_scene,
    _cli,
)
from scripts._tolerance import parse_tolerance
from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.fidelity.fidelity import load_front, shipped_front

EXAMPLES = """examples:
  accuracy_vs_time.py --json out/accuracy.json           # all parts; the finite elements' runs are data
  accuracy_vs_time.py scene --front assets/accuracy/front.json
  accuracy_vs_time.py --docs docs --front assets/accuracy/front.json   # the shipped page, plots and front
  accuracy_vs_time.py scene --points "1 ms" "4 ms" --scenes 4 --front-scenes 4 --json out/two.json
"""
PARTS = ("finger", "scene", "growth", "honour")
PAGE = "accuracy.md"
TOLERANCES = "1,0.5 2,1 3,1 4,2 6,2"


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("part", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)} (all)")
    text = "scenes of the settings that a tolerance chooses among (%(default)s); 59 are the fewest that show anything"
    p.add_argument("--front-scenes", type=_cli.positive_int, default=208, help=text)
    p.add_argument("--scenes", type=_cli.positive_int, default=24, help="scenes of other settings (%(default)s)")
    text = "scenes of shapes, links and effects (%(default)s)"
    p.add_argument("--more-scenes", type=_cli.positive_int, default=8, help=text)
    p.add_argument("--points", nargs="+", metavar="NAME", help="points of the scene's ladder (all)")
    text = "scenes that the front was not built from (%(default)s)"
    p.add_argument("--unseen-scenes", type=_cli.positive_int, default=100, help=text)
    text = f"degrees and mm, those of the choice on unseen scenes ({TOLERANCES})"
    p.add_argument("--tolerances", type=parse_tolerance, nargs="+", metavar="DEG,MM", help=text)
    p.add_argument("--repeats", type=_cli.positive_int, default=3, help="of each timed run (%(default)s)")
    p.add_argument("--fea", type=Path, help="runs of accuracy_fea.py (assets/accuracy/finger_fea.json)")
    p.add_argument("--front", type=Path, metavar="FILE", help="write the scene's points to this file as well")
    text = f"folder of {PAGE}: its tables and pictures are brought up to date"
    p.add_argument("--docs", type=Path, metavar="DIR", help=text)
    p.add_argument("--out", type=Path, default=Path("out/accuracy"), help="folder of runs and plots (%(default)s)")
    p.add_common(seed="of the drawn scenes", json="write all tables to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    parts = args.part or PARTS
    for part in parts:
        if part not in PARTS:
            raise ValueError(f"{part}: no such part; there are {', '.join(PARTS)}")
    for path in (args.json, args.front, args.out / "candidates.json"):
        _cli.check_writable(path)
    groups = _groups(args.points)
    fea = args.fea or asset_path("accuracy") / "finger_fea.json"
    calibration, data = load_calibration(), dict[str, Any]()
    if "finger" in parts:
        with tqdm(total=4 + len(_accuracy_finger.LINKS), desc="finger", unit="rung") as bar:
            data["finger"] = _accuracy_finger.table(calibration, fea, args.repeats, lambda: _tick(bar))
    if "scene" in parts:
        found = _scene(args, calibration, groups)
        data["scene"] = _accuracy_scene.front(found, args.seed)
        if args.front is not None:
            _cli.write_json(args.front, data["scene"])
    if "growth" in parts:
        with tqdm(total=3, desc="growth", unit="law") as bar:
            data["growth"] = _accuracy_growth.growth(calibration, fea, 3 * args.repeats, lambda: _tick(bar))
    if "honour" in parts:
        data["honour"] = _honour(args, calibration)
    _write(args.out, data, args.docs)
    if args.json is not None:
        _cli.write_json(args.json, data)
    return 0


def _honour(args: Any, calibration: FingerCalibration) -> list[dict[str, Any]]:
    """Try the choice by tolerance on unseen scenes: that of ``--front``, else of the shipped one."""
    front = shipped_front() if args.front is None else load_front(args.front)
    tolerances = args.tolerances or [parse_tolerance(text) for text in TOLERANCES.split()]
    kept = args.out / f"unseen-{args.seed}.json"
    with tqdm(total=args.unseen_scenes, desc="unseen scenes", unit="scene") as bar:
        return _accuracy_honour.honour(
            calibration, front, tolerances, args.unseen_scenes, args.seed, kept, lambda: _tick(bar)
        )


def _tick(bar: Any) -> None:
    bar.update()


def _write(folder: Path, data: dict[str, Any], docs: Path | None) -> None:
    """Print the tables, and write them and the plots to a folder; bring the page and its pictures up to date."""
    tables: dict[str, str] = {}
    pictures = [folder] if docs is None else [folder, docs]
    if "finger" in data:
        tables["finger"] = _accuracy_page.finger(data["finger"])
        for place in pictures:
            _accuracy_pictures.draw_finger(data["finger"], place / "accuracy.png")
    if "scene" in data:
        tables["scene"] = _accuracy_page.scene(data["scene"]["points"])
        for place in pictures:
            _accuracy_pictures.draw_scene(data["scene"]["points"], place / "accuracy-scene.png")
    if "growth" in data:
        tables["growth"] = _accuracy_page.growth(data["growth"])
    if "honour" in data:
        tables["honour"] = _accuracy_page.honour(data["honour"])
    text = "\n\n".join(tables.values()) + "\n"
    _cli.write_text(folder / "tables.md", text)
    if docs is not None:
        page = docs / PAGE
        _cli.write_text(page, _accuracy_page.with_tables(page.read_text(encoding="utf-8"), tables))
    print(text)


def _groups(names: Sequence[str] | None) -> dict[str, tuple[str, ...]]:
    """Return the points asked for by group; without names all of them."""
    every = {name for members in _accuracy_scene.GROUPS.values() for name in members}
    unknown = [name for name in names or () if name not in every]
    if unknown:
        raise ValueError(f"--points {unknown[0]!r}: must be one of {', '.join(sorted(every))}")
    wanted = every if names is None else set(names)
    chosen = {k: tuple(n for n in members if n in wanted) for k, members in _accuracy_scene.GROUPS.items()}
    return {group: members for group, members in chosen.items() if members}


def _scene(args: Any, calibration: FingerCalibration, groups: Mapping[str, tuple[str, ...]]) -> list[dict[str, Any]]:
    found = []
    for group, names in groups.items():
        scenes = {"candidates": args.front_scenes, "numerics": args.scenes}.get(group, args.more_scenes)
        seed = args.seed + (_accuracy_scene.FRONT_SEED if group == "candidates" else 0)
        # a choice of points has a file of its own: it is no part of the whole run's
        mark = "" if names == _accuracy_scene.GROUPS[group] else f"-{len(names)}-points"
        kept = args.out / f"{group}{mark}-{seed}.json"
        with tqdm(total=scenes, desc=group, unit="scene") as bar:
            rows = _accuracy_scene.measure(calibration, names, scenes, seed, kept, lambda: _tick(bar))
        found += _accuracy_scene.points(rows, names)
    return found


if __name__ == "__main__":
    raise SystemExit(main())
