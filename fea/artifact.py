"""The calibration file's contents: the surrogate, what it was identified from, and where everything came from."""

import json
import os
from dataclasses import asdict
from importlib.metadata import version
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from fea.actuator import ActuatorResult
from fea.calibration import TARGET_PRESSURE_PA_GAUGE, TARGET_TIP_ANGLE_DEG, Calibration
from fea.checkpoint import content_hash
from fea.compiled import kernel_name
from fea.exoskeleton import LOADS_N, ExoskeletonResult
from fea.finger import CONTACT, MESHES, FingerResult
from fea.geometry import JOINT_NAMES, choices
from fea.identification import fitted_rows
from fea.linear_solver import solver_name

SCHEMA, SCHEMA_VERSION = "softhand-sim/finger-calibration", 3
CURVE_PRESSURES_PA_GAUGE = tuple(2500.0 * k for k in range(33))
"""Pressures of the curve; those above what the complete finger reached are left out."""
DAMPING_RATIO = 0.5
"""Choice: printed TPU and silicone are strongly damped; the finger settles in about one swing."""


def artifact(c: Calibration) -> dict[str, Any]:
    """Return the calibration file's contents; deterministic, SI units, JSON ready.

    Its last field, ``content_sha256``, is the SHA-256 of the others (:func:`fea.checkpoint.content_hash`).
    """
    contents = _contents(c)
    return contents | {"content_sha256": content_hash(contents)}


def _contents(c: Calibration) -> dict[str, Any]:
    s = c.fit.surrogate
    pressures = [p for p in CURVE_PRESSURES_PA_GAUGE if p <= c.finger.pressure_pa_gauge.max()]
    curve = np.rad2deg([s.angles(p) for p in pressures])
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "geometry": c.geometry.as_dict(),
        "finger": {
            "length_m": c.geometry.finger_length_m,
            "joint_position_m": list(c.geometry.joint_position_m),
            "outer_radius_m": c.geometry.tube_outer_radius_m,
            "mass_kg": c.mass_kg,
            "hinge_offset_m": c.fit.flexure.offset_m,
        },
        "joints": [
            {
                "name": name,
                "offset_m": s.arm.offset_m,
                "offset_slope_m_per_rad": s.arm.offset_slope_m_per_rad,
                "stiffness_n_m_per_rad": law.a,
                "stiffness_n_m_per_rad2": law.b,
                "stiffness_n_m_per_rad3": law.c,
                "damping_n_m_s_per_rad": d,
            }
            for name, law, d in zip(JOINT_NAMES, s.joints, joint_damping(c), strict=True)
        ],
        "tendon": {
            "stiffness_n_per_m": s.tendon.a,
            "stiffness_n_per_m2": s.tendon.b,
            "stiffness_n_per_m3": s.tendon.c,
        },
        "chamber": asdict(s.chamber),
        "sliding": asdict(s.sliding),
        "curve": {
            "pressure_pa_gauge": pressures,
            "tip_angle_deg": curve.sum(axis=1).tolist(),
            "joint_angle_deg": curve.tolist(),
        },
        "targets_used": {
            "tip_angle_deg": TARGET_TIP_ANGLE_DEG,
            "pressure_pa_gauge": TARGET_PRESSURE_PA_GAUGE,
            "dimension_chosen": "sector_half_angle_rad",
            "source": "Alves et al., section 4.2; the only measured value of the complete finger that was used",
        },
        "fit_rmse": dict(c.fit.rmse),
        "fea": {
            "actuator": _actuator_table(c.actuator),
            "exoskeleton": _exoskeleton_table(c.exoskeleton),
            "finger": _finger_table(c.finger),
        },
        "provenance": _provenance(c),
    }


def joint_damping(c: Calibration) -> list[float]:
    """Viscous damping of each joint [N m s/rad] from the damping ratio, with the finger beyond it as a uniform rod."""
    stiffness, length = [law.a for law in c.fit.surrogate.joints], c.geometry.finger_length_m
    beyond = [length - z for z in c.geometry.joint_position_m]
    inertia = [c.mass_kg * b / length * b**2 / 3.0 for b in beyond]
    return [2.0 * DAMPING_RATIO * float(np.sqrt(a * i)) for a, i in zip(stiffness, inertia, strict=True)]


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


def _finger_table(f: FingerResult) -> dict[str, Any]:
    return {
        "branch": list(f.branch),
        "fitted": fitted_rows(f).tolist(),
        "pressure_pa_gauge": f.pressure_pa_gauge.tolist(),
        "joint_angle_rad": f.joint_angle_rad.tolist(),
        "tip_angle_rad": f.tip_angle_rad.tolist(),
        "chamber_volume_m3": f.volume_m3.tolist(),
        "contact_force_n": f.contact_force_n.tolist(),
        "status": f.status.value,
        "dofs": f.dofs,
        "elements": f.elements,
    }


def _provenance(c: Calibration) -> dict[str, Any]:
    flexure = c.fit.flexure
    return {
        "density": c.density.name,
        "mesh": {
            "actuator": asdict(c.density.actuator),
            "exoskeleton": asdict(c.density.exoskeleton),
            "finger": asdict(MESHES[c.density.name]),
        },
        "element": "10-node tetrahedron, four points, element-mean dilatation (P2/P0), curved edges",
        "element_kernels": kernel_name(),
        "linear_solver": solver_name(),
        "versions": {name: version(name) for name in ("softhand-sim", "scikit-fem", "numpy", "scipy")},
        "materials": {
            m.name: {"set": m.parameter_set, "source": m.source, "parameters": dict(m.parameters)}
            for m in (c.materials.silicone, c.materials.tpu, c.materials.pet)
        },
        "contact": asdict(CONTACT),
        "loads_n": list(LOADS_N),
        "dimensions": choices(),
        "flexure": {
            "offset_m": flexure.offset_m,
            "stiffness_n_m_per_rad": flexure.law.a,
            "stiffness_n_m_per_rad2": flexure.law.b,
            "stiffness_n_m_per_rad3": flexure.law.c,
        },
        "ideal_ring_area_m2": pi * c.geometry.ring_radius_m**2,
        "choices": {
            "load_direction": "the exoskeleton's load and weight act in the closing direction; the figure is unknown",
            "load_place": "dead force spread over the distal joint's flexure",
            "thrust_area": "A + B delta is dV/d(delta) at constant pressure; the bulging between the rings, C p with "
            "one C, takes gas and does no work on the finger",
            "offset": "arm common to the joints, that of a line through two points: least squares on the lengthening "
            "that the finger's chamber volume shows (fit_rmse.finger_lengthening_m)",
            "joints": "torque of the thrust at the angles of the complete finger, loading with friction: the "
            "flexure alone plus a monotone law for the actuator's share",
            "sliding": "friction of the actuator in the exoskeleton, a share of the thrust for each radian of bending, "
            "from the pressures at which the finger stands at the same angle on both ways",
            "fitted_states": "every second one of the complete finger on each way, from its last (fea.finger.fitted); "
            "fit_rmse.finger_joint_angle_rad, finger_tip_angle_rad and finger_volume_m3 are over the others, loading",
            "hinge": "hinge_offset_m is the flexure's own arm (the tube's axis), not that of the thrust",
            "damping": f"damping ratio {DAMPING_RATIO} of each joint with the finger beyond it as a rod",
        },
    }
