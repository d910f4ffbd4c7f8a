"""Addresses of the hand's parts in a compiled model."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import JOINTS
from softhand_sim.elements import FINGERS
from softhand_sim.hand.hand import WRIST

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class HandIndex:
    """Addresses of the hand's parts in a compiled model."""

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
        joints = [[f"{f}_{j}" for j in JOINTS] for f in FINGERS]
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

    def elongations_m(self, ten_length_m: Vector) -> Vector:
        """Elongation of each finger's actuator, shape (5,), from the engine's ``ten_length``: it shortens by it."""
        return np.asarray(self.straight_length_m - ten_length_m[self.tendon])
