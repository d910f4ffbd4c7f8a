"""Run the finite-element finger on bench tests and write ``assets/calibration/finger_evidence.json``."""

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from assets import asset_path
from fea.calibration import load_materials
from fea.density import DENSITIES
from fea.evidence import RUNS, check_run, evidence
from fea.geometry import FingerGeometry
from fea.newton import Status
from fea.path import Step, Sweep
from fea.study import Setup, finger_study
from scripts import _cli

EXAMPLES = """examples:
  finger_evidence.py                                   # the shipped evidence, about 40 minutes on one core
  finger_evidence.py --density coarse --out out/evidence.json --runs out/evidence
A killed run goes on after its last finished test when the same command is given again; --any-code also takes tests that
an earlier version of the code has run. Each file in --runs is what `fea.py finger --json` writes.
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--density", choices=sorted(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    _cli.add_materials(p)
    _cli.add_dimension(p)
    p.add_argument("--runs", type=Path, default=Path("out/evidence"), help="folder of finished tests (%(default)s)")
    p.add_argument("--any-code", action="store_true", help="take finished tests of another version of the code")
    p.add_argument("--out", type=Path, help="evidence file (assets/calibration/finger_evidence.json)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write what each test cost here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run the tests that are missing and put all together; return the exit status."""
    args = parser().parse_args(argv)
    out = args.out if args.out is not None else asset_path("calibration") / "finger_evidence.json"
    for path in (args.json, out, *(args.runs / f"{name}.json" for name in RUNS)):
        _cli.check_writable(path)
    materials = load_materials(*args.materials)
    setup = Setup(
        geometry=_cli.with_dimensions(FingerGeometry(), args.dimension),
        silicone=materials.silicone,
        tpu=materials.tpu,
        pet=materials.pet,
        density=DENSITIES[args.density],
    )
    done = {name: _finished(args.runs / f"{name}.json", name, setup, any_code=args.any_code) for name in RUNS}
    for name in [name for name, figures in done.items() if figures is None]:
        fresh = _run(name, _of(name, setup))
        _cli.write_json(args.runs / f"{name}.json", fresh)
        done[name] = fresh
    figures = {name: run for name, run in done.items() if run is not None}
    contents = evidence(figures)
    _cli.write_json(out, contents)
    if args.json is not None:
        _cli.write_json(args.json, contents["provenance"]["runs"])
    print(f"{out}: " + ", ".join(f"{name} {run['wall_s']:.0f} s" for name, run in figures.items()))
    return 0


def _of(name: str, setup: Setup) -> Setup:
    return replace(setup, finger=RUNS[name].case)


def _finished(path: Path, name: str, setup: Setup, *, any_code: bool) -> dict[str, Any] | None:
    """Return a finished test's figures, None if there are none or they are of something else."""
    if not path.is_file():
        return None
    try:
        figures: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        check_run(name, figures, _of(name, setup), any_code=any_code)
    except ValueError as error:
        print(f"{path}: run again: {error}", file=sys.stderr)
        return None
    return figures


def _run(name: str, setup: Setup) -> dict[str, Any]:
    pressures = RUNS[name].pressures_pa_gauge
    targets = setup.finger.path(pressures).targets
    with tqdm(total=len(targets), desc=name, unit="level") as bar:

        def on_step(step: Step) -> None:
            bar.update(int(step.parameter in targets))

        study = finger_study(setup, pressures, Sweep(on_step=on_step))
    if study.status is not Status.CONVERGED:
        raise ValueError(f"{name}: {study.status.value} above {study.levels[-1]:g} Pa; no evidence is written")
    return study.figures | {"analysis": "finger", "provenance": setup.provenance()}


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
