"""Write assets/hand/hand.xml and scene.xml from the finger calibration and the anatomy."""

from collections.abc import Sequence
from pathlib import Path

from assets import asset_path
from scripts import _cli
from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.hand.export import hand_xml, scene_xml

EXAMPLES = """examples:
  build_hand.py                                             # rewrite the shipped files
  build_hand.py --calibration my_finger.json --out my_hand  # a hand of your own finger
  build_hand.py --check                                     # non-zero if the shipped files are not up to date
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_argument("--out", type=Path, help="folder (default: assets/hand)")
    p.add_argument("--check", action="store_true", help="write nothing; compare")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the names of the files to this file")
    return p


def hand_files(calibration: FingerCalibration, folder: Path) -> dict[Path, str]:
    """Return the texts of a hand's files by their paths in a folder."""
    return {folder / "hand.xml": hand_xml(calibration), folder / "scene.xml": scene_xml(calibration)}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    calibration = load_calibration(args.calibration)
    folder = args.out or asset_path("hand")
    files = hand_files(calibration, folder)
    stale = [path for path, text in files.items() if not path.is_file() or path.read_text(encoding="utf-8") != text]
    if args.check:
        if stale:
            raise ValueError(f"not up to date: {', '.join(str(path) for path in stale)}; run scripts/build_hand.py")
    else:
        for path, text in files.items():
            _cli.write_text(path, text)
    if args.json is not None:
        _cli.write_json(args.json, {"files": [str(path) for path in files]})
    print(" ".join(str(path) for path in files))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
