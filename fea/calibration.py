"""Calibration of the finger: run both analyses, reduce them, and write the one file that the runtime reads."""

import json
import os
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from fea.actuator import RING, ActuatorResult, actuator_model, analyse_actuator
from fea.density import Density
from fea.exoskeleton import LOADS_N, ExoskeletonResult, analyse_exoskeleton, exoskeleton_model
from fea.geometry import JOINT_NAMES, FingerGeometry, choices
from fea.linear_solver import solver_name
from fea.materials import Material, load_material
from fea.surrogate import Fit, Surrogate, reduce_finger

SCHEMA, SCHEMA_VERSION = "softhand-sim/finger-calibration", 1
TARGET_TIP_ANGLE_DEG, TARGET_PRESSURE_PA_GAUGE = 95.0, 75e3
"""The one stated angle: Alves et al., section 4.2."""
CURVE_PRESSURES_PA_GAUGE = tuple(2500.0 * k for k in range(33))
DAMPING_RATIO = 0.5
"""Choice: printed TPU and silicone are strongly damped; the finger settles in about one swing."""


@dataclass(frozen=True, kw_only=True)
class Materials:
    """The three materials of a finger."""

    silicone: Material
    tpu: Material
    pet: Material


@dataclass(frozen=True, kw_only=True, eq=False)
class Calibration:
    """Both analyses and their reduction for one geometry."""

    geometry: FingerGeometry
    materials: Materials
    density: Density
    actuator: ActuatorResult
    exoskeleton: ExoskeletonResult
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
    """Run analyses (i) and (ii) and reduce them.

    Raises
    ------
    ValueError
        If too few load steps converged.
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
    """Run analysis (ii) for a geometry whose actuator has been analysed, and reduce both."""
    model = exoskeleton_model(geometry, materials.tpu, density.exoskeleton)
    exoskeleton = analyse_exoskeleton(model, geometry, materials.tpu, progress=progress)
    shell = 2.0 * float(model.weights.sum()) * materials.tpu.density_kg_m3
    return Calibration(
        geometry=geometry,
        materials=materials,
        density=density,
        actuator=actuator,
        exoskeleton=exoskeleton,
        fit=reduce_finger(geometry, actuator, exoskeleton),
        mass_kg=actuator_mass_kg + shell,
    )


def choose_flexure(
    geometry: FingerGeometry, materials: Materials, density: Density, *, progress: Callable[[], None] = lambda: None
) -> Calibration:
    """Find the flexure thickness that gives the stated angle: secant on analysis (ii), the actuator is run once.

    Raises
    ------
    ValueError
        If no thickness of 2 to 8 mm gives the angle within half a degree.
    """
    actuator, mass = run_actuator(geometry, materials, density, progress)
    tried: list[tuple[float, float]] = []
    thickness = geometry.flexure_thickness_m
    for _ in range(8):
        candidate = replace(geometry, flexure_thickness_m=round(thickness, 5))
        result = complete(candidate, materials, density, actuator, mass, progress)
        error = result.fit.surrogate.tip_angle_deg(TARGET_PRESSURE_PA_GAUGE) - TARGET_TIP_ANGLE_DEG
        tried.append((candidate.flexure_thickness_m, error))
        if abs(error) < 0.1:
            return result
        if len(tried) == 1:
            thickness += 0.2e-3 if error > 0.0 else -0.2e-3
        else:
            (x0, e0), (x1, e1) = tried[-2:]
            slope = (e1 - e0) / (x1 - x0)
            thickness = x1 - float(np.clip(e1 / slope, -0.6e-3, 0.6e-3))
        thickness = float(np.clip(thickness, 2.0e-3, 8.0e-3))
        if any(abs(thickness - t) < 5e-6 for t, _ in tried):
            break
    best = min(tried, key=lambda pair: abs(pair[1]))
    if abs(best[1]) < 0.5:
        return complete(replace(geometry, flexure_thickness_m=best[0]), materials, density, actuator, mass, progress)
    raise ValueError(
        f"flexure_thickness_m: no value from 2 to 8 mm gives {TARGET_TIP_ANGLE_DEG:g} degrees at 75 kPa; tried "
        + ", ".join(f"{1e3 * t:.2f} mm ({e:+.1f} degrees)" for t, e in tried)
    )


def artifact(c: Calibration) -> dict[str, Any]:
    """Return the calibration file's contents; deterministic, SI units, JSON ready."""
    s = c.fit.surrogate
    law = s.joint
    damping = joint_damping(c)
    curve = np.rad2deg([s.angles(p) for p in CURVE_PRESSURES_PA_GAUGE])
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "geometry": c.geometry.as_dict(),
        "finger": {
            "length_m": c.geometry.finger_length_m,
            "joint_position_m": list(c.geometry.joint_position_m),
            "outer_radius_m": c.geometry.tube_outer_radius_m,
            "mass_kg": c.mass_kg,
            "hinge_offset_m": s.offset_m[0],
        },
        "joints": [
            {
                "name": name,
                "offset_m": offset,
                "stiffness_n_m_per_rad": law.a,
                "stiffness_n_m_per_rad2": law.b,
                "stiffness_n_m_per_rad3": law.c,
                "damping_n_m_s_per_rad": d,
            }
            for name, offset, d in zip(JOINT_NAMES, s.offset_m, damping, strict=True)
        ],
        "tendon": {
            "stiffness_n_per_m": s.tendon.a,
            "stiffness_n_per_m2": s.tendon.b,
            "stiffness_n_per_m3": s.tendon.c,
        },
        "chamber": asdict(s.chamber),
        "curve": {
            "pressure_pa_gauge": list(CURVE_PRESSURES_PA_GAUGE),
            "tip_angle_deg": curve.sum(axis=1).tolist(),
            "joint_angle_deg": curve.tolist(),
        },
        "targets_used": {
            "tip_angle_deg": TARGET_TIP_ANGLE_DEG,
            "pressure_pa_gauge": TARGET_PRESSURE_PA_GAUGE,
            "dimension_chosen": "flexure_thickness_m",
            "source": "Alves et al., section 4.2; the only measured value of the complete finger that was used",
        },
        "fit_rmse": dict(c.fit.rmse),
        "fea": {"actuator": _actuator_table(c.actuator), "exoskeleton": _exoskeleton_table(c.exoskeleton)},
        "provenance": _provenance(c),
    }


