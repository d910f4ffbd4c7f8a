"""The hand in time: engine, pneumatics and wrist stepped together."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import JOINT_RANGE_RAD, JOINTS, FingerCalibration
from softhand_sim.calibration.limits import CalibratedRange, RangeWatch
from softhand_sim.elements import FINGERS, spread_to_fingers
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.hand import WRIST
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.system import PneumaticSystem, default_elements
from softhand_sim.wrist import limited_step

Vector = npt.NDArray[np.float64]

RANGE_WATCH_S = 0.02
"""Choice: how often range_watch looks, the sensors' period; every step would cost some per cent of a trial."""
_MOST_BEND_RAD = len(JOINTS) * JOINT_RANGE_RAD[1]
_INSTABILITY = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


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

    def elongations_m(self, data: mujoco.MjData) -> Vector:
        """Elongation of each finger's actuator, shape (5,): its tendon shortens by it."""
        return np.asarray(self.straight_length_m - data.ten_length[self.tendon])


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
    range_watch: what went beyond the calibrated range since the reset; never silently extrapolated.
    losses: friction, relaxation and relief of the fingers; by default the calibration's friction alone.

    Without `pneumatics` (None) the fingers have the wanted pressure at once, and there is no gas.
    """

    model: mujoco.MjModel
    calibration: FingerCalibration
    pneumatics: PneumaticSystem | None
    anatomy: HandAnatomy = field(default_factory=HandAnatomy)
    losses: Losses | None = None

    def __post_init__(self) -> None:
        self.index = HandIndex.of(self.model)
        self.data = mujoco.MjData(self.model)
        self.dt = float(self.model.opt.timestep)
        # a view of the engine's memory, which never moves: the attribute makes a new one each time
        self._tendon_length_m = self.data.ten_length
        self._played: Iterator[tuple[float, ...]] | None = None
        losses = Losses.of(self.calibration) if self.losses is None else self.losses
        self.losses = losses
        self._loses, self._relieved = losses.any, losses.relief is not None

    def reset(self, rng: np.random.Generator, wrist_pose: Vector) -> None:
        """Start anew with empty fingers and the wrist standing at `wrist_pose`, shape (6,)."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self.index.wrist_qpos] = wrist_pose
        self.data.ctrl[self.index.wrist_ctrl] = wrist_pose
        mujoco.mj_forward(self.model, self.data)
        self.wrist_reference = np.array(wrist_pose, dtype=np.float64)
        self.wrist_target = self.wrist_reference.copy()
        self.set_pressure_pa_gauge = np.zeros(3)
        self.range_watch = RangeWatch(limits=CalibratedRange.of(self.calibration))
        self._next_look_s = 0.0
        if self.losses is not None:
            self.loss_state = self.losses.rest(self.elongations_m())
        self.gas: PneumaticState | None = None
        if self.pneumatics is not None:
            self.gas = self.pneumatics.reset(self.chamber_volumes_m3(), rng)

    def step(self) -> None:
        """Advance by one time step of the engine."""
        self.move_wrist()
        elongation = self._elongations_m()
        pressure = self._next_pressures_pa_gauge(elongation)
        ctrl = self.data.ctrl
        ctrl[self.index.wrist_ctrl] = self.wrist_reference
        ctrl[self.index.pressure_ctrl] = pressure
        if self._loses:
            ctrl[self.index.loss_ctrl] = self._next_losses_n(elongation, np.array(pressure))
        mujoco.mj_step(self.model, self.data)
        if self.data.time >= self._next_look_s:
            joints = self.data.qpos[self.index.joint_qpos]
            self.range_watch.look(self.set_pressure_pa_gauge, np.array(pressure), joints)
            self._next_look_s = self.data.time + RANGE_WATCH_S

    def move_wrist(self) -> None:
        """Move the wrist's reference towards its target, as far as it may get in one time step."""
        if self.wrist_arrived:
            return
        self.wrist_reference = limited_step(
            self.wrist_reference,
            self.wrist_target,
            self.anatomy.wrist_speed_m_per_s * self.dt,
            self.anatomy.wrist_rate_rad_per_s * self.dt,
        )

    def _next_pressures_pa_gauge(self, elongation_m: Vector) -> tuple[float, ...]:
        """Step the gas and return the pressure in each finger (Pa), shape (5,)."""
        if self._played is not None:
            return next(self._played)
        if self.pneumatics is None or self.gas is None:
            return spread_to_fingers(self.set_pressure_pa_gauge.tolist())
        volumes = self._volumes_m3(elongation_m)
        self.gas = self.pneumatics.step(self.gas, volumes, self.set_pressure_pa_gauge, self.dt)
        return self.pneumatics.finger_pressures_pa_gauge(self.gas)

    def _next_losses_n(self, elongation_m: Vector, pressure_pa_gauge: Vector) -> Vector:
        """Step the losses and return their force along each finger's elongation (N), shape (5,)."""
        if self.losses is None:
            return np.zeros(len(FINGERS))
        # an engine that diverges shows infinite angles before it says so
        bend = np.minimum(np.abs(self.data.qpos[self.index.joint_qpos]).sum(axis=1), _MOST_BEND_RAD)
        self.loss_state, force = self.losses.step(self.loss_state, elongation_m, bend, pressure_pa_gauge, self.dt)
        return force

    def play_pressures(self, recorded: Iterator[tuple[float, ...]] | None) -> None:
        """Give the fingers recorded pressures (Pa), (5,) a step, while the gas stands still; None ends that."""
        self._played = recorded

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

    def _elongations_m(self) -> Vector:
        return np.asarray(self.index.straight_length_m - self._tendon_length_m[self.index.tendon])

    def elongations_m(self) -> Vector:
        """Elongation of each finger's actuator, shape (5,): that at the start of the engine's last step."""
        return self.index.elongations_m(self.data)

    def chamber_volumes_m3(self) -> Vector:
        """Volume of each finger's chamber without bulging, shape (5,): V(delta) at the tendon's present length.

        Where a relief lets actuators out, delta is longer by that.
        """
        return np.array(self._volumes_m3(self.elongations_m()))

    def _volumes_m3(self, elongation_m: Vector) -> list[float]:
        chamber = self.calibration.chamber
        volume, area, half_slope = chamber.volume_m3, chamber.area_m2, 0.5 * chamber.area_slope_m
        if self._relieved:
            elongation_m = elongation_m + self.loss_state.bulge_m
        # five plain numbers are quicker than arrays of five
        return [volume + d * (area + half_slope * d) for d in elongation_m.tolist()]

    @property
    def wrist_arrived(self) -> bool:
        """Whether the wrist's reference stands at its target."""
        # lists of six compare in a third of the time of arrays; asked at every step
        return bool(self.wrist_reference.tolist() == self.wrist_target.tolist())

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
