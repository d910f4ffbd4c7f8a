"""The finger's ladder, closed form to reference finite elements: errors of the tip, and cost."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import numpy.typing as npt

from scripts.accuracy_fea import PRESSURES_PA_GAUGE, RUNGS, read_runs
from softhand_sim.calibration import FingerCalibration, load_evidence
from softhand_sim.characterize import Bench
from softhand_sim.fidelity.closed_form import ClosedFormFinger, Strip, hinged_tip_m

Vector = npt.NDArray[np.float64]
Row = dict[str, Any]
REFERENCE, NEXT = "reference-P2", "calibration-P2"
SHIPPED = "calibration-P2, the shipped analysis"
LINKS = (None, 6, 12, 24)
WALL_M = 40e-3
"""Distance of the blocked test's wall, that of the finite elements (`fea.tip_wall`, Alves et al., section 3.2)."""


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """One rung's loading: tip angle [deg], place [m], blocked force [N] at each pressure; what the free sweep took.

    ``force_n`` is None where a rung has none; ``simulated_s`` None where time does not pass.
    """

    angle_deg: Vector
    place_m: Vector
    force_n: Vector | None
    processor_s: float
    simulated_s: float | None = None


def table(calibration: FingerCalibration, fea_file: Path, repeats: int, tick: Callable[[], None]) -> Row:
    """Return the ladder: a row a rung, the reference's own error bar, and which mesh the force is held against.

    Without a run of the reference mesh the reference is the shipped analysis at calibration density, its error unknown.
    """
    fea = _finite_elements(read_runs(fea_file)) if fea_file.exists() else {}
    analysis = _analysis(calibration)
    coarser = fea.get(NEXT, analysis)
    pushed = analysis if coarser.force_n is None else coarser
    reference = fea.get(REFERENCE, analysis)
    rungs: dict[str, tuple[Sweep, str]] = {}
    for name, one in _closed_forms(calibration).items():
        rungs[name] = (one, "scripts/accuracy_vs_time.py finger")
        tick()
    for links in LINKS:
        name = "three joints" if links is None else f"{links} links"
        rungs[name] = (_simulated(calibration, links, repeats), "scripts/accuracy_vs_time.py finger")
        tick()
    for name, one in fea.items():
        rungs[f"FEA {name}"] = (one, f"scripts/accuracy_fea.py --rungs {name}")
    on_reference = REFERENCE in fea and fea[REFERENCE].force_n is not None
    forced = reference if on_reference else pushed
    less = pushed if on_reference else fea.get("coarse-P2", pushed)
    rows = [_row(name, sweep, reference, forced, command) for name, (sweep, command) in rungs.items()]
    own, force = _row("", coarser, reference, forced, ""), _row("", less, reference, forced, "")
    force_bar = None if less is forced or less.force_n is None else force["force_error_ratio"]
    for row in rows:
        if row["name"] == f"FEA {REFERENCE}":
            row |= {key: own[key] for key in ("angle_error_deg", "angle_error_max_deg", "tip_error_m")}
        if row["name"] == f"FEA {REFERENCE if on_reference else NEXT}":
            row["force_error_ratio"] = force_bar
    return {
        "pressure_pa_gauge": list(PRESSURES_PA_GAUGE),
        "reference": REFERENCE if REFERENCE in fea else SHIPPED,
        "force_reference": REFERENCE if on_reference else NEXT if pushed is not analysis else SHIPPED,
        "error_bar": {
            "angle_deg": None if coarser is reference else own["angle_error_deg"],
            "tip_m": None if coarser is reference else own["tip_error_m"],
            "force_ratio": force_bar,
        },
        "rungs": rows,
    }


def _row(name: str, found: Sweep, reference: Sweep, forced: Sweep, command: str) -> Row:
    angle = found.angle_deg - reference.angle_deg
    place = np.linalg.norm(found.place_m - reference.place_m, axis=1)
    force = None
    if found.force_n is not None and forced.force_n is not None:
        largest = float(forced.force_n.max())
        touching = forced.force_n > 0.0
        force = float(np.sqrt(np.mean((found.force_n - forced.force_n)[touching] ** 2))) / largest
    return {
        "name": name,
        "angle_error_deg": float(np.sqrt(np.mean(angle**2))),
        "angle_error_max_deg": float(np.abs(angle).max()),
        "tip_error_m": float(np.sqrt(np.mean(place**2))),
        "force_error_ratio": force,
        "tip_angle_deg": found.angle_deg.tolist(),
        "tip_force_n": None if found.force_n is None else found.force_n.tolist(),
        "processor_s_per_sweep": found.processor_s,
        "processor_s_per_simulated_s": None if found.simulated_s is None else found.processor_s / found.simulated_s,
        "command": command,
    }


