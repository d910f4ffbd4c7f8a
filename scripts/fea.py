"""Finite-element analyses: the actuator alone, the exoskeleton alone, the complete finger."""

import sys
from argparse import BooleanOptionalAction
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the folder of this script would hide the package ``fea`` behind the script itself
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from assets import asset_path
from fea.checkpoint import Checkpoints
from fea.density import DENSITIES
from fea.exoskeleton import LOADS_N
from fea.finger import PRESSURES_PA_GAUGE
from fea.geometry import FingerGeometry
from fea.inputs import check_loads, check_pressures
from fea.materials import VOLUMETRIC_READINGS, Material, load_material
from fea.newton import Status
from fea.path import Step, Sweep
from fea.results import write_results
from fea.study import FingerCase, Setup, Study, actuator_study, exoskeleton_study, finger_study
from fea.tip_wall import SENSOR_DISTANCE_M
from scripts import _cli

EXAMPLES = """examples:
  fea.py actuator --mesh coarse --pressures 10,20,30,40 --json out/actuator.json
  fea.py actuator --silicone ecoflex-00-50/set1 --volumetric d1_literal --no-rings --pressures 2,4,6
  fea.py actuator --dimension actuator_inner_radius_m=0.0032 --out out/thin   # VTU, pictures, checkpoint
  fea.py finger --mesh coarse --friction 0.3 --json out/finger.json --out out/finger    # up to 80 kPa and back
  fea.py finger --mesh coarse --blocked --no-unload --json out/blocked.json             # tip force at 40 mm
  fea.py finger --pressures 15,30,45 --tip-loads 0.05,0.1,0.2 --json out/tip_load.json  # loaded at 45 kPa
  fea.py finger --no-unload --gravity=-9.81,0 --json out/palm_up.json                   # level, its weight opens it
  fea.py exoskeleton --tpu ninjaflex/set2 --json out/exoskeleton.json --out out/exoskeleton
A killed run with --out goes on from its last converged step when the same command is given again.
"""
PATH_ENDED_EARLY = 1


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """One subcommand: how its loads are given, checked and swept, and how its results are drawn.

    ``targets`` gives the load path's parameters at which states are asked for, ``curve`` names a figure and its label;
    several analyses may share an option.
    """

    help: str
    option: str
    default: str
    unit: str
    scale: float
    loads_help: str
    check: Callable[[Sequence[float]], None]
    study: Callable[[Setup, Sequence[float], Sweep], Study]
    curve: tuple[str, str]
    targets: Callable[[Setup, Sequence[float]], list[float]] = lambda _, levels: list(levels)


ANALYSES = {
    "actuator": Analysis(
        help="actuator alone, base fixed, pressure on the chamber walls",
        option="--pressures",
        default="5,10,15,20,25,30,35,40,45,50,55,60",
        unit="kPa",
        scale=1e3,
        loads_help="increasing gauge pressures in kPa",
        check=check_pressures,
        study=actuator_study,
        curve=("axial_stretch", "axial stretch of the chamber"),
    ),
    "exoskeleton": Analysis(
        help="exoskeleton alone, clamped at its base, self-weight and a load at the distal joint",
        option="--loads",
        default=",".join(f"{load:g}" for load in LOADS_N),
        unit="N",
        scale=1.0,
        loads_help="increasing loads in N, on top of the self-weight, which is always there",
        check=check_loads,
        study=exoskeleton_study,
        curve=("tip_deflection_m", "tip deflection / m"),
        targets=lambda _, loads: [1.0, *(1.0 + load for load in loads)],  # 0 to 1 brings in the self-weight
    ),
    "finger": Analysis(
        help="complete finger: actuator inside exoskeleton with contact",
        option="--pressures",
        default=",".join(f"{1e-3 * pressure:g}" for pressure in PRESSURES_PA_GAUGE),
        unit="kPa",
        scale=1e3,
        loads_help="increasing gauge pressures in kPa",
        check=check_pressures,
        study=finger_study,
        targets=lambda setup, pressures: setup.finger.path(pressures).targets,
        curve=("tip_angle_deg", "tip angle / degrees"),
    ),
}
"""A further analysis is one entry here and one study function."""


