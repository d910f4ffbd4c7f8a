"""One finger in MJCF: three hinges, polynomial joint springs, and the actuator as a pressure-driven tendon."""

from typing import Any

import numpy as np
from dm_control import mjcf

from softhand_sim.calibration import JOINT_RANGE_RAD, FingerCalibration
from softhand_sim.hand.chain import Hinge, hinges

# choice: small beside a phalanx about its hinge (1e-6 kg m2); a study lost four of 18 grasps without it
ARMATURE_KG_M2 = 1e-6
PAD_RADIUS_M = 0.005
# choice: about what the flexure strips stand out of the tube (strip 3.6 mm thick, tube wall 2 mm)
PAD_HEIGHT_M = 0.0016


def add_finger(palm: Any, name: str, calibration: FingerCalibration, links: int | None = None) -> list[Any]:
    """Add the three phalanges of a finger to the body `palm`, whose frame here is the finger's own.

    The hinges lie on the flexure's neutral line, ``hinge_offset_m`` to the palm side of the tube's axis, so a
    rotation opens the dorsal gap as in the printed finger. With ``links`` each joint is a chain of hinges (`chain`).
    Returns the three phalanges, proximal first.
    """
    finger = calibration.finger
    chain = hinges(calibration, links)
    ends = [*(hinge.position_m for hinge in chain[1:]), finger.length_m]
    phalanges, path = [], []
    parent, parent_start = palm, 0.0
    for hinge, end in zip(chain, ends, strict=True):
        joint, start = hinge.law, hinge.position_m
        offset = finger.hinge_offset_m if parent is palm else 0.0
        place = np.array([offset, 0.0, start - parent_start])
        body = parent.add("body", name=f"{name}_{hinge.name}", pos=place)
        body.add(
            "joint",
            name=f"{name}_{hinge.name}",
            type="hinge",
            axis=(0, 1, 0),
            range=tuple(limit * hinge.share for limit in JOINT_RANGE_RAD),
            stiffness=joint.polynomial,
            damping=joint.damping_n_m_s_per_rad,
            armature=ARMATURE_KG_M2,
        )
        mass = finger.mass_kg * (end - start) / finger.length_m
        if hinge.name == joint.name:
            _add_phalanx_geoms(body, f"{name}_{hinge.name}", end - start, mass, calibration)
            phalanges.append(body)
        else:
            _add_slice_inertia(body, end - start, mass, calibration)
        # the line between these two points is the tendon at this joint, with the arm r(q) of the calibration
        past = np.array([-joint.offset_m, 0.0, 2.0 * joint.offset_slope_m_per_rad])
        path.append(parent.add("site", name=f"{name}_{hinge.name}_from", dclass="tendon", pos=place + past))
        path.append(body.add("site", name=f"{name}_{hinge.name}_to", dclass="tendon", pos=past * (1.0, 0.0, -1.0)))
        parent, parent_start = body, start
    phalanges[-1].add("site", name=f"{name}_tip", pos=(-finger.hinge_offset_m, 0, ends[-1] - chain[-1].position_m))
    _add_actuator(palm.root, name, calibration, path, chain)
    return phalanges


def _add_slice_inertia(body: Any, length_m: float, mass_kg: float, calibration: FingerCalibration) -> None:
    """Mass of the slice of a flexure between two hinges, as a disc of the tube's radius; it has no shape."""
    radius = calibration.finger.outer_radius_m
    across = 0.25 * mass_kg * radius**2 + mass_kg * length_m**2 / 12.0
    body.add(
        "inertial", mass=mass_kg, pos=(0, 0, 0.5 * length_m), diaginertia=(across, across, 0.5 * mass_kg * radius**2)
    )


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


def straight_length_m(chain: tuple[Hinge, ...]) -> float:
    """Return the length of the tendon's path when the finger is straight [m]: it goes back and forth at each hinge."""
    past = [2.0 * hinge.law.offset_slope_m_per_rad for hinge in chain]
    offset = [hinge.law.offset_m for hinge in chain]
    spans = np.diff([hinge.position_m for hinge in chain])
    between = zip(spans, past[:-1], past[1:], np.diff(offset), strict=True)
    return 2.0 * sum(past) + sum(float(np.hypot(span + a + b, step)) for span, a, b, step in between)


def _add_actuator(
    root: mjcf.RootElement, name: str, calibration: FingerCalibration, path: list[Any], chain: tuple[Hinge, ...]
) -> None:
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
        gainprm=(chamber.area_m2 + chamber.area_slope_m * straight_length_m(chain), chamber.area_slope_m, 0.0),
        biastype="none",
        ctrllimited=True,
        ctrlrange=(0.0, highest),
    )
    # friction and relaxation: what the engine has no element for is never more than the largest thrust
    stretched = sum(joint.elongation_m_at(JOINT_RANGE_RAD[1]) for joint in calibration.joints)
    most = highest * chamber.area_m2_at(stretched)
    root.actuator.add("motor", name=f"{name}_loss", tendon=tendon, gear=(-1.0,), ctrlrange=(-most, most))
    root.sensor.add("tendonpos", name=f"{name}_length", tendon=tendon)
