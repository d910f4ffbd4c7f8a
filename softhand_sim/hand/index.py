"""Addresses of the hand's parts in a compiled model."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import JOINTS
from softhand_sim.elements import FINGERS
from softhand_sim.hand.chain import joint_angles
from softhand_sim.hand.hand import WRIST

Vector = npt.NDArray[np.float64]


def chain_joints(model: mujoco.MjModel, finger: str) -> list[str]:
    """Names of a finger's hinges in a model, base first: one a joint, or several (`softhand_sim.hand.chain`)."""
    names = [model.joint(k).name for k in range(model.njnt)]
    return [n for joint in JOINTS for n in names if n == f"{finger}_{joint}" or n.startswith(f"{finger}_{joint}_")]


@dataclass(frozen=True, kw_only=True)
class HandIndex:
    """Addresses of the hand's parts in a compiled model.

    ``joint_qpos`` has a row a finger and a column a hinge, base first: three, or as many as the model's chains have.
    """

    pressure_ctrl: Vector
    loss_ctrl: Vector
    wrist_ctrl: Vector
    wrist_qpos: Vector
    tendon: Vector
    straight_length_m: Vector
    joint_qpos: Vector
    palm_body: int

    @classmethod
    def of(cls, model: mujoco.MjModel) -> "HandIndex":
        """Look the names up once."""
        joints = [chain_joints(model, f) for f in FINGERS]
        tendon = np.array([model.tendon(f"{f}_actuator").id for f in FINGERS])
        return cls(
            pressure_ctrl=np.array([model.actuator(f"{f}_pressure").id for f in FINGERS]),
            loss_ctrl=np.array([model.actuator(f"{f}_loss").id for f in FINGERS]),
            wrist_ctrl=np.array([model.actuator(name).id for name in WRIST]),
            wrist_qpos=np.array([model.joint(name).qposadr[0] for name in WRIST]),
            tendon=tendon,
            straight_length_m=model.tendon_length0[tendon].copy(),
            joint_qpos=np.array([[model.joint(name).qposadr[0] for name in row] for row in joints]),
            palm_body=int(model.body("palm").id),
        )

    def joint_angles_rad(self, qpos: Vector) -> Vector:
        """Angles of the three joints of each finger, shape (..., 5, 3), from the engine's ``qpos``, shape (..., q)."""
        angle = qpos[..., self.joint_qpos]
        if angle.shape[-1] == len(JOINTS):
            return np.asarray(angle)
        return joint_angles(angle, angle.shape[-1] // len(JOINTS))

    def elongations_m(self, ten_length_m: Vector) -> Vector:
        """Elongation of each finger's actuator, shape (5,), from the engine's ``ten_length``: it shortens by it."""
        return np.asarray(self.straight_length_m - ten_length_m[self.tendon])
