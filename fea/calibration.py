"""Calibration of the finger: run the three analyses and reduce them; find the sector that gives the stated angle."""

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from fea.actuator import RING, ActuatorResult, actuator_model, analyse_actuator
from fea.density import Density
from fea.exoskeleton import ExoskeletonResult, analyse_exoskeleton, exoskeleton_model
from fea.finger import MESHES, FingerModel, FingerResult, analyse_finger, finger_model
from fea.finger_path import FingerPath
from fea.geometry import FingerGeometry
from fea.identification import Fit, reduce_finger
from fea.materials import Material, load_material

TARGET_TIP_ANGLE_DEG, TARGET_PRESSURE_PA_GAUGE = 95.0, 75e3
"""The one stated angle: Alves et al., section 4.2."""
FINGER_PRESSURES_PA_GAUGE = tuple(1e3 * p for p in range(5, 85, 5))
"""Choice: the fit takes every second one, from the last; 75 kPa is among those that it never sees."""
UNLOAD_TO_PA_GAUGE = 40e3
"""Choice: the way back on which friction is identified; the slip has turned everywhere by 65 kPa, and below 40 kPa the
loop is narrow."""
FINGER_PATH = FingerPath(FINGER_PRESSURES_PA_GAUGE, unload=True, unload_to_pa_gauge=UNLOAD_TO_PA_GAUGE)
NARROWEST_DEG, WIDEST_DEG = 40.0, 88.0
"""Choice: half angles of the palm sector that leave a flexure and a gap."""
CLOSE_DEG, ACCEPTED_DEG = 0.1, 0.5
"""Choice: errors of the angle at which the search ends at once, and with which it is content in the end."""
TRIALS = 8


@dataclass(frozen=True, kw_only=True)
class Materials:
    """The three materials of a finger."""

    silicone: Material
    tpu: Material
    pet: Material


@dataclass(frozen=True, kw_only=True, eq=False)
class Calibration:
    """The three analyses and their reduction for one geometry."""

    geometry: FingerGeometry
    materials: Materials
    density: Density
    actuator: ActuatorResult
    exoskeleton: ExoskeletonResult
    finger: FingerResult
    fit: Fit
    mass_kg: float


def load_materials(silicone_set: str | None = None, tpu_set: str | None = None) -> Materials:
    """Load the shipped sheets; sets default to those the paper found to fit (set3 and set3)."""
    return Materials(
        silicone=load_material("ecoflex_00_50", silicone_set),
        tpu=load_material("ninjaflex", tpu_set),
        pet=load_material("pet"),
    )


def calibrate(
    geometry: FingerGeometry,
    materials: Materials,
    density: Density,
    *,
    progress: Callable[[], None] = lambda: None,
    beside: Executor | None = None,
) -> Calibration:
    """Run analyses (i), (ii) and (iii) and reduce them.

    With ``beside``, a pool of one process, (i) and (ii) run there while (iii) runs here; the result is the same.

    Raises
    ------
    ValueError
        If too few load steps of one of them converged.
    """
    if beside is None:
        actuator, actuator_mass = run_actuator(geometry, materials, density, progress)
        return complete(geometry, materials, density, actuator, actuator_mass, progress)
    first = beside.submit(run_actuator, geometry, materials, density)
    second = beside.submit(run_exoskeleton, geometry, materials, density)
    finger = run_finger(geometry, materials, density, progress)
    actuator, actuator_mass = first.result()
    exoskeleton, shell_mass = second.result()
    for _ in (*actuator.pressure_pa_gauge[1:], *exoskeleton.load_n):
        progress()
    mass = actuator_mass + shell_mass
    return _reduced(geometry, materials, density, actuator, exoskeleton, finger, mass)


def run_actuator(
    geometry: FingerGeometry, materials: Materials, density: Density, progress: Callable[[], None] = lambda: None
) -> tuple[ActuatorResult, float]:
    """Run analysis (i); return it with the actuator's mass [kg]."""
    model = actuator_model(geometry, materials.silicone, materials.pet, density.actuator)
    volume = 2.0 * model.weights.sum(axis=1)
    ring = model.mesh.material == RING
    mass = volume[ring].sum() * materials.pet.density_kg_m3 + volume[~ring].sum() * materials.silicone.density_kg_m3
    result = analyse_actuator(model, geometry, list(density.pressures_pa_gauge), progress=progress)
    return result, float(mass)


def complete(
    geometry: FingerGeometry,
    materials: Materials,
    density: Density,
    actuator: ActuatorResult,
    actuator_mass_kg: float,
    progress: Callable[[], None] = lambda: None,
) -> Calibration:
    """Run analyses (ii) and (iii) for a geometry whose actuator has been analysed, and reduce all three."""
    exoskeleton, shell_mass = run_exoskeleton(geometry, materials, density, progress)
    finger = run_finger(geometry, materials, density, progress)
    return _reduced(geometry, materials, density, actuator, exoskeleton, finger, actuator_mass_kg + shell_mass)


