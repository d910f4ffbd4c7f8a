"""From dimensions and materials to the calibration file's contents: what the store keeps."""

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

from fea.artifact import artifact
from fea.calibration import TARGET_PRESSURE_PA_GAUGE, Calibration, calibrate, choose_sector
from fea.density import Density
from fea.finger_design import FingerDesign
from fea.store import Solved


def solve_finger(
    design: FingerDesign, density: Density, *, choose: bool = False, progress: Callable[[], None] = lambda: None
) -> Solved:
    """Calibrate a finger; with ``choose``, find first the palm sector that gives the stated angle.

    Starts a process of its own for the parts alone, so a script that calls this needs its ``__main__`` guard.

    Raises
    ------
    ValueError
        If an analysis ends too early to fit anything, or no sector gives the angle.
    """
    start = time.perf_counter()
    if choose:
        result = choose_sector(design.geometry, design.materials, density, progress=progress)
    else:
        # spawn: a forked child would inherit the parent's BLAS threads
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            result = calibrate(design.geometry, design.materials, density, progress=progress, beside=pool)
    return Solved(artifact=artifact(result), report=report(result, time.perf_counter() - start))


def report(c: Calibration, wall_s: float) -> dict[str, Any]:
    """Return the curves of the three analyses, how they ended and what they cost, JSON ready.

    The angle at 75 kPa is None where the complete finger lost its equilibrium before.
    """
    a, x, f = c.actuator, c.exoskeleton, c.finger
    reached = bool(f.pressure_pa_gauge.max() >= TARGET_PRESSURE_PA_GAUGE)
    return {
        "pressure_pa_gauge": a.pressure_pa_gauge.tolist(),
        "actuator_elongation": a.elongation.tolist(),
        "actuator_volume_m3": a.volume_m3.tolist(),
        "actuator_radial_growth_m": a.radial_growth_m.tolist(),
        "actuator_max_stretch": a.max_stretch.tolist(),
        "actuator_status": a.status.value,
        "load_n": x.load_n.tolist(),
        "exoskeleton_tip_deflection_m": x.tip_deflection_m.tolist(),
        "exoskeleton_joint_angle_rad": x.angle_rad.tolist(),
        "exoskeleton_status": x.status.value,
        "finger_branch": list(f.branch),
        "finger_pressure_pa_gauge": f.pressure_pa_gauge.tolist(),
        "finger_joint_angle_rad": f.joint_angle_rad.tolist(),
        "finger_volume_m3": f.volume_m3.tolist(),
        "finger_status": f.status.value,
        "tip_angle_deg_at_75_kpa": c.fit.surrogate.tip_angle_deg(TARGET_PRESSURE_PA_GAUGE) if reached else None,
        "sector_half_angle_rad": c.geometry.sector_half_angle_rad,
        "fit_rmse": dict(c.fit.rmse),
        "dofs": {"actuator": a.dofs, "exoskeleton": x.dofs, "finger": f.dofs},
        "newton_iterations": {"actuator": a.iterations, "exoskeleton": x.iterations, "finger": f.iterations},
        "density": c.density.name,
        "wall_s": wall_s,
    }
