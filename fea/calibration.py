"""Calibration of the finger: run the three analyses and reduce them; find the flexure that gives the stated angle."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fea.actuator import RING, ActuatorResult, actuator_model, analyse_actuator
from fea.density import Density
from fea.exoskeleton import ExoskeletonResult, analyse_exoskeleton, exoskeleton_model
from fea.finger import MESHES, FingerModel, FingerResult, analyse_finger, finger_model
from fea.geometry import FingerGeometry
from fea.identification import Fit, reduce_finger
from fea.materials import Material, load_material

TARGET_TIP_ANGLE_DEG, TARGET_PRESSURE_PA_GAUGE = 95.0, 75e3
"""The one stated angle: Alves et al., section 4.2."""
FINGER_PRESSURES_PA_GAUGE = tuple(
    1e3 * p for p in (2, 5, 8, 12.5, 17, 21.5, 28.25, 36.25, 44.25, 52.25, 60.25, 68.25, 75, 80)
)
"""Choice: load steps that the solver takes by itself, so that none is cut short (77 iterations; round ones took 94)."""
THINNEST_M, THICKEST_M = 2.0e-3, 8.0e-3
"""Range of the search for the flexure: the paper's minimum wall, and a choice."""
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
    geometry: FingerGeometry, materials: Materials, density: Density, *, progress: Callable[[], None] = lambda: None
) -> Calibration:
    """Run analyses (i), (ii) and (iii) and reduce them.

    Raises
    ------
    ValueError
        If too few load steps of one of them converged.
    """
    actuator, actuator_mass = run_actuator(geometry, materials, density, progress)
    return complete(geometry, materials, density, actuator, actuator_mass, progress)


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
    model = exoskeleton_model(geometry, materials.tpu, density.exoskeleton)
    exoskeleton = analyse_exoskeleton(model, geometry, materials.tpu, progress=progress)
    shell = 2.0 * float(model.weights.sum()) * materials.tpu.density_kg_m3
    whole = _finger_model(geometry, materials, density)
    finger = analyse_finger(whole, geometry, list(FINGER_PRESSURES_PA_GAUGE), progress=progress)
    return Calibration(
        geometry=geometry,
        materials=materials,
        density=density,
        actuator=actuator,
        exoskeleton=exoskeleton,
        finger=finger,
        fit=reduce_finger(actuator, exoskeleton, finger),
        mass_kg=actuator_mass_kg + shell,
    )


def choose_flexure(
    geometry: FingerGeometry, materials: Materials, density: Density, *, progress: Callable[[], None] = lambda: None
) -> Calibration:
    """Find the flexure thickness that gives the stated angle and calibrate with it.

    Secant on the complete finger's angle at the stated pressure; the actuator, which does not change, is run once.

    Raises
    ------
    ValueError
        If no thickness of 2 to 8 mm gives the angle within half a degree.
    """
    actuator, mass = run_actuator(geometry, materials, density, progress)

    def angle_error_deg(thickness_m: float) -> float | None:
        candidate = replace(geometry, flexure_thickness_m=thickness_m)
        model = _finger_model(candidate, materials, density)
        result = analyse_finger(model, candidate, [TARGET_PRESSURE_PA_GAUGE], progress=progress)
        if result.pressure_pa_gauge[-1] < TARGET_PRESSURE_PA_GAUGE:
            return None
        return float(np.rad2deg(result.tip_angle_rad[-1])) - TARGET_TIP_ANGLE_DEG

    thickness = search_thickness(angle_error_deg, geometry.flexure_thickness_m)
    chosen = replace(geometry, flexure_thickness_m=thickness)
    return complete(chosen, materials, density, actuator, mass, progress)


def search_thickness(angle_error_deg: Callable[[float], float | None], start_m: float) -> float:
    """Return the flexure thickness [m], in hundredths of a millimetre, at which the error [degrees] vanishes.

    Parameters
    ----------
    angle_error_deg : callable
        Angle minus stated angle for a thickness [m]; None where equilibrium was lost before the stated pressure,
        which a thicker flexure puts off.
    start_m : float
        First thickness.

    Raises
    ------
    ValueError
        If none of the tried thicknesses comes within half a degree; the message lists them.
    """
    tried: list[tuple[float, float]] = []
    lost: list[float] = []
    thickness = start_m
    while len(tried) + len(lost) < TRIALS:
        thickness = round(float(np.clip(thickness, THINNEST_M, THICKEST_M)), 5)
        if thickness in (*lost, *(t for t, _ in tried)):
            break
        error = angle_error_deg(thickness)
        if error is None:
            lost.append(thickness)
            thickness += 0.3e-3
            continue
        tried.append((thickness, error))
        if abs(error) < CLOSE_DEG:
            break
        thickness = _next_thickness(tried)
    if tried and abs((best := min(tried, key=lambda pair: abs(pair[1])))[1]) < ACCEPTED_DEG:
        return best[0]
    raise ValueError(
        f"flexure_thickness_m: no value from 2 to 8 mm gives {TARGET_TIP_ANGLE_DEG:g} degrees at 75 kPa; tried "
        + ", ".join(
            [f"{1e3 * t:.2f} mm ({e:+.1f} degrees)" for t, e in tried]
            + [f"{1e3 * t:.2f} mm (equilibrium lost before)" for t in lost]
        )
    )


def _next_thickness(tried: list[tuple[float, float]]) -> float:
    """Secant step of at most 0.6 mm from the last two thicknesses; a first step of 0.2 mm to the right side."""
    (x1, e1) = tried[-1]
    if len(tried) == 1:
        return x1 + float(np.copysign(0.2e-3, e1))
    (x0, e0) = tried[-2]
    slope = (e1 - e0) / (x1 - x0)
    # a thicker flexure bends less: where two tries do not show it, they say nothing of the distance
    return x1 + (float(np.clip(-e1 / slope, -0.6e-3, 0.6e-3)) if slope < 0.0 else float(np.copysign(0.6e-3, e1)))


def _finger_model(geometry: FingerGeometry, materials: Materials, density: Density) -> FingerModel:
    return finger_model(geometry, materials.silicone, materials.pet, materials.tpu, MESHES[density.name])