def numbers(text: str) -> list[float]:
    """Parse numbers separated by commas (argparse type)."""
    return [float(part) for part in text.split(",")]


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("analysis", choices=sorted(ANALYSES), help="; ".join(f"{k}: {a.help}" for k, a in ANALYSES.items()))
    for option in _options():
        users = [(name, a) for name, a in ANALYSES.items() if a.option == option]
        text = "; ".join(f"{name}: {a.loads_help} ({a.default})" for name, a in users)
        p.add_argument(option, type=numbers, help=text)
    p.add_argument("--silicone", default="ecoflex-00-50/set3", help="sheet/set, or FILE.toml/set (%(default)s)")
    p.add_argument("--tpu", default="ninjaflex/set3", help="sheet/set of the exoskeleton (%(default)s)")
    p.add_argument("--thread", default="pet/paper", help="sheet/set of the rings, linear elastic (%(default)s)")
    p.add_argument("--friction", type=float, help=f"finger: Coulomb's coefficient ({FingerCase().friction:g})")
    p.add_argument("--unload", action=BooleanOptionalAction, help="finger: back to zero pressure (yes)")
    p.add_argument(
        "--blocked",
        nargs="?",
        type=_cli.positive_float,
        const=1e3 * SENSOR_DISTANCE_M,
        metavar="MM",
        help="finger: a force sensor in front of the tip (%(const)g mm)",
    )
    p.add_argument(
        "--no-separation", action="store_true", help="finger: the actuator does not leave the tube's sections"
    )
    p.add_argument(
        "--tip-loads",
        type=numbers,
        metavar="N,N",
        help="finger: loads on the tip at the last pressure, in newtons",
    )
    p.add_argument(
        "--gravity",
        type=numbers,
        metavar="X,Z",
        help="finger: its own weight, gravity in m/s2 towards the palm side and along the finger to its tip (none)",
    )
    p.add_argument(
        "--volumetric", choices=VOLUMETRIC_READINGS, help="reading of the volumetric term (default: the sheet's own)"
    )
    p.add_argument("--mesh", choices=list(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    p.add_argument(
        "--rings", action=BooleanOptionalAction, default=True, help="reinforcement rings in the actuator (yes)"
    )
    _cli.add_dimension(p)
    p.add_common(seed="taken for uniformity; nothing is random", json="write the figures here")
    p.add_argument("--out", type=Path, help="folder of checkpoint, VTU fields and pictures")
    p.add_argument("--pictures", action=BooleanOptionalAction, default=True, help="draw into --out (yes)")
    return p


def _options() -> list[str]:
    return list(dict.fromkeys(analysis.option for analysis in ANALYSES.values()))


def job(argv: Sequence[str] | None = None) -> int:
    """Run one analysis; return the exit status."""
    args = parser().parse_args(argv)
    analysis = ANALYSES[args.analysis]
    levels = _levels(args, analysis)
    setup = _setup(args)
    _cli.check_writable(args.json)
    _cli.check_writable(None if args.out is None else args.out / "curve.png", "--out")
    pictures = args.out is not None and args.pictures
    if pictures and find_spec("matplotlib") is None:
        raise ValueError("--pictures: matplotlib is missing (pip install 'softhand-sim[plots]', or --no-pictures)")
    study = _run(args, analysis, setup, levels)
    if args.json is not None:
        more = {"analysis": args.analysis, "provenance": setup.provenance()}
        _cli.write_json(args.json, study.figures | more)
    if args.out is not None:
        write_results(args.out, study, unit=analysis.unit, scale=analysis.scale, curve=analysis.curve, draw=pictures)
    _print(study, analysis)
    if study.status is not Status.CONVERGED:
        last = study.levels[-1] / analysis.scale
        print(f"{study.status.value}: no equilibrium found above {last:g} {analysis.unit}", file=sys.stderr)
        return PATH_ENDED_EARLY
    return 0


def _levels(args: Any, analysis: Analysis) -> list[float]:
    for option in _options():
        if option != analysis.option and getattr(args, option.strip("-")) is not None:
            raise ValueError(f"{option}: not an option of {args.analysis}")
    given = getattr(args, analysis.option.strip("-"))
    levels = [analysis.scale * v for v in (numbers(analysis.default) if given is None else given)]
    analysis.check(levels)
    return levels


def _setup(args: Any) -> Setup:
    return Setup(
        geometry=_cli.with_dimensions(FingerGeometry(), args.dimension),
        silicone=_material("--silicone", args.silicone, args.volumetric if args.analysis != "exoskeleton" else None),
        tpu=_material("--tpu", args.tpu, args.volumetric if args.analysis == "exoskeleton" else None),
        pet=_material("--thread", args.thread, None),
        density=DENSITIES[args.mesh],
        rings=args.rings,
        finger=_finger_case(args),
    )


def _finger_case(args: Any) -> FingerCase:
    given = {
        "friction": args.friction,
        "unload": False if args.unload is None and args.tip_loads else args.unload,
        "tip_loads_n": None if args.tip_loads is None else tuple(args.tip_loads),
        "sensor_distance_m": None if args.blocked is None else 1e-3 * args.blocked,
        "no_separation": args.no_separation or None,
        "gravity_m_per_s2": None if args.gravity is None else tuple(args.gravity),
    }
    given = {name: value for name, value in given.items() if value is not None}
    if given and args.analysis != "finger":
        raise ValueError(
            "--friction, --unload, --blocked, --no-separation, --tip-loads and --gravity are not options of "
            f"{args.analysis}"
        )
    return FingerCase(**given)


def _material(option: str, text: str, volumetric: str | None) -> Material:
    sheet, _, chosen = text.rpartition("/")
    if not sheet:
        sheet, chosen = chosen, ""
    if not sheet.endswith(".toml"):
        shipped = sorted(file.stem.replace("_", "-") for file in asset_path("materials").glob("*.toml"))
        if sheet.replace("_", "-") not in shipped:
            raise ValueError(f"{option} {text}: no material {sheet!r}; shipped: {', '.join(shipped)}")
        sheet = sheet.replace("-", "_")
    try:
        return load_material(sheet, chosen or None, volumetric)
    except ValueError as error:
        raise ValueError(f"{option} {text}: {error}") from None


def _run(args: Any, analysis: Analysis, setup: Setup, levels: list[float]) -> Study:
    checkpoints, resume = None, []
    if args.out is not None:
        checkpoints = Checkpoints(args.out / "checkpoint", setup.identity(args.analysis, levels))
        resume = checkpoints.load()
    targets = analysis.targets(setup, levels)
    with tqdm(total=len(targets), desc=args.analysis, unit="level") as bar:

        def on_iteration(parameter: float, iteration: int, residual: float) -> None:
            bar.set_postfix_str(f"path at {parameter:g}, iteration {iteration}, residual {residual:.1e}")

        def count(step: Step) -> None:
            bar.update(int(step.parameter in targets))

        def on_step(step: Step) -> None:
            if checkpoints is not None:
                checkpoints.save(step)
            count(step)

        for step in resume:
            count(step)
        if resume:
            bar.write(f"resumed after {len(resume)} steps", file=sys.stderr)
        return analysis.study(setup, levels, Sweep(on_iteration=on_iteration, on_step=on_step, resume=resume))


def _print(study: Study, analysis: Analysis) -> None:
    key, label = analysis.curve
    print(f"{analysis.unit:>8}  {label}")
    for value, measured in zip(study.levels, study.figures[key], strict=True):
        print(f"{value / analysis.scale:>8g}  {measured:.6g}")
    f = study.figures
    print(
        f"{f['dofs']} dofs, {f['newton_iterations']} iterations, {f['wall_s']:.1f} s "
        f"(assembly {f['assembly_s']:.1f}, solve {f['solve_s']:.1f}, contact {f['contact_s']:.1f})"
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
