"""Tables of analysis (iii), the complete finger: convergence, sensitivity, material pairs, surrogate; Markdown."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from assets import asset_path
from fea.checkpoint import code_version
from fea.contact import ContactOptions
from fea.finger import FORMULATIONS, FRICTION, MESHES, PRESSURES_PA_GAUGE
from fea.geometry import FingerGeometry
from fea.materials import VOLUMETRIC_READINGS
from scripts import _cli, _finger_markdown
from scripts._finger_runs import DIED, INVALID, Case, execute

EXAMPLES = """examples:
  python scripts/finger_table.py convergence --json out/convergence.json
  python scripts/finger_table.py convergence --meshes coarse --formulations P1 --to 5      # a first look
  python scripts/finger_table.py sensitivity --json out/sensitivity.json                   # +-5 %
  python scripts/finger_table.py sensitivity --by-mm 0.1 --only tube_wall_m gap_length_m   # printing tolerance
  python scripts/finger_table.py materials --meshes calibration --json out/materials.json
  python scripts/finger_table.py surrogate --dimension flexure_thickness_m=0.003
Each run has a process of its own. With --json every finished run is kept, and the same command goes on from there.
"""
SETS = ("set1", "set2", "set3")
GAP_STARTS = "gap_start_m"
_PRESSURES_PA = (15e3, 30e3, 45e3, 60e3, 75e3)


@dataclass(frozen=True, kw_only=True)
class Table:
    """One subcommand: its cases with labels for the runs, how it is printed, and the options that are its alone."""

    help: str
    to_kpa: float
    cases: Callable[[Any, list[float]], list[tuple[dict[str, Any], Case | None]]]
    markdown: Callable[[list[dict[str, Any]], list[float]], str]
    pressures_pa: tuple[float, ...] = _PRESSURES_PA
    options: tuple[str, ...] = ()


def _base(args: Any, pressures: list[float]) -> Case:
    return Case(
        geometry=_cli.with_dimensions(FingerGeometry(), args.dimension),
        pressures_pa_gauge=tuple(pressures),
        mesh=args.meshes[0] if args.meshes else "coarse",
        friction=args.friction,
        unload=args.unload,
    )


def _convergence(args: Any, pressures: list[float]) -> list[tuple[dict[str, Any], Case | None]]:
    base = _base(args, pressures)
    chosen = product(args.volumetric or VOLUMETRIC_READINGS, args.formulations or FORMULATIONS, args.meshes or MESHES)
    return [({}, replace(base, volumetric=v, formulation=f, mesh=m)) for v, f, m in chosen]


def _materials(args: Any, pressures: list[float]) -> list[tuple[dict[str, Any], Case | None]]:
    base = _base(args, pressures)
    chosen = product(args.meshes or ["coarse"], args.silicone_sets or SETS, args.tpu_sets or SETS)
    return [({}, replace(base, mesh=m, silicone_set=s, tpu_set=t)) for m, s, t in chosen]


def _one(args: Any, pressures: list[float]) -> list[tuple[dict[str, Any], Case | None]]:
    _one_mesh(args)
    return [({}, _base(args, pressures))]


def _sensitivity(args: Any, pressures: list[float]) -> list[tuple[dict[str, Any], Case | None]]:
    _one_mesh(args)
    base = _base(args, pressures)
    runs: list[tuple[dict[str, Any], Case | None]] = [({"dimension": None}, base)]
    names = open_dimensions(base.geometry)
    for name in args.only or names:
        if name not in names:
            raise ValueError(f"--only {name}: no such dimension; allowed: {', '.join(names)}")
        for sign in (-1.0, 1.0):
            about, changed = varied(base.geometry, name, sign, percent=args.percent, by_mm=args.by_mm)
            runs.append((about, None if changed is None else replace(base, geometry=changed)))
    return runs


def open_dimensions(geometry: FingerGeometry) -> list[str]:
    """Return the names of the dimensions that the paper leaves open; the gaps' starts are shifted together."""
    return [f.name for f in fields(geometry) if f.type is float] + [GAP_STARTS]


def varied(
    geometry: FingerGeometry, name: str, sign: float, *, percent: float | None, by_mm: float | None
) -> tuple[dict[str, Any], FingerGeometry | None]:
    """Return what is changed, and the geometry, or None and a ``message`` where the geometry refuses it.

    An angle's change in mm is that of an arc at the tube's outer radius; gap starts' percentage is of the first one.
    """
    shift = name == GAP_STARTS
    value = geometry.gap_start_m[0] if shift else float(getattr(geometry, name))
    unit = "rad" if name.endswith("_rad") else "m"
    change = sign * 1e-2 * (5.0 if percent is None else percent) * value
    if by_mm is not None:
        change = sign * 1e-3 * by_mm / (geometry.tube_outer_radius_m if unit == "rad" else 1.0)
    new: Any = tuple(start + change for start in geometry.gap_start_m) if shift else value + change
    about = {"dimension": name, "value": value, "unit": unit, "change": change, "shift": shift}
    try:
        return about, replace(geometry, **{name: new})
    except ValueError as error:
        return about | {"status": INVALID, "message": str(error)}, None


def _surrogate_markdown(runs: list[dict[str, Any]], _: list[float]) -> str:
    run = runs[0]
    if run["status"] in (DIED, INVALID):
        return _finger_markdown.outcome(run)
    calibration = json.loads((asset_path("calibration") / "finger.json").read_text(encoding="utf-8"))
    return _finger_markdown.surrogate(run, calibration["curve"])


