"""The whole hand on the bench: the five fingers' angles at rest under one pressure, with gravity in any direction."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.characterize.bench import PRESSURE_RATE_PA_PER_S, STILL_RAD_PER_S
from softhand_sim.elements import FINGERS
from softhand_sim.hand.index import HandIndex
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.losses import Losses

LONGEST_S = 60.0
G_M_PER_S2 = 9.81
ATTITUDES: dict[str, tuple[float, float, float]] = {
    "no gravity": (0.0, 0.0, 0.0),
    "hand on its side, thumb's side up": (0.0, -G_M_PER_S2, 0.0),
    "hand on its side, thumb's side down": (0.0, G_M_PER_S2, 0.0),
    "palm down": (0.0, 0.0, -G_M_PER_S2),
    "palm up": (0.0, 0.0, G_M_PER_S2),
    "fingers down": (G_M_PER_S2, 0.0, 0.0),
    "fingers up": (-G_M_PER_S2, 0.0, 0.0),
}
"""Gravity for attitudes of the palm, in the frame of a palm that looks down with its fingers along x [m/s2]."""
BENCH_ATTITUDES = ("hand on its side, thumb's side up", "hand on its side, thumb's side down")
"""Attitudes in which a finger bends in a level plane, so that its weight hardly bends it: those in which the angle is
the actuator's, as the finite elements have it. (The paper does not say how its finger was held.)"""


@dataclass(frozen=True, kw_only=True)
class PressureAngle:
    """Angles at rest: `pressure_pa_gauge` (n,), `joint_angle_deg` (n, 5 fingers, 3 joints)."""

    pressure_pa_gauge: npt.NDArray[np.float64]
    joint_angle_deg: npt.NDArray[np.float64]

    @property
    def tip_angle_deg(self) -> npt.NDArray[np.float64]:
        """Angle of each fingertip against its base, shape (n, 5)."""
        return np.asarray(self.joint_angle_deg.sum(axis=2))


def pressure_angle(
    calibration: FingerCalibration,
    pressures_pa_gauge: Sequence[float],
    *,
    gravity_m_per_s2: tuple[float, float, float] = ATTITUDES["no gravity"],
) -> PressureAngle:
    """Let the five MuJoCo fingers come to rest at each pressure, one after the other, the palm looking down.

    Contacts are off, since closed fingers would touch the thumb, and by default gravity, which the calibration does not
    know. The pressure is applied directly, without valves, and moves slowly from one value to the next.

    Raises
    ------
    ValueError
        If a pressure lies outside the calibration's curve.
    RuntimeError
        If the fingers do not come to rest.
    """
    for pressure in pressures_pa_gauge:
        calibration.angle_for_pressure(pressure)
    root = build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))
    model = compile_scene(root).model
    model.opt.gravity[:] = gravity_m_per_s2
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    hand = _Hand(model, calibration)
    angles = [hand.rest_at(pressure) for pressure in pressures_pa_gauge]
    return PressureAngle(
        pressure_pa_gauge=np.asarray(pressures_pa_gauge, dtype=np.float64),
        joint_angle_deg=np.reshape(angles, (len(angles), len(FINGERS), hand.index.joint_qpos.shape[1])),
    )


class _Hand:
    def __init__(self, model: mujoco.MjModel, calibration: FingerCalibration) -> None:
        self.model, self.calibration = model, calibration
        self.data, self.index = mujoco.MjData(model), HandIndex.of(model)
        self.data.ctrl[self.index.wrist_ctrl] = self.data.qpos[self.index.wrist_qpos]
        self.losses = Losses.of(calibration)
        self.loss_state, self.pressure = self.losses.rest(np.zeros(len(FINGERS))), 0.0

    def step(self, pressure: float) -> None:
        data, index = self.data, self.index
        data.ctrl[index.pressure_ctrl] = pressure
        angle = data.qpos[index.joint_qpos]
        self.loss_state, data.ctrl[index.loss_ctrl] = self.losses.step(
            self.loss_state,
            self.calibration.elongations_m(angle),
            np.abs(angle).sum(axis=1),
            np.full(len(FINGERS), pressure),
            self.model.opt.timestep,
        )
        mujoco.mj_step(self.model, data)

    def rest_at(self, pressure: float) -> npt.NDArray[np.float64]:
        """Move the pressure slowly, wait for rest and return the joint angles [deg], (5, 3)."""
        steps = int(np.ceil(abs(pressure - self.pressure) / PRESSURE_RATE_PA_PER_S / self.model.opt.timestep))
        for p in np.linspace(self.pressure, pressure, steps + 1)[1:]:
            self.step(float(p))
        self.pressure, end = pressure, self.data.time + LONGEST_S
        while self.data.time < end:
            for _ in range(50):
                self.step(pressure)
            if float(np.abs(self.data.qvel).max()) < STILL_RAD_PER_S:
                return np.asarray(np.degrees(self.data.qpos[self.index.joint_qpos]))
        raise RuntimeError(f"fingers still move at {float(np.abs(self.data.qvel).max()):g} rad/s after {LONGEST_S} s")
