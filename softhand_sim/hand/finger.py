"""One finger in MJCF: three hinges, polynomial joint springs, and the actuator as a pressure-driven tendon."""

from typing import Any

import numpy as np
from dm_control import mjcf

from softhand_sim.calibration import FingerCalibration

# choice: just above what the calibrated curve holds, so that ctrl never asks for an extrapolation
JOINT_RANGE_RAD = (-0.35, 1.4)
# choice: small beside a phalanx about its hinge (1e-6 kg m2); a study lost four of 18 grasps without it
ARMATURE_KG_M2 = 1e-6
PAD_RADIUS_M = 0.005
# choice: about what the flexure strips stand out of the tube (strip 3.6 mm thick, tube wall 2 mm)
PAD_HEIGHT_M = 0.0016


def phalanx_spans_m(calibration: FingerCalibration) -> list[tuple[float, float]]:
    """Start and end of each moving phalanx along the straight finger, 3 pairs (m)."""
    joints = list(calibration.finger.joint_position_m)
    return list(zip(joints, [*joints[1:], calibration.finger.length_m], strict=True))


def add_finger(palm: Any, name: str, calibration: FingerCalibration) -> list[Any]:
    """Add the three phalanges of a finger to the body `palm`, whose frame here is the finger's own.

    The hinges lie on the flexure's neutral line, ``hinge_offset_m`` to the palm side of the tube's axis, so a
    rotation opens the dorsal gap as in the printed finger. Returns the three bodies, proximal first.
    """
    finger = calibration.finger
    spans = phalanx_spans_m(calibration)
    bodies = []
    parent, parent_start = palm, 0.0
    for joint, (start, end) in zip(calibration.joints, spans, strict=True):
        offset = finger.hinge_offset_m if parent is palm else 0.0
        body = parent.add("body", name=f"{name}_{joint.name}", pos=(offset, 0.0, start - parent_start))
        body.add(
            "joint",
            name=f"{name}_{joint.name}",
            type="hinge",
            axis=(0, 1, 0),
            range=JOINT_RANGE_RAD,
            stiffness=joint.polynomial,
            damping=joint.damping_n_m_s_per_rad,
            armature=ARMATURE_KG_M2,
        )
        mass = finger.mass_kg * (end - start) / finger.length_m
        _add_phalanx_geoms(body, f"{name}_{joint.name}", end - start, mass, calibration)
        bodies.append(body)
        parent, parent_start = body, start
    bodies[-1].add("site", name=f"{name}_tip", pos=(-finger.hinge_offset_m, 0, spans[-1][1] - spans[-1][0]))
    _add_actuator(palm.root, name, calibration)
    return bodies


def _add_phalanx_geoms(body: Any, name: str, length_m: float, mass_kg: float, calibration: FingerCalibration) -> None:
    """Tube (structure) and pad (soft, first to touch) of one phalanx; both collide, only the tube has mass."""
    finger = calibration.finger
    radius, axis_x = finger.outer_radius_m, -finger.hinge_offset_m
    tube_end = length_m - radius
    body.add(
        "geom",
        name=f"{name}_tube",
        dclass="tube",
        type="capsule",
        size=(radius,),
        fromto=(axis_x, 0, min(radius, tube_end), axis_x, 0, tube_end),
        mass=mass_kg,
    )
    # the pad stands out of the tube by as much as the flexure strip does, so it takes the contact
    pad_x = axis_x + radius + PAD_HEIGHT_M - PAD_RADIUS_M
    body.add(
        "geom",
        name=f"{name}_pad",
        dclass="pad",
        type="capsule",
        size=(PAD_RADIUS_M,),
        fromto=(pad_x, 0, PAD_RADIUS_M, pad_x, 0, length_m - PAD_RADIUS_M),
    )


def _add_actuator(root: mjcf.RootElement, name: str, calibration: FingerCalibration) -> None:
    """Tendon of length delta = sum r_i theta_i, its wall spring N(delta), and the pressure force p dV/d(delta)."""
    tendon = root.tendon.add(
        "fixed",
        name=f"{name}_actuator",
        springlength=(0.0, 0.0),
        stiffness=calibration.tendon.polynomial,
    )
    for joint in calibration.joints:
        tendon.add("joint", joint=f"{name}_{joint.name}", coef=joint.offset_m)
    chamber = calibration.chamber
    root.actuator.add(
        "general",
        name=f"{name}_pressure",
        tendon=tendon,
        gaintype="affine",
        gainprm=(chamber.area_m2, chamber.area_slope_m, 0.0),
        biastype="none",
        ctrllimited=True,
        ctrlrange=(0.0, float(np.max(calibration.curve.pressure_pa_gauge))),
    )
    root.sensor.add("tendonpos", name=f"{name}_elongation", tendon=tendon)
