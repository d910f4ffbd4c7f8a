"""Time forces and tangent: this assembly against scikit-fem's BilinearForm and felupe, and against factor and solve.

One run on one mesh (a cube of quadratic tetrahedra), so that ratios mean something where absolute times do not. The
codes integrate one and the same law: neo-Hookean with kappa/2 (J - 1)^2 at each point. What the finger is made of
(element-mean dilatation, Ogden with three terms) has rows of its own. Rows take turns, and the fastest turn counts.
"""

import importlib
import importlib.util
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from skfem import Basis, BilinearForm, ElementTetP2, ElementVector

from fea.arrays import F64, I64
from fea.assembly import SolidModel
from fea.calibration import load_materials
from fea.compiled import kernel_name
from fea.laws import Law
from fea.linear_solver import SymmetricSolver, solver_name
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.rubber import ClosedNeoHookean, PointwiseVolume
from scripts import _cli

EXAMPLES = """examples:
  python scripts/benchmark_assembly.py --cells 12
  python scripts/benchmark_assembly.py --cells 8 --json out/assembly.json
"""

SHEAR_MODULUS_PA = 1e5
BASE = "forces and tangent"
FELUPE = "felupe, forces and tangent"


def cube(cells: int, law: Law, *, compiled: bool = True) -> SolidModel:
    """Return a cube of ``6 cells^3`` quadratic tetrahedra, clamped at the bottom."""
    grid = np.linspace(0.0, 1.0, cells + 1)
    mesh = sweep(rectangle(grid, grid), grid)
    fixed = np.repeat((mesh.points_m[:, 2] == 0.0)[:, None], 3, axis=1)
    return SolidModel(mesh=mesh, laws={0: law}, fixed=fixed, compiled=compiled)


def fastest(works: dict[str, Callable[[], Any]], repetitions: int) -> dict[str, float]:
    """Return the shortest wall time [s] of each work; they take turns, so that other load meets all of them."""
    times = dict.fromkeys(works, np.inf)
    for _ in range(repetitions):
        for name, work in works.items():
            start = time.perf_counter()
            work()
            times[name] = min(times[name], time.perf_counter() - start)
    return times


def plain_form(model: SolidModel, law: Law, u_m: F64) -> Callable[[], Any]:
    """Return the assembly of the same tangent as a textbook writes it: a BilinearForm of grad(u) : A : grad(v)."""
    basis = Basis(model.mesh.skfem_mesh, ElementVector(ElementTetP2()), intorder=2)
    vector = np.zeros(basis.N)
    vector[basis.nodal_dofs.T.ravel()] = u_m[: basis.nodal_dofs.shape[1]].ravel()
    vector[basis.edge_dofs.T.ravel()] = u_m[basis.nodal_dofs.shape[1] :].ravel()

    def stiffness(u: Any, v: Any, w: Any) -> Any:
        return np.einsum("iJ...,iJkL...,kL...->...", v.grad, w["A"], u.grad)

    form = BilinearForm(stiffness)

    def assemble() -> Any:
        F = np.eye(3) + np.moveaxis(np.asarray(basis.interpolate(vector).grad), (0, 1), (2, 3))
        A = np.moveaxis(law.stress_and_tangent(F)[1], (0, 1), (-2, -1))
        return form.assemble(basis, A=A)

    return assemble


