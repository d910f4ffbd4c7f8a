"""Run the finite-element rungs of the accuracy ladder, free and with the tip blocked, and keep them as data.

Rungs are a mesh density with linear (P1) or quadratic (P2) tetrahedra: near-incompressible reading, shipped materials
and dimensions, friction 0.3, one thread.
"""

import os

# before numpy and the solvers are imported: one thread, so that processor time is the solve's own
os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")})

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from assets import asset_path
from fea.calibration import load_materials
from fea.checkpoint import Checkpoints, code_version
from fea.finger import FORMULATIONS, MESHES, FingerModel, analyse_finger, finger_model
from fea.finger_path import FingerPath
from fea.geometry import FingerGeometry
from fea.linear_solver import solver_name
from fea.path import Step, Sweep
from fea.tip_wall import SENSOR_DISTANCE_M, TipWall, tip_wall
from scripts import _cli

SCHEMA, SCHEMA_VERSION = "softhand-sim/accuracy-fea", 1
PRESSURES_PA_GAUGE = (15e3, 30e3, 45e3, 60e3, 75e3)
"""Choice: those of ``finger_table.py convergence``; three of them are beyond the blocked tip's arrival."""
TESTS = ("free", "blocked")
CODE = code_version()
"""That of the modules as they were imported: the files may change while a rung runs."""
EXAMPLES = """examples:
  accuracy_fea.py                                        # all rungs into assets/accuracy, about 90 minutes of processor
  accuracy_fea.py --rungs coarse-P1 coarse-P2 --out out/accuracy_fea.json
Every finished run stands in --out at once and isn't run again by the same command; a killed one goes on from its last
converged step in --work.
"""


@dataclass(frozen=True, kw_only=True)
class Rung:
    """A mesh density and its elements."""

    mesh: str
    formulation: str

    @property
    def name(self) -> str:
        """Return ``mesh-formulation``."""
        return f"{self.mesh}-{self.formulation}"


RUNGS = {rung.name: rung for rung in (Rung(mesh=m, formulation=f) for f, m in product(FORMULATIONS, MESHES))}


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--rungs", nargs="+", choices=list(RUNGS), default=list(RUNGS), help="which rungs (all)")
    p.add_argument("--tests", nargs="+", choices=TESTS, default=list(TESTS), help="free finger, blocked tip (both)")
    p.add_argument("--out", type=Path, help="file of all runs (assets/accuracy/finger_fea.json)")
    p.add_argument(
        "--work", type=Path, default=Path("out/accuracy_fea"), help="folder of converged steps (%(default)s)"
    )
    p.add_argument("--any-code", action="store_true", help="take finished runs of another version of the code")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the runs of this command here as well")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run what is missing; return the exit status."""
    args = parser().parse_args(argv)
    out = args.out if args.out is not None else asset_path("accuracy") / "finger_fea.json"
    for path in (args.json, out):
        _cli.check_writable(path)
    wanted = [(RUNGS[rung], test) for rung, test in product(args.rungs, args.tests)]
    runs = []
    for rung, test in wanted:
        kept = read_runs(out) if out.exists() else []
        run = next((r for r in kept if _is(r, rung, test) and (args.any_code or r["code_sha256"] == CODE)), None)
        if run is None:
            run = solve(rung, test, args.work)
            # what another process has finished meanwhile must not be lost
            kept = read_runs(out) if out.exists() else []
            kept = [r for r in kept if not _is(r, rung, test)] + [run]
            _cli.write_json(out, {"schema": SCHEMA, "schema_version": SCHEMA_VERSION, "runs": kept})
        runs.append(run)
        print(f"{rung.name} {test}: {run['status']}, {run['dofs']} unknowns, {run['processor_s']:.0f} s processor time")
    if args.json is not None:
        _cli.write_json(args.json, {"schema": SCHEMA, "schema_version": SCHEMA_VERSION, "runs": runs})
    return 0 if all(run["status"] == "converged" for run in runs) else _cli.INCOMPLETE


def read_runs(file: Path) -> list[dict[str, Any]]:
    """Return the runs of a file of this script.

    Raises
    ------
    ValueError
        If it is not one.
    """
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        if (content["schema"], content["schema_version"]) != (SCHEMA, SCHEMA_VERSION):
            raise ValueError(f"schema {content['schema']!r}")
        return list(content["runs"])
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"--out {file}: not a file of this program ({error}); give another") from None


def _is(run: dict[str, Any], rung: Rung, test: str) -> bool:
    return (run["mesh"], run["formulation"], run["test"]) == (rung.mesh, rung.formulation, test)