def joint_damping(c: Calibration) -> list[float]:
    """Viscous damping of each joint [N m s/rad] from the damping ratio, with the finger beyond it as a uniform rod."""
    stiffness, length = c.fit.surrogate.joint.a, c.geometry.finger_length_m
    beyond = [length - z for z in c.geometry.joint_position_m]
    inertia = [c.mass_kg * b / length * b**2 / 3.0 for b in beyond]
    return [2.0 * DAMPING_RATIO * float(np.sqrt(stiffness * i)) for i in inertia]


def write_artifact(c: Calibration, path: Path) -> None:
    """Write the calibration file in one piece."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    partial.write_text(json.dumps(artifact(c), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    partial.replace(path)


def _actuator_table(a: ActuatorResult) -> dict[str, Any]:
    return {
        "pressure_pa_gauge": a.pressure_pa_gauge.tolist(),
        "elongation_ratio": a.elongation.tolist(),
        "lengthening_m": a.lengthening_m.tolist(),
        "chamber_volume_m3": a.volume_m3.tolist(),
        "thrust_area_m2": a.thrust_area_m2.tolist(),
        "radial_growth_m": a.radial_growth_m.tolist(),
        "max_principal_stretch": a.max_stretch.tolist(),
        "status": a.status.value,
        "dofs": a.dofs,
        "elements": a.elements,
    }


def _exoskeleton_table(x: ExoskeletonResult) -> dict[str, Any]:
    return {
        "load_n": x.load_n.tolist(),
        "tip_deflection_m": x.tip_deflection_m.tolist(),
        "joint_angle_rad": x.angle_rad.tolist(),
        "joint_moment_n_m": x.moment_n_m.tolist(),
        "axis_lengthening_m": x.lengthening_m.tolist(),
        "status": x.status.value,
        "dofs": x.dofs,
        "elements": x.elements,
    }


def _provenance(c: Calibration) -> dict[str, Any]:
    surrogate: Surrogate = c.fit.surrogate
    return {
        "density": c.density.name,
        "mesh": {"actuator": asdict(c.density.actuator), "exoskeleton": asdict(c.density.exoskeleton)},
        "element": "10-node tetrahedron, four points, element-mean dilatation (P2/P0), curved edges",
        "linear_solver": solver_name(),
        "versions": {name: version(name) for name in ("softhand-sim", "scikit-fem", "numpy", "scipy")},
        "materials": {
            m.name: {"set": m.parameter_set, "source": m.source, "parameters": dict(m.parameters)}
            for m in (c.materials.silicone, c.materials.tpu, c.materials.pet)
        },
        "loads_n": list(LOADS_N),
        "dimensions": choices(),
        "bending_of_actuator_n_m_per_rad": surrogate.bending_n_m_per_rad,
        "flexure_n_m_per_rad": surrogate.flexure.a,
        "ideal_ring_area_m2": pi * c.geometry.ring_radius_m**2,
        "choices": {
            "load_direction": "the exoskeleton's load and weight act in the closing direction; the figure is unknown",
            "load_place": "dead force spread over the distal joint's flexure",
            "one_torque_law": "proximal and middle joints are fitted together: their flexures are identical",
            "thrust_area": "A + B delta is dV/d(delta) at constant pressure; V leaves out bulging between the rings, "
            "which does no work on the finger (fit_rmse.chamber_volume_m3 is its size)",
            "actuator_bending": "beam theory from the axial law over a gap plus one outer radius; added to the joints",
            "damping": f"damping ratio {DAMPING_RATIO} of each joint with the finger beyond it as a rod",
        },
    }
