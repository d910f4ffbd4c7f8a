"""Runs of analysis (iii) for tables: each in a process of its own, so that its peak memory is its own."""

import resource
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from fea.checkpoint import code_version
from fea.finger import CONTACT, FRICTION, MESHES, FingerResult, analyse_finger, finger_model
from fea.finger_path import FingerPath
from fea.geometry import FingerGeometry
from fea.linear_solver import solver_name
from fea.materials import load_material
from fea.path import Sweep

DIED, INVALID = "died", "invalid"
"""Statuses of a run besides the solver's: its process was killed, or geometry or contact refused the case."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One run: everything that its result depends on but the code."""

    geometry: FingerGeometry
    pressures_pa_gauge: tuple[float, ...]
    mesh: str = "coarse"
    formulation: str = "P2"
    silicone_set: str = "set3"
    tpu_set: str = "set3"
    volumetric: str | None = None
    friction: float = FRICTION
    unload: bool = False

    def as_dict(self) -> dict[str, Any]:
        """Return the case, JSON ready."""
        own = {name: value for name, value in vars(self).items() if name != "geometry"}
        more = {"geometry": self.geometry.as_dict(), "mesh_cells": asdict(MESHES[self.mesh])}
        return own | more | {"pressures_pa_gauge": list(self.pressures_pa_gauge)}


def execute(case: Case, report: Callable[[str], None] = lambda _: None) -> dict[str, Any]:
    """Run a case in a new process; ``report`` gets a line of progress now and then.

    Returns
    -------
    dict
        The figures, JSON ready; only ``case``, ``status`` and ``message`` where status is ``died`` or ``invalid``.
    """
    context = get_context("spawn")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_child, args=(case, theirs), daemon=True)
    process.start()
    theirs.close()
    run: dict[str, Any] = {"case": case.as_dict()}
    try:
        while True:
            kind, content = ours.recv()
            if kind == "result":
                return {**run, **content}
            report(content)
    except EOFError:
        process.join()
        return run | {"status": DIED, "message": f"the run's process ended with {process.exitcode}"}
    finally:
        process.kill()
        process.join()


def _child(case: Case, pipe: Connection) -> None:
    def on_iteration(pressure: float, iteration: int, residual: float) -> None:
        pipe.send(("progress", f"{1e-3 * pressure:g} kPa, iteration {iteration}, residual {residual:.1e}"))

    try:
        pipe.send(("result", solve(case, Sweep(on_iteration=on_iteration)) | {"peak_memory_bytes": _peak_bytes()}))
    except ValueError as error:
        pipe.send(("result", {"status": INVALID, "message": str(error)}))


def solve(case: Case, sweep: Sweep) -> dict[str, Any]:
    """Run a case in this process; return its figures, JSON ready."""
    model = finger_model(
        case.geometry,
        load_material("ecoflex_00_50", case.silicone_set, case.volumetric),
        load_material("pet"),
        load_material("ninjaflex", case.tpu_set),
        MESHES[case.mesh],
        contact=replace(CONTACT, friction=case.friction),
        formulation=case.formulation,
    )
    result = analyse_finger(model, case.geometry, FingerPath(case.pressures_pa_gauge, case.unload), sweep=sweep)
    return figures(result) | {"linear_solver": solver_name(), "code_sha256": code_version()}


def figures(r: FingerResult) -> dict[str, Any]:
    """Return a result, JSON ready; a gap beyond the clearance is null."""
    return {
        "branch": list(r.branch),
        "pressure_pa_gauge": r.pressure_pa_gauge.tolist(),
        "tip_angle_deg": np.rad2deg(r.tip_angle_rad).tolist(),
        "joint_rotation_rad": r.joint_angle_rad.tolist(),
        "tip_displacement_m": r.tip_displacement_m.tolist(),
        "volume_m3": r.volume_m3.tolist(),
        "minimum_gap_m": [float(gap) if np.isfinite(gap) else None for gap in r.minimum_gap_m],
        "contact_force_n": r.contact_force_n.tolist(),
        "status": r.status.value,
        "dofs": r.dofs,
        **r.cost.as_dict(),
    }


def _peak_bytes() -> int:
    """Return the largest resident memory of this process so far."""
    unit = 1 if sys.platform == "darwin" else 1024
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
