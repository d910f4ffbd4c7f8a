"""Soft pads: contacts of phalanges and object with the stiffness of the finite elements; parameters are `SoftPads`."""

from typing import Any

import numpy as np

from softhand_sim.calibration import JOINTS
from softhand_sim.effects.kind import ActsOn, Closing, Estimate
from softhand_sim.elements import FINGERS
from softhand_sim.hand.finger import PAD_RADIUS_M
from softhand_sim.hand.scene import compile_scene
from softhand_sim.pads import SoftPads

ACTS_ON = ActsOn.MODEL


def soften(root: Any, pads: SoftPads, name: str = "object") -> None:
    """Give each pair of a phalanx's and an object's shapes its own contact, before the scene is compiled.

    The pair keeps the object's own friction, as the contact without it does.

    Raises
    ------
    ValueError
        If the scene has no shapes ``<name>_collision_<i>``.
    """
    shapes = [g for g in root.find_all("geom") if g.name is not None and g.name.startswith(f"{name}_collision_")]
    if not shapes:
        raise ValueError(f"soft pads: the scene has no shapes {name}_collision_<i>")
    weight = compile_scene(root).model
    own = float(weight.body_invweight0[weight.body(name).id, 0])
    for finger in FINGERS:
        for joint in JOINTS:
            law = pads.of_joint(joint)
            both = own + float(weight.body_invweight0[weight.body(f"{finger}_{joint}").id, 0])
            for part in ("tube", "pad"):
                for shape in shapes:
                    sliding, torsion, rolling = shape.friction
                    root.contact.add(
                        "pair",
                        geom1=f"{finger}_{joint}_{part}",
                        geom2=shape.name,
                        condim=shape.condim,
                        friction=(sliding, sliding, torsion, rolling, rolling),
                        solref=law.solref(both),
                        solimp=law.solimp,
                    )


def question(scene: Closing, pads: SoftPads) -> Estimate:
    """Bound what dents do: each phalanx turns on by its pad's depth, over the lever of its joint.

    The load is the most that a pad can carry, a straight finger's thrust over the lever of the pad's middle.
    """
    calibration, set_pa = scene.calibration, float(scene.set_pa_gauge.max())
    finger, bent = calibration.finger, 0.0
    ends = [*finger.joint_position_m[1:], finger.length_m]
    for joint, start, end in zip(calibration.joints, finger.joint_position_m, ends, strict=True):
        lever = max(0.5 * (end - start), PAD_RADIUS_M)
        force = set_pa * calibration.chamber.area_m2 * joint.offset_m / lever
        bent += pads.of_joint(joint.name).depth_m(force) / lever
    degrees = float(np.degrees(bent))
    reason = f"dents of the pads turn a fingertip by up to {degrees:.1f} degrees"
    return Estimate(own_deg=degrees, redraws=True, reason=reason)
