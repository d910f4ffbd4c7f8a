"""The hand in time: engine, pneumatics and wrist stepped together."""

from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import JOINTS, FingerCalibration
from softhand_sim.elements import FINGERS, spread_to_fingers
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.hand import WRIST
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.system import PneumaticSystem, default_elements
from softhand_sim.wrist import limited_step

Vector = npt.NDArray[np.float64]

_INSTABILITY = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


@dataclass(frozen=True, kw_only=True)
class HandIndex:
    """Addresses of the hand's parts in a compiled model."""

    pressure_ctrl: Vector
    wrist_ctrl: Vector
    wrist_qpos: Vector
    tendon: Vector
    joint_qpos: Vector
    palm_body: int

    @classmethod
    def of(cls, model: mujoco.MjModel) -> "HandIndex":
        """Look the names up once."""
        joints = [[f"{f}_{j}" for j in JOINTS] for f in FINGERS]
        return cls(
            pressure_ctrl=np.array([model.actuator(f"{f}_pressure").id for f in FINGERS]),
            wrist_ctrl=np.array([model.actuator(name).id for name in WRIST]),
            wrist_qpos=np.array([model.joint(name).qposadr[0] for name in WRIST]),
            tendon=np.array([model.tendon(f"{f}_actuator").id for f in FINGERS]),
            joint_qpos=np.array([[model.joint(name).qposadr[0] for name in row] for row in joints]),
            palm_body=int(model.body("palm").id),
        )


def default_pneumatics(calibration: FingerCalibration) -> PneumaticSystem:
    """Return default valves, tubes, sensors and control for the fingers of a calibration."""
    return PneumaticSystem(elements=default_elements(calibration.chamber.bulging_m3_per_pa))


@dataclass(kw_only=True)
class HandSimulation:
    """One world: mutable on purpose, since it wraps the engine's own mutable ``MjData``.

    Set `wrist_target` and `set_pressure_pa_gauge`, then call `step`. The gas is stepped first, with the chamber
    volumes that the fingers have now; its pressures then act through the next engine step (first-order coupling).

    Attributes
    ----------
    wrist_target: x, y, z (m), yaw, pitch, roll (rad), shape (6,); approached at the wrist's limited speed.
    set_pressure_pa_gauge: wanted pressure per element (Pa), shape (3,).

    Without `pneumatics` (None) the fingers have the wanted pressure at once, and there is no gas.
    """

    model: mujoco.MjModel
    calibration: FingerCalibration
    pneumatics: PneumaticSystem | None
    anatomy: HandAnatomy = field(default_factory=HandAnatomy)

    def __post_init__(self) -> None:
        self.index = HandIndex.of(self.model)
        self.data = mujoco.MjData(self.model)
        # a view of the engine's memory, which never moves: the attribute makes a new one each time
        self._tendon_length_m = self.data.ten_length
        self.dt = float(self.model.opt.timestep)

    def reset(self, rng: np.random.Generator, wrist_pose: Vector) -> None:
        """Start anew with empty fingers and the wrist standing at `wrist_pose`, shape (6,)."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self.index.wrist_qpos] = wrist_pose
        self.data.ctrl[self.index.wrist_ctrl] = wrist_pose
        mujoco.mj_forward(self.model, self.data)
        self.wrist_reference = np.array(wrist_pose, dtype=np.float64)
        self.wrist_target = self.wrist_reference.copy()
        self.set_pressure_pa_gauge = np.zeros(3)
        self.gas: PneumaticState | None = None
        if self.pneumatics is not None:
            self.gas = self.pneumatics.reset(self.chamber_volumes_m3(), rng)

    def step(self) -> None:
        """Advance by one time step of the engine."""
        self.move_wrist()
        ctrl = self.data.ctrl
        ctrl[self.index.wrist_ctrl] = self.wrist_reference
        ctrl[self.index.pressure_ctrl] = self._next_pressures_pa_gauge()
        mujoco.mj_step(self.model, self.data)

    def move_wrist(self) -> None:
        """Move the wrist's reference towards its target, as far as it may get in one time step."""
        self.wrist_reference = limited_step(
            self.wrist_reference,
            self.wrist_target,
            self.anatomy.wrist_speed_m_per_s * self.dt,
            self.anatomy.wrist_rate_rad_per_s * self.dt,
        )

    def _next_pressures_pa_gauge(self) -> tuple[float, ...]:
        """Step the gas and return the pressure in each finger (Pa), shape (5,)."""
        if self.pneumatics is None or self.gas is None:
            return spread_to_fingers(self.set_pressure_pa_gauge.tolist())
        self.gas = self.pneumatics.step(self.gas, self._volumes_m3(), self.set_pressure_pa_gauge, self.dt)
        return self.pneumatics.finger_pressures_pa_gauge(self.gas)

    def pressure_pa_gauge(self) -> Vector:
        """Present pressure of each element where its sensor sits (Pa), shape (3,)."""
        if self.pneumatics is None or self.gas is None:
            return np.array(self.set_pressure_pa_gauge)
        return np.asarray(self.gas.pressure_pa_abs) - self.pneumatics.ambient_pa_abs

    def reading_pa_gauge(self) -> Vector:
        """Last reading of each element's sensor (Pa), shape (3,)."""
        if self.pneumatics is None or self.gas is None:
            return np.array(self.set_pressure_pa_gauge)
        return np.asarray(self.gas.readings_pa_abs) - self.pneumatics.ambient_pa_abs

    def chamber_volumes_m3(self) -> Vector:
        """Volume of each finger's chamber without bulging, shape (5,): V(delta) at the tendon's present length."""
        return np.array(self._volumes_m3())

    def _volumes_m3(self) -> list[float]:
        chamber = self.calibration.chamber
        volume, area, half_slope = chamber.volume_m3, chamber.area_m2, 0.5 * chamber.area_slope_m
        # five plain numbers are quicker than arrays of five
        return [volume + d * (area + half_slope * d) for d in self._tendon_length_m[self.index.tendon].tolist()]

    @property
    def wrist_arrived(self) -> bool:
        """Whether the wrist's reference stands at its target."""
        return bool(np.array_equal(self.wrist_reference, self.wrist_target))

    @property
    def diverged(self) -> bool:
        """Whether the engine reported an instability or a coordinate is not finite."""
        warned = any(self.data.warning[kind].number > 0 for kind in _INSTABILITY)
        return warned or not bool(np.isfinite(self.data.qpos).all())

    def tip_angles_rad(self) -> Vector:
        """Bending angle of each fingertip against its base, shape (5,): the sum of its joints' angles."""
        return np.asarray(self.data.qpos[self.index.joint_qpos].sum(axis=1))

    def in_palm_frame(self, body: int) -> tuple[Vector, Vector]:
        """Position (m), shape (3,), and rotation, shape (3, 3), of a body in the palm's frame."""
        palm = self.data.xmat[self.index.palm_body].reshape(3, 3)
        position = palm.T @ (self.data.xpos[body] - self.data.xpos[self.index.palm_body])
        return position, palm.T @ self.data.xmat[body].reshape(3, 3)
