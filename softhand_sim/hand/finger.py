"""One finger in MJCF: three hinges, polynomial joint springs, and the actuator as a pressure-driven tendon."""

from typing import Any

import numpy as np
from dm_control import mjcf

from softhand_sim.calibration import JOINT_RANGE_RAD, FingerCalibration

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
    bodies, path = [], []
    parent, parent_start = palm, 0.0
    for joint, (start, end) in zip(calibration.joints, spans, strict=True):
        offset = finger.hinge_offset_m if parent is palm else 0.0
        hinge = np.array([offset, 0.0, start - parent_start])
        body = parent.add("body", name=f"{name}_{joint.name}", pos=hinge)
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
        # the line between these two points is the tendon at this joint, with the arm r(q) of the calibration
        past = np.array([-joint.offset_m, 0.0, 2.0 * joint.offset_slope_m_per_rad])
        path.append(parent.add("site", name=f"{name}_{joint.name}_from", dclass="tendon", pos=hinge + past))
        path.append(body.add("site", name=f"{name}_{joint.name}_to", dclass="tendon", pos=past * (1.0, 0.0, -1.0)))
        bodies.append(body)
        parent, parent_start = body, start
    bodies[-1].add("site", name=f"{name}_tip", pos=(-finger.hinge_offset_m, 0, spans[-1][1] - spans[-1][0]))
    _add_actuator(palm.root, name, calibration, path)
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


def straight_length_m(calibration: FingerCalibration) -> float:
    """Return the length of the tendon's path when the finger is straight [m]: it goes back and forth at each joint."""
    past = [2.0 * joint.offset_slope_m_per_rad for joint in calibration.joints]
    offset = [joint.offset_m for joint in calibration.joints]
    between = zip(np.diff(calibration.finger.joint_position_m), past[:-1], past[1:], np.diff(offset), strict=True)
    return 2.0 * sum(past) + sum(float(np.hypot(span + a + b, step)) for span, a, b, step in between)


def _add_actuator(root: mjcf.RootElement, name: str, calibration: FingerCalibration, path: list[Any]) -> None:
    """Tendon that is delta shorter than when straight, its wall spring N(delta), the pressure force p dV/d(delta).

    The polynomial is of the tendon's own change of length, -delta, hence the sign of its second coefficient; likewise
    gear -1 makes the actuators' forces those along delta. The engine takes the length at rest for the spring's.
    """
    wall = calibration.tendon
    tendon = root.tendon.add(
        "spatial",
        name=f"{name}_actuator",
        stiffness=(wall.stiffness_n_per_m, -wall.stiffness_n_per_m2, wall.stiffness_n_per_m3),
        width=0.0008,
    )
    for site in path:
        tendon.add("site", site=site)
    chamber = calibration.chamber
    highest = float(np.max(calibration.curve.pressure_pa_gauge))
    root.actuator.add(
        "general",
        name=f"{name}_pressure",
        tendon=tendon,
        gear=(-1.0,),
        gaintype="affine",
        gainprm=(chamber.area_m2 + chamber.area_slope_m * straight_length_m(calibration), chamber.area_slope_m, 0.0),
        biastype="none",
        ctrllimited=True,
        ctrlrange=(0.0, highest),
    )
    # friction and relaxation: what the engine has no element for is never more than the largest thrust
    stretched = sum(joint.elongation_m_at(JOINT_RANGE_RAD[1]) for joint in calibration.joints)
    most = highest * chamber.area_m2_at(stretched)
    root.actuator.add("motor", name=f"{name}_loss", tendon=tendon, gear=(-1.0,), ctrlrange=(-most, most))
    root.sensor.add("tendonpos", name=f"{name}_length", tendon=tendon)
