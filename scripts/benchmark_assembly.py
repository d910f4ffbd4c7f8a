"""Time one tangent: batched assembly against scikit-fem's BilinearForm and felupe, and against factor and solve.

All numbers come from one run on one mesh (a cube of quadratic tetrahedra) with one law (neo-Hookean), so that their
ratios mean something where absolute times do not. The fastest of some repetitions counts.
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

from fea.arrays import F64
from fea.assembly import Load, SolidModel
from fea.laws import Law
from fea.linear_solver import SymmetricSolver, solver_name
from fea.meshes import rectangle, sweep
from fea.rubber import ClosedNeoHookean, PointwiseVolume
from scripts import _cli

EXAMPLES = """examples:
  python scripts/benchmark_assembly.py --cells 12
  python scripts/benchmark_assembly.py --cells 8 --json out/assembly.json
"""

SHEAR_MODULUS_PA = 1e5
BASE = "batched forces and tangent (P2/P0)"


def cube(cells: int, law: Law) -> SolidModel:
    """Return a cube of ``6 cells^3`` quadratic tetrahedra, clamped at the bottom."""
    grid = np.linspace(0.0, 1.0, cells + 1)
    mesh = sweep(rectangle(grid, grid), grid)
    fixed = np.repeat((mesh.points_m[:, 2] == 0.0)[:, None], 3, axis=1)
    return SolidModel(mesh=mesh, laws={0: law}, fixed=fixed)


def fastest(work: Callable[[], Any], repetitions: int) -> float:
    """Return the shortest wall time [s]."""
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


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
    law = PlainVolume(ClosedNeoHookean(shear_modulus_pa=SHEAR_MODULUS_PA), kappa)
    model = cube(cells, law)
    u = 0.02 * np.sin(3.0 * model.mesh.points_m[:, [1, 2, 0]]) * model.mesh.points_m[:, 2:]
    state = model.evaluate(u, Load())
    assert state is not None
    assert state.tangent is not None
    tangent, right = state.tangent, state.internal_n
    closed = cube(cells, ClosedNeoHookean(shear_modulus_pa=SHEAR_MODULUS_PA, bulk_modulus_pa=kappa))
    spectral = cube(cells, neo_hookean(SHEAR_MODULUS_PA, kappa))
    seconds = {BASE: fastest(lambda: closed.evaluate(u, Load()), repetitions)}
    if importlib.util.find_spec("felupe") is not None:
        seconds["felupe, forces and tangent"] = fastest(felupe_form(model, kappa, u), repetitions)
    seconds["batched, law in principal stretches (Ogden)"] = fastest(lambda: spectral.evaluate(u, Load()), repetitions)
    seconds["batched, volumetric energy at points"] = fastest(lambda: model.evaluate(u, Load()), repetitions)
    plain = plain_form(model, law, u)
    agreement = _agreement(model, plain(), tangent)
    seconds["BilinearForm, tangent"] = fastest(plain, 1)
    solver = SymmetricSolver()
    solver.solve(tangent, right)  # the pattern is analysed once in an analysis too
    seconds["factor and solve"] = fastest(lambda: solver.solve(tangent, right), repetitions)
    solver.close()
    base = seconds[BASE]
    return {
        "dofs": len(model.free),
        "elements": len(model.mesh.elements),
        "solver": solver_name(),
        "relative_difference_to_bilinear_form": agreement,
        "seconds": seconds,
        "ratio_to_batched": {name: value / base for name, value in seconds.items()},
    }


def _agreement(model: SolidModel, plain: Any, upper: Any) -> float:
    """Return the relative difference of the two matrices' quadratic forms for one random direction."""
    v = np.zeros_like(model.mesh.points_m)
    v.reshape(-1)[model.free] = np.random.default_rng(0).standard_normal(len(model.free))
    free = v.ravel()[model.free]
    ours = 2.0 * float(free @ (upper @ free)) - float(upper.diagonal() @ free**2)
    basis = Basis(model.mesh.skfem_mesh, ElementVector(ElementTetP2()), intorder=2)
    other = np.zeros(basis.N)
    n = basis.nodal_dofs.shape[1]
    other[basis.nodal_dofs.T.ravel()] = v[:n].ravel()
    other[basis.edge_dofs.T.ravel()] = v[n:].ravel()
    return abs(float(other @ (plain @ other)) / ours - 1.0)


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
    print(f"{result['dofs']} unknowns, {result['elements']} elements, {result['solver']}")
    for name, seconds in result["seconds"].items():
        print(f"{name:45s} {seconds:8.3f} s  {result['ratio_to_batched'][name]:7.2f} x")
    if args.json is not None:
        _cli.write_json(args.json, result)
    return 0


def main(argv: list[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