def felupe_form(model: SolidModel, kappa_pa: float, u_m: F64) -> Callable[[], Any]:
    """Return felupe's assembly of the same forces and tangent on the same mesh."""
    fem: Any = importlib.import_module("felupe")
    elements = model.mesh.elements.copy()
    corner = model.mesh.points_m[elements[:, :4]]
    mirrored = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0.0
    elements[mirrored] = elements[mirrored][:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    mesh = fem.Mesh(model.mesh.points_m, elements, "tetra10")
    field = fem.FieldContainer([fem.Field(fem.RegionQuadraticTetra(mesh), dim=3, values=u_m.copy())])
    body = fem.SolidBody(fem.NeoHooke(mu=SHEAR_MODULUS_PA, bulk=kappa_pa), field)
    return lambda: (body.assemble.vector(field), body.assemble.matrix(field))


def measure(cells: int, repetitions: int) -> dict[str, Any]:
    """Return times [s] and ratios."""
    kappa = 20.0 * SHEAR_MODULUS_PA
    law = PointwiseVolume(law=ClosedNeoHookean(shear_modulus_pa=SHEAR_MODULUS_PA), point_bulk_modulus_pa=kappa)
    mean = ClosedNeoHookean(shear_modulus_pa=SHEAR_MODULUS_PA, bulk_modulus_pa=kappa)
    silicone = load_materials().silicone.law
    model = cube(cells, law)
    u = 0.02 * np.sin(3.0 * model.mesh.points_m[:, [1, 2, 0]]) * model.mesh.points_m[:, 2:]
    state = model.evaluate(u, Load())
    assert state is not None
    assert state.tangent is not None
    tangent, right = state.tangent, state.internal_n

    def ours(with_law: Law, *, compiled: bool) -> Callable[[], Any]:
        other = cube(cells, with_law, compiled=compiled)
        other.evaluate(u, Load())  # compiles
        return lambda: other.evaluate(u, Load())

    solver = SymmetricSolver()
    solver.solve(tangent, right)  # the pattern is analysed once in an analysis too
    works = {
        BASE: ours(law, compiled=True),
        f"{BASE}, NumPy": ours(law, compiled=False),
        f"{BASE}, P2/P0": ours(mean, compiled=True),
        f"{BASE}, P2/P0, NumPy": ours(mean, compiled=False),
        f"{BASE}, P2/P0, Ogden": ours(silicone, compiled=True),
        f"{BASE}, P2/P0, Ogden, NumPy": ours(silicone, compiled=False),
        "factor and solve": lambda: solver.solve(tangent, right),
    }
    plain = plain_form(model, law, u)
    differences = {"BilinearForm": _agreement(model, plain(), tangent)}
    if importlib.util.find_spec("felupe") is not None:
        works[FELUPE] = felupe = felupe_form(model, kappa, u)
        differences["felupe"] = _difference(model, felupe()[1], np.arange(u.size), tangent)
    seconds = fastest(works, repetitions) | fastest({"BilinearForm, tangent": plain}, 1)
    solver.close()
    return {
        "dofs": len(model.free),
        "elements": len(model.mesh.elements),
        "solver": solver_name(),
        "element_kernels": kernel_name(),
        "relative_difference": differences,
        "seconds": seconds,
        "ratio_to_forces_and_tangent": {name: value / seconds[BASE] for name, value in seconds.items()},
    }


def _agreement(model: SolidModel, plain: Any, upper: Any) -> float:
    """Return the relative difference to a matrix in scikit-fem's numbering."""
    basis = Basis(model.mesh.skfem_mesh, ElementVector(ElementTetP2()), intorder=2)
    numbers = np.concatenate([basis.nodal_dofs.T.ravel(), basis.edge_dofs.T.ravel()])
    return _difference(model, plain, numbers, upper)


def _difference(model: SolidModel, plain: Any, numbers: I64, upper: Any) -> float:
    """Return the relative difference of two matrices' quadratic forms for one random direction.

    ``numbers`` are the other code's degrees of freedom in the order of ours, all included.
    """
    v = np.zeros(len(numbers))
    free = np.random.default_rng(0).standard_normal(len(model.free))
    v[numbers[model.free]] = free
    ours = 2.0 * float(free @ (upper @ free)) - float(upper.diagonal() @ free**2)
    return abs(float(v @ (plain @ v)) / ours - 1.0)


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--cells", type=_cli.positive_int, default=10, help="cells along an edge of the cube (%(default)s)")
    p.add_argument("--repetitions", type=_cli.positive_int, default=3, help="the fastest of these counts (%(default)s)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write times and ratios here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run the benchmark; return the exit status."""
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    result = measure(args.cells, args.repetitions)
    print(f"{result['dofs']} unknowns, {result['elements']} elements, {result['element_kernels']}, {result['solver']}")
    print(", ".join(f"difference to {name} {value:.1e}" for name, value in result["relative_difference"].items()))
    for name, seconds in result["seconds"].items():
        print(f"{name:45s} {seconds:8.3f} s  {result['ratio_to_forces_and_tangent'][name]:7.2f} x")
    if args.json is not None:
        _cli.write_json(args.json, result)
    return 0


def main(argv: list[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
