"""Run the verification problems of the finite-element lab at reference density and write their table."""

import importlib.util
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from fea.linear_solver import solver_name
from fea.verification.balloon import balloon_rows
from fea.verification.common import FORMULATIONS, Row
from fea.verification.contact_hertz import hertz
from fea.verification.contact_patch import bonded_patch, contact_patch, patch_rows
from fea.verification.contact_sliding import sliding
from fea.verification.convergence import cylinder_error, manufactured_error
from fea.verification.cook import cook
from fea.verification.inflation import LAWS, cylinder, sphere
from fea.verification.lame import lame_cylinder
from fea.verification.patch import patch
from fea.verification.ring_tube import ring_tube
from fea.verification.second_code import inflated_cylinder, twisted_block
from fea.verification.treloar import treloar
from scripts import _cli

EXAMPLES = """examples:
  python scripts/verify_fea.py --out docs/verification.md       # about three minutes
  python scripts/verify_fea.py --only cylinder patch --json out/verification.json
"""

INTRODUCTION = """# Verification of the finite-element lab

Each problem is a file of `fea/verification/` that opens with its equations. `tests/fea/test_verification.py` runs all
of them at lower density in the normal suite. P1: linear tetrahedra, pointwise volumetric energy; they lock as the
material becomes incompressible and are listed to show by how much. P2/P0: quadratic tetrahedra, volumetric energy of
each element's mean dilatation, as in the analyses. P2/P1: mixed displacement and pressure, the referee.

Contact comes in two kinds. *Segments*, as in the finger: the pressure of the gap integrated over the common refinement
of two quadratic surfaces; a uniform stress passes to rounding. *Barrier*: Incremental Potential Contact on flat facets
between nodes, which passes on force and (to the noise on its own positions) moment, but not a uniform stress; the rows
of the contact patch say how uniform. Its pairs are counted once (`ContactOptions.count_once`): with the plain set a
block whose facets match the ground's, shifted by 0.03 mm under a barrier of 0.1 mm, is pushed sideways with up to 38 %
of the normal force without any friction, counted once with 2 %.

Hertz's theory leaves out terms of the order of contact radius over sphere radius, 1 : 50 here: the contact radius is
1 % off on any mesh, and half of that with a sphere four times as large.
"""


@dataclass(frozen=True, kw_only=True)
class Order:
    """Error on two meshes and the order between them."""

    name: str
    coarse: float
    fine: float
    ratio: float

    @property
    def order(self) -> float:
        """Observed order."""
        return float(np.log(self.coarse / self.fine) / np.log(self.ratio))


def problems() -> dict[str, list[Callable[[], Row | list[Row]]]]:
    """Return the problems by the name that ``--only`` takes."""
    both = ("P2/P0", "P2/P1")
    tensions = (("uniaxial", 2.0), ("uniaxial", 6.0), ("equibiaxial", 2.0), ("equibiaxial", 4.0))
    groups: dict[str, list[Callable[[], Row | list[Row]]]] = {
        "cylinder": [partial(cylinder, f, law, cells=8) for law in LAWS for f in both],
        "sphere": [partial(sphere, f, law, cells=5, layers=5) for law in LAWS for f in both],
        "lame": [
            *(partial(lame_cylinder, f, poisson_ratio=0.4995, cells=8) for f in FORMULATIONS),
            partial(lame_cylinder, "P1", poisson_ratio=0.3, cells=8),
        ],
        "rings": [partial(ring_tube, law, cells=3) for law in LAWS],
        "cook": [partial(cook, "P1", cells=24), partial(cook, "P2/P0", cells=16), partial(cook, "P2/P1", cells=24)],
        "treloar": [partial(treloar, mode, stretch) for mode, stretch in tensions],
        "balloon": [balloon_rows],
    }
    groups["sliding"] = [partial(sliding, friction) for friction in (0.1, 0.3, 0.8)]
    groups["hertz"] = [hertz]
    if importlib.util.find_spec("ipctk") is not None:
        groups["sliding"] += [partial(sliding, friction, contact="barrier") for friction in (0.1, 0.3, 0.8)]
        groups["hertz"] += [partial(hertz, contact="barrier")]
        groups["contact"] = [patch_rows]
    if importlib.util.find_spec("felupe") is not None:
        groups["felupe"] = [partial(twisted_block, felupe_cells=5), inflated_cylinder]
    return groups


