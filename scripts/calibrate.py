"""Calibrate a finger: dimensions and material sheets in, a calibration file (and the hand of that finger) out."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np

from assets import asset_path
from fea.calibration import TARGET_PRESSURE_PA_GAUGE, load_materials
from fea.density import DENSITIES
from fea.finger_design import FingerDesign, load_design
from fea.geometry import FingerGeometry
from fea.solved import solve_finger
from scripts import _cli, _solving
from scripts.build_hand import hand_files

EXAMPLES = """examples:
  python scripts/calibrate.py                                   # the shipped calibration, a few minutes
  python scripts/calibrate.py --density coarse --out out/f.json --json out/calibrate.json
  python scripts/calibrate.py --finger my_finger.toml --out out/my_finger.json --hand out/my_hand
  python scripts/calibrate.py --finger assets/fingers/default.toml --dimension tube_wall_m=0.0025 --out out/f.json
  python scripts/calibrate.py --materials set2 set3 --out out/stiffer.json
  python scripts/calibrate.py --choose-sector --out out/f.json  # find the palm sector that gives 95 degrees at 75 kPa
A finger that was solved before, by the same code, comes from the store.
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--finger", type=Path, metavar="TOML", help="dimensions and materials (see assets/fingers)")
    p.add_argument("--density", choices=sorted(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    _cli.add_materials(p)
    p.set_defaults(materials=None)
    _cli.add_dimension(p)
    p.add_argument("--choose-sector", action="store_true", help="find the palm sector that gives 95 degrees at 75 kPa")
    _solving.add_store(p)
    p.add_argument("--out", type=Path, help="calibration file (assets/calibration/finger.json; needed with --finger)")
    p.add_argument(
        "--hand", type=Path, metavar="FOLDER", help="write the hand of this finger here, as build_hand.py does"
    )
    p.add_common(
        seed="taken for uniformity; nothing is random", json="write the three analyses and the fit errors here"
    )
    return p


def job(argv: Sequence[str] | None = None, analyses: _solving.Analyses = solve_finger) -> int:
    """Run the calibration; return the exit status."""
    args = parser().parse_args(argv)
    if args.finger is not None and args.out is None:
        raise ValueError("--out: needed with --finger, or the shipped calibration would be replaced")
    out = args.out if args.out is not None else asset_path("calibration") / "finger.json"
    _cli.check_writable(args.json)
    _cli.check_writable(out, "--out")
    if args.hand is not None:
        _cli.check_writable(args.hand / "hand.xml", "--hand")
    design = _design(args)
    solve = _solving.solver(args, analyses)
    solved, stored = solve(design, DENSITIES[args.density], choose=args.choose_sector)
    calibration = _solving.checked(solved.artifact)
    _cli.write_json(out, dict(solved.artifact))
    if args.json is not None:
        _cli.write_json(args.json, {**solved.report, "from_store": stored})
    _say(solved.report, out, stored=stored)
    if args.hand is not None:
        for path, text in hand_files(calibration, args.hand).items():
            _cli.write_text(path, text)
    return 0


def _design(args: Any) -> FingerDesign:
    if args.finger is None:
        design = FingerDesign(geometry=FingerGeometry(), materials=load_materials(*(args.materials or ())))
    elif args.materials is not None:
        raise ValueError("--materials, --finger: give one of them; a finger's file names its materials")
    else:
        design = load_design(args.finger)
    geometry = _cli.with_dimensions(design.geometry, args.dimension)
    return FingerDesign(geometry=geometry, materials=design.materials)


def _say(report: Any, out: Path, *, stored: bool) -> None:
    angle, sector = report["tip_angle_deg_at_75_kpa"], np.rad2deg(report["sector_half_angle_rad"])
    ended = f"{report['finger_status']} at {1e-3 * max(report['finger_pressure_pa_gauge']):g} kPa"
    at_75 = f"no state ({ended})" if angle is None else f"{angle:.1f} degrees"
    text = f"{at_75} at {1e-3 * TARGET_PRESSURE_PA_GAUGE:g} kPa with a palm sector of +-{sector:.1f} degrees"
    print(f"{out}: {text}{', from the store' if stored else ''}")


def main(argv: list[str] | None = None, analyses: _solving.Analyses = solve_finger) -> int:
    """Entry point."""
    return _cli.run(lambda given: job(given, analyses), argv)


if __name__ == "__main__":
    sys.exit(main())
