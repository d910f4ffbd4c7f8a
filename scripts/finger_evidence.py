"""Run the finite-element finger on bench tests, or under its own weight, and write the evidence to a file."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from assets import asset_path
from fea.calibration import load_materials
from fea.density import DENSITIES
from fea.evidence import RUNS, Run, check_run, evidence
from fea.geometry import FingerGeometry
from fea.newton import Status
from fea.path import Step, Sweep
from fea.study import Setup, finger_study
from fea.weight_evidence import WEIGHT_RUNS, weight_evidence
from scripts import _cli


@dataclass(frozen=True, kw_only=True)
class Kind:
    """Runs that become one file: their names, how they are put together, and the shipped file's name."""

    runs: dict[str, Run]
    contents: Callable[[dict[str, dict[str, Any]]], dict[str, Any]]
    file: str


KINDS = {
    "bench": Kind(runs=RUNS, contents=evidence, file="finger_evidence.json"),
    "weight": Kind(runs=WEIGHT_RUNS, contents=weight_evidence, file="finger_weight_evidence.json"),
}
EXAMPLES = """examples:
  finger_evidence.py                                   # the shipped evidence, about 40 minutes on one core
  finger_evidence.py weight                            # that of the finger's weight, about 20 minutes
  finger_evidence.py --density coarse --out out/evidence.json --runs out/evidence
A killed run goes on after its last finished test when the same command is given again; --any-code also takes tests that
an earlier version of the code has run. Each file in --runs is what `fea.py finger --json` writes.
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("kind", nargs="?", choices=sorted(KINDS), default="bench", help="which runs (%(default)s)")
    p.add_argument("--density", choices=sorted(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    _cli.add_materials(p)
    _cli.add_dimension(p)
    p.add_argument("--runs", type=Path, default=Path("out/evidence"), help="folder of finished tests (%(default)s)")
    p.add_argument("--any-code", action="store_true", help="take finished tests of another version of the code")
    p.add_argument("--out", type=Path, help="evidence file (the shipped one in assets/calibration)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write what each test cost here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run the tests that are missing and put all together; return the exit status."""
    args = parser().parse_args(argv)
    kind = KINDS[args.kind]
    out = args.out if args.out is not None else asset_path("calibration") / kind.file
    files = {name: args.runs / f"{name.replace(' ', '_')}.json" for name in kind.runs}
    for path in (args.json, out, *files.values()):
        _cli.check_writable(path)
    materials = load_materials(*args.materials)
    setup = Setup(
        geometry=_cli.with_dimensions(FingerGeometry(), args.dimension),
        silicone=materials.silicone,
        tpu=materials.tpu,
        pet=materials.pet,
        density=DENSITIES[args.density],
    )
    figures: dict[str, dict[str, Any]] = {}
    for name, run in kind.runs.items():
        found = _finished(files[name], name, run, setup, any_code=args.any_code)
        if found is None:
            found = _run(name, run, setup)
            _cli.write_json(files[name], found)
        figures[name] = found
    contents = kind.contents(figures)
    _cli.write_json(out, contents)
    if args.json is not None:
        _cli.write_json(args.json, contents["provenance"]["runs"])
    print(f"{out}: " + ", ".join(f"{name} {run['wall_s']:.0f} s" for name, run in figures.items()))
    return 0


def _finished(path: Path, name: str, run: Run, setup: Setup, *, any_code: bool) -> dict[str, Any] | None:
    """Return a finished test's figures, None if there are none or they are of something else."""
    if not path.is_file():
        return None
    try:
        figures: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        check_run(name, run, figures, setup, any_code=any_code)
    except ValueError as error:
        print(f"{path}: run again: {error}", file=sys.stderr)
        return None
    return figures


def _run(name: str, run: Run, setup: Setup) -> dict[str, Any]:
    setup = replace(setup, finger=run.case)
    targets = run.case.path(run.pressures_pa_gauge).targets
    with tqdm(total=len(targets), desc=name, unit="level") as bar:

        def on_step(step: Step) -> None:
            bar.update(int(step.parameter in targets))

        study = finger_study(setup, run.pressures_pa_gauge, Sweep(on_step=on_step))
    if study.status is not Status.CONVERGED:
        raise ValueError(f"{name}: {study.status.value} above {study.levels[-1]:g} Pa; no evidence is written")
    return study.figures | {"analysis": "finger", "provenance": setup.provenance()}


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