def run_exoskeleton(
    geometry: FingerGeometry, materials: Materials, density: Density, progress: Callable[[], None] = lambda: None
) -> tuple[ExoskeletonResult, float]:
    """Run analysis (ii); return it with the exoskeleton's mass [kg]."""
    model = exoskeleton_model(geometry, materials.tpu, density.exoskeleton)
    result = analyse_exoskeleton(model, geometry, materials.tpu, progress=progress)
    return result, 2.0 * float(model.weights.sum()) * materials.tpu.density_kg_m3


def run_finger(
    geometry: FingerGeometry, materials: Materials, density: Density, progress: Callable[[], None] = lambda: None
) -> FingerResult:
    """Run analysis (iii)."""
    whole = _finger_model(geometry, materials, density)
    return analyse_finger(whole, geometry, FINGER_PATH, progress=progress)


def _reduced(
    geometry: FingerGeometry,
    materials: Materials,
    density: Density,
    actuator: ActuatorResult,
    exoskeleton: ExoskeletonResult,
    finger: FingerResult,
    mass_kg: float,
) -> Calibration:
    return Calibration(
        geometry=geometry,
        materials=materials,
        density=density,
        actuator=actuator,
        exoskeleton=exoskeleton,
        finger=finger,
        fit=reduce_finger(actuator, exoskeleton, finger),
        mass_kg=mass_kg,
    )


def choose_sector(
    geometry: FingerGeometry, materials: Materials, density: Density, *, progress: Callable[[], None] = lambda: None
) -> Calibration:
    """Find the half angle of the palm sector that gives the stated angle and calibrate with it.

    Secant on the complete finger's angle at the stated pressure; the actuator, which does not change, is run once.

    Raises
    ------
    ValueError
        If no half angle of 40 to 88 degrees gives the tip angle within half a degree.
    """
    actuator, mass = run_actuator(geometry, materials, density, progress)

    def angle_error_deg(sector_deg: float) -> float | None:
        candidate = replace(geometry, sector_half_angle_rad=float(np.deg2rad(sector_deg)))
        model = _finger_model(candidate, materials, density)
        result = analyse_finger(model, candidate, FingerPath((TARGET_PRESSURE_PA_GAUGE,)), progress=progress)
        if result.pressure_pa_gauge[-1] < TARGET_PRESSURE_PA_GAUGE:
            return None
        return float(np.rad2deg(result.tip_angle_rad[-1])) - TARGET_TIP_ANGLE_DEG

    sector = search_sector(angle_error_deg, float(np.rad2deg(geometry.sector_half_angle_rad)))
    chosen = replace(geometry, sector_half_angle_rad=float(np.deg2rad(sector)))
    return complete(chosen, materials, density, actuator, mass, progress)


def search_sector(angle_error_deg: Callable[[float], float | None], start_deg: float) -> float:
    """Return the sector's half angle [degrees], in tenths, at which the error [degrees] vanishes.

    Parameters
    ----------
    angle_error_deg : callable
        Tip angle minus stated angle for a sector [degrees]; None where equilibrium was lost before the stated pressure,
        which a wider sector puts off.
    start_deg : float
        First half angle.

    Raises
    ------
    ValueError
        If none of the sectors tried comes within half a degree; the message lists them.
    """
    tried: list[tuple[float, float]] = []
    lost: list[float] = []
    sector = start_deg
    while len(tried) + len(lost) < TRIALS:
        sector = round(float(np.clip(sector, NARROWEST_DEG, WIDEST_DEG)), 1)
        if sector in (*lost, *(t for t, _ in tried)):
            break
        error = angle_error_deg(sector)
        if error is None:
            lost.append(sector)
            sector += 2.0
            continue
        tried.append((sector, error))
        if abs(error) < CLOSE_DEG:
            break
        sector = _next_sector(tried)
    if tried and abs((best := min(tried, key=lambda pair: abs(pair[1])))[1]) < ACCEPTED_DEG:
        return best[0]
    raise ValueError(
        f"sector_half_angle_rad: no half angle from {NARROWEST_DEG:g} to {WIDEST_DEG:g} degrees gives a tip angle of "
        f"{TARGET_TIP_ANGLE_DEG:g} degrees at 75 kPa; tried "
        + ", ".join(
            [f"{s:.1f} ({e:+.1f} degrees)" for s, e in tried] + [f"{s:.1f} (equilibrium lost before)" for s in lost]
        )
    )


def _next_sector(tried: list[tuple[float, float]]) -> float:
    """Secant step of at most 4 degrees from the last two sectors; a first step of 1 degree to the right side."""
    (x1, e1) = tried[-1]
    if len(tried) == 1:
        return x1 + float(np.copysign(1.0, e1))
    (x0, e0) = tried[-2]
    slope = (e1 - e0) / (x1 - x0)
    # a wider sector bends less: where two tries do not show it, they say nothing of the distance
    return x1 + (float(np.clip(-e1 / slope, -4.0, 4.0)) if slope < 0.0 else float(np.copysign(4.0, e1)))


def _finger_model(geometry: FingerGeometry, materials: Materials, density: Density) -> FingerModel:
    return finger_model(geometry, materials.silicone, materials.pet, materials.tpu, MESHES[density.name])
