"""Bench tests of the simulated finger, to hold against the calibration it was built from."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.elements import FINGERS
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.simulation import HandIndex

# choice: far below what any figure is quoted to (1e-5 rad/s over the time allowed is 0.01 degrees)
STILL_RAD_PER_S = 1e-5
LONGEST_S = 60.0


@dataclass(frozen=True, kw_only=True)
class PressureAngle:
    """Angles at rest: `pressure_pa_gauge` (n,), `joint_angle_deg` (n, 5 fingers, 3 joints)."""

    pressure_pa_gauge: npt.NDArray[np.float64]
    joint_angle_deg: npt.NDArray[np.float64]

    @property
    def tip_angle_deg(self) -> npt.NDArray[np.float64]:
        """Angle of each fingertip against its base, shape (n, 5)."""
        return np.asarray(self.joint_angle_deg.sum(axis=2))


def pressure_angle(calibration: FingerCalibration, pressures_pa_gauge: Sequence[float]) -> PressureAngle:
    """Let the five MuJoCo fingers come to rest at each pressure, one after the other.

    Gravity and contacts are off: the calibration knows neither, and closed fingers would touch the thumb. The
    pressure is applied directly, without valves.

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
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data, index = mujoco.MjData(model), HandIndex.of(model)
    angles = []
    for pressure in pressures_pa_gauge:
        data.ctrl[index.pressure_ctrl] = pressure
        _come_to_rest(model, data)
        angles.append(np.degrees(data.qpos[index.joint_qpos]))
    shape = (len(angles), len(FINGERS), index.joint_qpos.shape[1])
    return PressureAngle(
        pressure_pa_gauge=np.asarray(pressures_pa_gauge, dtype=np.float64),
        joint_angle_deg=np.reshape(angles, shape),
    )


def _come_to_rest(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    end_s = data.time + LONGEST_S
    while data.time < end_s:
        mujoco.mj_step(model, data, nstep=50)
        if float(np.abs(data.qvel).max()) < STILL_RAD_PER_S:
            return
    raise RuntimeError(f"fingers still move at {float(np.abs(data.qvel).max()):g} rad/s after {LONGEST_S} s")