TABLES = {
    "convergence": Table(
        help="mesh densities, linear and quadratic elements, both volumetric readings",
        to_kpa=75.0,
        cases=_convergence,
        markdown=_finger_markdown.convergence,
        options=("--formulations", "--volumetric"),
    ),
    "sensitivity": Table(
        help="tip angle against each open dimension",
        to_kpa=75.0,
        cases=_sensitivity,
        markdown=lambda runs, pressures: _finger_markdown.sensitivity(runs[0], runs[1:], pressures[-1]),
        options=("--percent", "--by-mm", "--only"),
    ),
    "materials": Table(
        help="the nine pairs of material sets",
        to_kpa=80.0,
        cases=_materials,
        markdown=_finger_markdown.materials,
        pressures_pa=(*_PRESSURES_PA, 80e3),
        options=("--silicone-sets", "--tpu-sets"),
    ),
    "surrogate": Table(
        help="one run beside the shipped calibration's surrogate",
        to_kpa=80.0,
        cases=_one,
        markdown=_surrogate_markdown,
        pressures_pa=PRESSURES_PA_GAUGE,
    ),
}


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("table", choices=list(TABLES), help="; ".join(f"{k}: {t.help}" for k, t in TABLES.items()))
    p.add_argument("--meshes", choices=list(MESHES), nargs="+", help="mesh densities (convergence: all, else coarse)")
    p.add_argument("--formulations", choices=FORMULATIONS, nargs="+", help="convergence: elements (both)")
    p.add_argument("--volumetric", choices=VOLUMETRIC_READINGS, nargs="+", help="convergence: readings (both)")
    p.add_argument("--silicone-sets", choices=SETS, nargs="+", help="materials: sets of the silicone (all)")
    p.add_argument("--tpu-sets", choices=SETS, nargs="+", help="materials: sets of the TPU (all)")
    p.add_argument("--percent", type=_cli.positive_float, help="sensitivity: change of each dimension (5)")
    p.add_argument("--by-mm", type=_cli.positive_float, metavar="MM", help="sensitivity: change in mm instead")
    p.add_argument("--only", nargs="+", metavar="NAME", help="sensitivity: these dimensions (all open ones)")
    p.add_argument(
        "--to", type=_cli.positive_float, metavar="KPA", help="highest pressure (75; materials, surrogate: 80)"
    )
    _cli.add_friction(p, FRICTION)
    p.add_argument("--unload", action="store_true", help="go down again after the highest pressure")
    _cli.add_dimension(p)
    p.add_common(seed="taken for uniformity; nothing is random", json="keep the runs here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Make a table; return the exit status."""
    args = parser().parse_args(argv)
    table = TABLES[args.table]
    _check(args, table)
    pressures = levels(table.pressures_pa, 1e3 * (args.to or table.to_kpa))
    cases = table.cases(args, pressures)
    kept = _Kept(args.json, args.table)
    runs = []
    with tqdm(cases, desc=args.table, unit="run") as bar:
        for about, case in bar:
            runs.append(about if case is None else about | kept.get(case, bar.set_postfix_str))
    print(table.markdown(runs, pressures))
    died = [run for run in runs if run["status"] == DIED]
    for run in died:
        print(f"{run['message']}: {json.dumps(run['case'])}", file=sys.stderr)
    return 1 if died else 0


def levels(pressures_pa: Sequence[float], to_pa: float) -> list[float]:
    """Return the pressures below the highest one, and that one."""
    return [p for p in pressures_pa if p < to_pa * (1.0 - 1e-9)] + [round(to_pa, 6)]


class _Kept:
    """The finished runs, in a JSON file (if any) that is written again after each."""

    def __init__(self, file: Path | None, table: str) -> None:
        self._file, self._table, self._runs = file, table, list[dict[str, Any]]()
        if file is None or not file.exists():
            return
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
            same = (content["table"], content["code_sha256"]) == (table, code_version())
            self._runs = list(content["runs"])
        except (ValueError, KeyError, TypeError):
            raise ValueError(f"--json {file}: not a file of this program; give another") from None
        if not same:
            raise ValueError(f"--json {file}: holds runs of another table or of other code; give another file")

    def get(self, case: Case, report: Callable[[str], None]) -> dict[str, Any]:
        """Return the run of a case, a kept one if there is one."""
        key = case.as_dict()
        for run in self._runs:
            if run["case"] == key:
                return run
        run = execute(case, report)
        if run["status"] != DIED:
            self._runs.append(run)
        if self._file is not None:
            _cli.write_json(self._file, {"table": self._table, "code_sha256": code_version(), "runs": self._runs})
        return run


def _check(args: Any, table: Table) -> None:
    for other in TABLES.values():
        for option in other.options:
            if option not in table.options and getattr(args, option.strip("-").replace("-", "_")) is not None:
                raise ValueError(f"{option}: not an option of {args.table}")
    if args.percent is not None and args.by_mm is not None:
        raise ValueError("--percent, --by-mm: give one of them")
    ContactOptions(friction=args.friction)  # refuses it by name
    _cli.check_writable(args.json)


def _one_mesh(args: Any) -> None:
    if args.meshes is not None and len(args.meshes) > 1:
        raise ValueError(f"--meshes {' '.join(args.meshes)}: {args.table} takes one")


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