def _timed(work: Callable[[], Any], least_s: float = 0.05) -> float:
    """Return the processor time of one call, over as many as take ``least_s``."""
    count, began = 0, time.process_time()
    while (spent := time.process_time() - began) < least_s:
        work()
        count += 1
    return spent / count


def _closed_forms(calibration: FingerCalibration) -> dict[str, Sweep]:
    kinds = {
        "closed form, curved strip": (Strip.CURVED, False),
        "closed form, flat strip": (Strip.FLAT, False),
        "closed form, flat strip, finite stretch": (Strip.FLAT, True),
    }
    found = {}
    for name, (strip, finite) in kinds.items():
        finger = ClosedFormFinger.of(calibration, strip, finite=finite)

        def angles(finger: ClosedFormFinger = finger) -> list[float]:
            return [finger.joint_angle_rad(p) for p in PRESSURES_PA_GAUGE]

        found[name] = Sweep(
            angle_deg=np.degrees(3.0 * np.array(angles())),
            place_m=np.array([finger.tip_m(np.full(3, q)) for q in angles()]),
            force_n=np.array([finger.blocked_force_n(p, WALL_M) for p in PRESSURES_PA_GAUGE]),
            processor_s=_timed(angles),
        )
    found["calibrated curve, looked up"] = _looked_up(calibration)
    return found


def _looked_up(calibration: FingerCalibration) -> Sweep:
    curve, body = calibration.curve, calibration.finger

    def tips() -> list[float]:
        return [calibration.angle_for_pressure(p) for p in PRESSURES_PA_GAUGE]

    joints = np.radians(
        [
            [np.interp(p, curve.pressure_pa_gauge, column) for column in curve.joint_angle_deg.T]
            for p in PRESSURES_PA_GAUGE
        ]
    )
    place = [hinged_tip_m(q, body.joint_position_m, body.length_m, body.hinge_offset_m) for q in joints]
    return Sweep(angle_deg=np.array(tips()), place_m=np.array(place), force_n=None, processor_s=_timed(tips))


def _simulated(calibration: FingerCalibration, links: int | None, repeats: int) -> Sweep:
    spent: list[float] = []
    for _ in range(repeats):
        bench = Bench(calibration, links=links)
        began = time.process_time()
        readings = [bench.go_to(p) for p in PRESSURES_PA_GAUGE]
        spent.append(time.process_time() - began)
    blocked = Bench(calibration, links=links, wall_distance_m=WALL_M)
    return Sweep(
        angle_deg=np.array([r.tip_angle_deg for r in readings]),
        place_m=np.array([r.tip_position_m for r in readings]),
        force_n=np.array([blocked.go_to(p).wall_force_n for p in PRESSURES_PA_GAUGE]),
        processor_s=median(spent),
        simulated_s=float(bench.data.time),
    )


def _analysis(calibration: FingerCalibration) -> Sweep:
    """Return the shipped analysis (iii) and blocked tip at calibration density: for runs of this ladder not made yet.

    The place of the tip is that of hinges at its joint angles, and there is no processor time.
    """
    cycle, blocked, body = calibration.analysis, load_evidence().blocked, calibration.finger
    up, wanted = cycle.loading, np.array(PRESSURES_PA_GAUGE)
    rows = [int(np.argmin(np.abs(cycle.pressure_pa_gauge[up] - p))) for p in wanted]
    angle = cycle.joint_angle_rad[up][rows]
    place = [hinged_tip_m(q, body.joint_position_m, body.length_m, body.hinge_offset_m) for q in angle]
    force = np.interp(wanted, blocked.pressure_pa_gauge, blocked.tip_force_n)
    return Sweep(
        angle_deg=np.degrees(angle.sum(axis=1)), place_m=np.array(place), force_n=force, processor_s=float("nan")
    )


def _finite_elements(runs: Sequence[Row]) -> dict[str, Sweep]:
    """Return the rungs whose free run reached the last pressure, coarse linear ones first."""
    by = {(f"{run['mesh']}-{run['formulation']}", run["test"]): run for run in runs if run["status"] == "converged"}
    found = {}
    for name in RUNGS:
        free, blocked = by.get((name, "free")), by.get((name, "blocked"))
        if free is None:
            continue
        found[name] = Sweep(
            angle_deg=np.array(free["tip_angle_deg"][1:]),
            place_m=np.array(free["tip_position_m"][1:]),
            force_n=None if blocked is None else np.array(blocked["tip_force_n"][1:]),
            processor_s=free["processor_s"],
        )
    return found