def orders() -> list[Order]:
    """Return observed orders of convergence of the displacement."""
    return [
        Order(
            name="P2, manufactured solution, compressible",
            coarse=manufactured_error(4),
            fine=manufactured_error(8),
            ratio=2,
        ),
        *(
            Order(name=f"{f}, incompressible cylinder", coarse=cylinder_error(f, 4), fine=cylinder_error(f, 8), ratio=2)
            for f in ("P2/P1", "P2/P0")
        ),
    ]


def patches() -> dict[str, float]:
    """Return the largest error of the patch tests: elements by formulation, bonded interface, contact."""
    errors = {f: patch(f, np.random.default_rng(0))[0] for f in FORMULATIONS}
    errors["P2/P0, interface of two bonded blocks"] = bonded_patch(np.random.default_rng(0))
    for cells in ((4, 4), (3, 4), (5, 7)):
        name = f"P2/P0, contact over segments, {cells[0]} on {cells[1]} cells a side: stress"
        errors[name] = contact_patch(cells).worst
    return errors


def page(rows: Iterable[Row], rates: Iterable[Order], errors: dict[str, float], command: str) -> str:
    """Return the page in Markdown."""
    lines = [INTRODUCTION, f"Written by `{command}` with {solver_name()}.", ""]
    lines += [
        "| problem | formulation | unknowns | quantity | figure | exact | error |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        cells = (r.problem, r.formulation, r.dofs, r.quantity, f"{r.figure:.6g}", f"{r.exact:.6g}", _percent(r.error))
        lines.append(f"| {' | '.join(str(c) for c in cells)} |")
    if errors:
        lines += [
            "",
            "Patch tests on distorted meshes, largest error of the displacement or balance (must be below 1e-9):",
            "",
        ]
        lines += ["| formulation | error |", "|---|---|", *(f"| {f} | {e:.1e} |" for f, e in errors.items())]
    rates = list(rates)
    if rates:
        lines += ["", "Observed order of convergence of the displacement in L2 (mesh halved):", ""]
        lines += ["| case | error, coarse | error, fine | order |", "|---|---|---|---|"]
        lines += [f"| {o.name} | {o.coarse:.2e} | {o.fine:.2e} | {o.order:.2f} |" for o in rates]
    return "\n".join([*lines, ""])


def _percent(error: float) -> str:
    return f"{100.0 * error:.2g} %"


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    names = [*problems(), "patch", "orders"]
    p.add_argument("--only", nargs="+", choices=names, metavar="NAME", help=f"some of: {', '.join(names)}")
    p.add_argument("--out", type=Path, help="write the page here (Markdown)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write all figures here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run the problems; return the exit status."""
    args = parser().parse_args(argv)
    _cli.check_writable(args.out)
    _cli.check_writable(args.json)
    wanted = args.only or [*problems(), "patch", "orders"]
    start = time.perf_counter()
    rows: list[Row] = []
    cases = [case for name, group in problems().items() if name in wanted for case in group]
    for case in tqdm(cases, desc="problems", unit="problem"):
        found = case()
        rows += found if isinstance(found, list) else [found]
    errors = patches() if "patch" in wanted else {}
    rates = orders() if "orders" in wanted else []
    command = " ".join(["python scripts/verify_fea.py", *(["--only", *args.only] if args.only else [])])
    text = page(rows, rates, errors, command)
    print(text[len(INTRODUCTION) :])
    if args.out is not None:
        _cli.write_text(args.out, text)
    if args.json is not None:
        _cli.write_json(args.json, _record(rows, rates, errors, time.perf_counter() - start))
    return 0


def _record(rows: list[Row], rates: list[Order], errors: dict[str, float], wall_s: float) -> dict[str, object]:
    return {
        "problems": [
            {
                "problem": r.problem,
                "formulation": r.formulation,
                "dofs": r.dofs,
                "quantity": r.quantity,
                "figure": r.figure,
                "exact": r.exact,
                "relative_error": r.error,
            }
            for r in rows
        ],
        "patch_error": errors,
        "order": {o.name: o.order for o in rates},
        "solver": solver_name(),
        "wall_s": wall_s,
    }


def main(argv: list[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
