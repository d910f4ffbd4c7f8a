"""Press a rigid sphere into the palm side of two phalanges in finite elements and write the curves to a file."""

import sys
from collections.abc import Sequence
from pathlib import Path

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from assets import asset_path
from fea.calibration import load_materials
from fea.geometry import FingerGeometry
from fea.pad import DEPTHS_M, SECTIONS, PadMesh, press
from fea.pad_evidence import pad_evidence
from scripts import _cli

EXAMPLES = """examples:
  finger_pad.py                                        # the shipped file, about two minutes
  finger_pad.py --dimension tube_wall_m=0.0025 --out out/pad.json
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    _cli.add_materials(p)
    _cli.add_dimension(p)
    p.add_argument("--out", type=Path, help="file of the curves (assets/calibration/finger_pad_evidence.json)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the curves here as well")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run both sections; return the exit status."""
    args = parser().parse_args(argv)
    out = args.out if args.out is not None else asset_path("calibration") / "finger_pad_evidence.json"
    _cli.check_writable(args.json)
    _cli.check_writable(out, "--out")
    geometry, materials = _cli.with_dimensions(FingerGeometry(), args.dimension), load_materials(*args.materials)
    mesh, results = PadMesh(), {}
    with tqdm(total=len(SECTIONS) * len(DEPTHS_M), desc="pads", unit="depth") as bar:
        for section in SECTIONS:
            results[section] = press(geometry, materials, section, mesh=mesh, progress=lambda: bar.update(1))
    contents = pad_evidence(geometry, materials, mesh, results)
    _cli.write_json(out, contents)
    if args.json is not None:
        _cli.write_json(args.json, contents)
    for section, result in results.items():
        print(f"{section}: {result.force_n[-1]:.3g} N at {1e3 * result.depth_m[-1]:g} mm, {result.dofs} dofs")
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
