"""The hand: palm on a driven wrist, five fingers, pressure actuators."""

from typing import Any

import numpy as np
from dm_control import mjcf
from scipy.spatial.transform import Rotation

from softhand_sim.calibration import FingerCalibration
from softhand_sim.contact import ContactSettings
from softhand_sim.elements import FINGERS
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.chain import hinges
from softhand_sim.hand.finger import add_finger

WRIST_SLIDES = ("wrist_x", "wrist_y", "wrist_z")
WRIST_HINGES = ("wrist_yaw", "wrist_pitch", "wrist_roll")
WRIST = WRIST_SLIDES + WRIST_HINGES
# choice: a workspace of half a metre either way, from the table up to 0.8 m; more than a full turn, so that no
# grasp pose lies on a limit
SLIDE_RANGE_M = ((-0.5, 0.5), (-0.5, 0.5), (-0.1, 0.8))
HINGE_RANGE_RAD = (-4.0, 4.0)
# choice: clear of a table at z = 0 when the model is loaded; `ref` makes wrist_z the palm's height all the same
START_HEIGHT_M = 0.25
# choice: a small arm; keeps a wrist that is commanded far away from being thrown there
SERVO_FORCE_N, SERVO_TORQUE_N_M = 50.0, 5.0
# the palm looks down when all wrist angles are zero
PALM_DOWN = (0.0, 1.0, 0.0, 0.0)


def add_hand(
    root: mjcf.RootElement,
    calibration: FingerCalibration,
    anatomy: HandAnatomy,
    contact: ContactSettings,
    links: int | None = None,
) -> Any:
    """Add the hand to `root`'s world and return its palm body (frame: x to the fingers, z out of the palm).

    With ``links`` each finger is a chain of that many hinges (`softhand_sim.hand.chain`) in place of three.
    """
    add_defaults(root, contact)
    palm = root.worldbody.add("body", name="palm", pos=(0, 0, START_HEIGHT_M), quat=PALM_DOWN)
    _add_wrist(root, palm, anatomy)
    moving = sum(_moving_mass_kg(calibration, links) for _ in FINGERS)
    palm_mass = anatomy.hand_mass_kg - moving
    if palm_mass <= 0.0:
        raise ValueError(
            f"hand_mass_kg: {anatomy.hand_mass_kg} must be above the {moving:.4f} kg of five sets of phalanges"
        )
    half = [0.5 * side for side in anatomy.palm_size_m]
    palm.add("geom", name="palm", dclass="palm", type="box", size=half, pos=(0, 0, -half[2]), mass=palm_mass)
    for name in FINGERS:
        _add_mounted_finger(palm, name, calibration, anatomy, links)
    palm.add("site", name="grasp", pos=(0.008, 0.0, 0.055), size=(0.003,), rgba=(0, 0, 0, 0))
    return palm


def _moving_mass_kg(calibration: FingerCalibration, links: int | None) -> float:
    finger = calibration.finger
    return finger.mass_kg * (1.0 - hinges(calibration, links)[0].position_m / finger.length_m)


def _add_mounted_finger(
    palm: Any, name: str, calibration: FingerCalibration, anatomy: HandAnatomy, links: int | None
) -> None:
    mount = anatomy.mounts[name]
    x, y, z, w = Rotation.from_matrix(mount.rotation()).as_quat()
    base = palm.add("body", name=f"{name}_base", pos=mount.base_m, quat=(w, x, y, z))
    radius = calibration.finger.outer_radius_m
    end = calibration.finger.joint_position_m[0]
    base.add(
        "geom",
        name=f"{name}_base",
        dclass="tube",
        type="cylinder",
        size=(radius,),
        fromto=(0, 0, -0.004, 0, 0, end - 0.004),
        mass=0,
    )
    add_finger(base, name, calibration, links)


def add_defaults(root: mjcf.RootElement, contact: ContactSettings) -> None:
    """Add the default classes of pads, tubes, tendon points and palm."""
    common = {"solref": contact.solref, "friction": contact.friction(contact.pad_friction)}
    pad = root.default.add("default", dclass="pad")
    pad.geom.set_attributes(**common, condim=contact.condim, mass=0, rgba=(0.85, 0.82, 0.75, 1), group=1)
    tube = root.default.add("default", dclass="tube")
    tube.geom.set_attributes(**common, condim=contact.condim, rgba=(0.16, 0.17, 0.19, 1), group=1)
    tendon = root.default.add("default", dclass="tendon")
    tendon.site.set_attributes(size=(0.0005,), group=4)
    palm = root.default.add("default", dclass="palm")
    palm.geom.set_attributes(**common, condim=3, rgba=(0.24, 0.26, 0.30, 1), group=1)


def _add_wrist(root: mjcf.RootElement, palm: Any, anatomy: HandAnatomy) -> None:
    """Three slides in the world's axes, then yaw, pitch, roll; each follows a position servo."""
    axes = np.eye(3)
    # the palm's frame is turned by PALM_DOWN: its own y and z are the world's -y and -z
    flip = (1.0, -1.0, -1.0)
    for i, name in enumerate(WRIST_SLIDES):
        palm.add(
            "joint",
            name=name,
            type="slide",
            axis=flip[i] * axes[i] + 0.0,
            range=SLIDE_RANGE_M[i],
            ref=START_HEIGHT_M if name == "wrist_z" else 0.0,
            armature=anatomy.wrist_armature_kg,
        )
        stiffness, inertia = anatomy.wrist_stiffness_n_per_m, anatomy.wrist_armature_kg
        _add_servo(root, name, stiffness, inertia, SLIDE_RANGE_M[i], SERVO_FORCE_N)
    for i, name in zip((2, 1, 0), WRIST_HINGES, strict=True):
        palm.add(
            "joint",
            name=name,
            type="hinge",
            axis=flip[i] * axes[i] + 0.0,
            range=HINGE_RANGE_RAD,
            armature=anatomy.wrist_armature_kg_m2,
        )
        stiffness, inertia = anatomy.wrist_stiffness_n_m_per_rad, anatomy.wrist_armature_kg_m2
        _add_servo(root, name, stiffness, inertia, HINGE_RANGE_RAD, SERVO_TORQUE_N_M)


def _add_servo(
    root: mjcf.RootElement,
    name: str,
    stiffness: float,
    inertia: float,
    limits: tuple[float, float],
    strongest: float,
) -> None:
    """Position servo, critically damped for the given inertia."""
    root.actuator.add(
        "position",
        name=name,
        joint=name,
        kp=stiffness,
        kv=2.0 * float(np.sqrt(stiffness * inertia)),
        ctrlrange=limits,
        forcerange=(-strongest, strongest),
    )