def solve(rung: Rung, test: str, work: Path) -> dict[str, Any]:
    """Return one run's figures, JSON ready; goes on from the converged steps that ``work`` has.

    The blocked run takes the free run's steps up to where the tip meets the wall: they are its own to the bit.
    """
    geometry, materials = FingerGeometry(), load_materials()
    model = finger_model(
        geometry, materials.silicone, materials.pet, materials.tpu, MESHES[rung.mesh], formulation=rung.formulation
    )
    wall = tip_wall(model.solid.mesh, geometry) if test == "blocked" else None
    steps, timed = _steps(rung, test, work), _Timed(work / f"{rung.name}-{test}.processor.json")
    done = steps.load()
    if wall is not None and not done:
        free = _steps(rung, "free", work).load()
        done = free[: next((k for k, step in enumerate(free) if wall.push_n(step.u_m) > 0.0), len(free))]
        shared = _Timed(work / f"{rung.name}-free.processor.json").spent_s(len(done))
        for step in done:
            steps.save(step)
        timed.start_from(shared, len(done))
    states = {step.parameter: step.u_m for step in done}
    path = FingerPath(PRESSURES_PA_GAUGE)
    name, reached = f"{rung.name} {test}", max(states, default=0.0)
    with tqdm(total=PRESSURES_PA_GAUGE[-1] / 1e3, initial=reached / 1e3, desc=name, unit="kPa") as bar:

        def on_step(step: Step) -> None:
            timed.add()
            steps.save(step)
            states[step.parameter] = step.u_m
            bar.update(step.parameter / 1e3 - bar.n)

        _compile(rung.formulation)
        timed.begin()
        result = analyse_finger(model, geometry, path, wall=wall, sweep=Sweep(on_step=on_step, resume=done))
    u_m = [np.zeros_like(model.solid.mesh.points_m)] + [states[p] for p in path.targets[: len(result.branch) - 1]]
    return {
        "mesh": rung.mesh,
        "formulation": rung.formulation,
        "test": test,
        "sensor_distance_m": SENSOR_DISTANCE_M if wall is not None else None,
        "pressure_pa_gauge": result.pressure_pa_gauge.tolist(),
        "tip_angle_deg": np.rad2deg(result.tip_angle_rad).tolist(),
        "joint_angle_rad": result.joint_angle_rad.tolist(),
        "tip_position_m": [_tip_m(model, geometry, u) for u in u_m],
        "tip_force_n": [2.0 * _push_n(wall, u) for u in u_m],
        "volume_m3": result.volume_m3.tolist(),
        "status": result.status.value,
        "dofs": result.dofs,
        "elements": result.elements,
        "load_steps": len(states),
        "processor_s": timed.spent_s(),
        **result.cost.as_dict(),
        "linear_solver": solver_name(),
        "code_sha256": CODE,
    }


def _compile(formulation: str) -> None:
    """Solve a small step first: the kernels' compilation is no cost of a rung."""
    geometry, materials = FingerGeometry(), load_materials()
    mesh = MESHES["coarse"]
    model = finger_model(geometry, materials.silicone, materials.pet, materials.tpu, mesh, formulation=formulation)
    analyse_finger(model, geometry, FingerPath((100.0,)))


def _steps(rung: Rung, test: str, work: Path) -> Checkpoints:
    identity = {
        "rung": [rung.name, asdict(MESHES[rung.mesh])],
        "test": test,
        "pressures": list(PRESSURES_PA_GAUGE),
        "code": CODE,
    }
    return Checkpoints(work / f"{rung.name}-{test}", identity)


def _push_n(wall: TipWall | None, u_m: np.ndarray) -> float:
    return 0.0 if wall is None else wall.push_n(u_m)


def _tip_m(model: FingerModel, geometry: FingerGeometry, u_m: np.ndarray) -> list[float]:
    """Return where the end plate's outer centre is: towards the palm side, and along the straight finger [m]."""
    r, _, z = model.solid.mesh.cylindrical.T
    tip = int(np.argmin(r + np.abs(z - geometry.finger_length_m)))
    place = model.solid.mesh.points_m[tip] + u_m[tip]
    return [float(place[0]), float(place[2])]


class _Timed:
    """Processor time at each converged step, kept beside the steps so that a later process adds to it."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._spent: list[float] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else []
        self._base, self._begun = (self._spent[-1] if self._spent else 0.0), 0.0

    def start_from(self, spent_s: float, steps: int) -> None:
        """Take another run's first steps for this one's."""
        self._spent, self._base = [spent_s] * steps, spent_s

    def begin(self) -> None:
        """Start the clock."""
        self._begun = time.process_time()

    def add(self) -> None:
        """Note the time at a converged step."""
        self._spent.append(self._base + time.process_time() - self._begun)
        _cli.write_text(self._file, json.dumps(self._spent))

    def spent_s(self, steps: int | None = None) -> float:
        """Return the time up to a step, the last one by default [s]."""
        count = len(self._spent) if steps is None else steps
        return self._spent[count - 1] if count else 0.0


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
