"""The hand in time: engine, pneumatics and wrist stepped together."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.actuation import Course, EngineArrays, HandParts, Runner, engine_runner, prepare_actuation
from softhand_sim.calibration import JOINTS, FingerCalibration
from softhand_sim.calibration.limits import CalibratedRange, RangeWatch
from softhand_sim.elements import FINGERS
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.index import HandIndex
from softhand_sim.losses import Losses, LossState
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.system import PneumaticSystem, default_elements
from softhand_sim.wrist import limited_step

Vector = npt.NDArray[np.float64]

RANGE_WATCH_S = 0.02
"""Choice: how often range_watch looks, the sensors' period; every step would cost some per cent of a trial."""
_NONE_GIVEN = np.zeros((0, len(FINGERS)))
_BAD = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
    mujoco.mjtWarning.mjWARN_BADCTRL,
    mujoco.mjtWarning.mjWARN_INERTIA,
)
MEMORY_FULL = int(mujoco.mjtWarning.mjWARN_CONTACTFULL), int(mujoco.mjtWarning.mjWARN_CNSTRFULL)
"""Numbers of the warnings that contacts or constraints were left out, as the engine's memory was full."""
INSTABILITY = (*(int(kind) for kind in _BAD), *MEMORY_FULL)
"""Numbers of the warnings after which a world is no longer the one that was asked for: values that are no numbers,
replaced by the engine; a singular inertia; and `MEMORY_FULL`."""


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
    warnings: how often the engine gave each of its warnings, a view, one number a kind.

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
        self.losses = losses = Losses.of(self.calibration) if self.losses is None else self.losses
        self._played: Iterator[Vector] | None = None
        # views of the engine's memory, which never moves
        self.warnings = self.data.warning.number
        engine = EngineArrays(
            ten_length=self.data.ten_length[None], qpos=self.data.qpos[None], ctrl=self.data.ctrl[None]
        )
        parts = HandParts(index=self.index, calibration=self.calibration, pneumatics=self.pneumatics, losses=losses)
        self._actuation = prepare_actuation(parts, engine)
        self._run = engine_runner(self._actuation, self.model, self.data)
        speed, rate = self.anatomy.wrist_speed_m_per_s, self.anatomy.wrist_rate_rad_per_s
        self._wrist, self._limits = np.zeros((2, 1, 6)), np.array([speed * self.dt, rate * self.dt])
        self._clock = np.array([0.0, 0.0, RANGE_WATCH_S])
        # compiled steps know three hinges a finger
        self._looks_itself = self.index.joint_qpos.shape[1] == len(JOINTS)
        self._idle = self.pneumatics is None and not losses.any

    def reset(self, rng: np.random.Generator, wrist_pose: Vector) -> None:
        """Start anew with empty fingers and the wrist standing at `wrist_pose`, shape (6,)."""
        mujoco.mj_resetData(self.model, self.data)
        self.stand(wrist_pose)
        self.set_pressure_pa_gauge = np.zeros(3)
        self.range_watch = RangeWatch(limits=CalibratedRange.of(self.calibration))
        self._next_look_s = 0.0
        self._actuation.reset(0, rng)

    def stand(self, wrist_pose: Vector) -> None:
        """Put the wrist at `wrist_pose`, shape (6,), at once; it has no speed if it had none."""
        self.data.qpos[self.index.wrist_qpos] = wrist_pose
        self.data.ctrl[self.index.wrist_ctrl] = wrist_pose
        mujoco.mj_forward(self.model, self.data)
        self.wrist_reference = np.array(wrist_pose, dtype=np.float64)
        self.wrist_target = self.wrist_reference.copy()

    def advance(self, steps: int) -> None:
        """Advance by some time steps, as that many calls of `step` to the bit.

        They are taken in compiled code where there is such, and by the engine alone, between two looks at the
        calibrated range, where nothing changes between its steps (neither gas nor losses, the wrist at its target).
        """
        while steps > 0:
            still = self._idle and self.wrist_arrived
            if still and self._played is None:
                taken = min(steps, self._steps_to_look)
                self.data.ctrl[self.index.wrist_ctrl] = self.wrist_reference
                self._actuation.step(self.dt)
                mujoco.mj_step(self.model, self.data, nstep=taken)
                self._look()
            elif self._run is not None:
                taken = steps if self._looks_itself else min(steps, self._steps_to_look)
                self._take(self._run, taken)
            else:
                taken = 1
                self.step()
            steps -= taken

    def step(self) -> None:
        """Advance by one time step of the engine."""
        if self._run is not None:
            self._take(self._run, 1)
            return
        self.move_wrist()
        self.data.ctrl[self.index.wrist_ctrl] = self.wrist_reference
        if self._played is not None:
            self._actuation.play(np.array([next(self._played)]))
        self._actuation.step(self.dt)
        mujoco.mj_step(self.model, self.data)
        self._look()

    def _take(self, run: Runner, steps: int) -> None:
        """Take steps in compiled code."""
        wrist, clock = self._wrist, self._clock
        clock[0], clock[1] = self.data.time, self._next_look_s if self._looks_itself else math.inf
        wrist[0, 0], wrist[1, 0] = self.wrist_reference, self.wrist_target
        given = _NONE_GIVEN if self._played is None else np.array([next(self._played) for _ in range(steps)])
        course = Course(wrist=wrist, limits=self._limits, extremes=self.range_watch.extremes, clock=clock, given=given)
        try:
            run(course, self.dt, steps)
        finally:
            # a new array: the old one may have been kept by somebody
            self.wrist_reference = wrist[0, 0].copy()
            if self._looks_itself:
                self._next_look_s = float(clock[1])
            else:
                self._look()

    @property
    def _steps_to_look(self) -> int:
        return max(1, math.ceil((self._next_look_s - float(self.data.time)) / self.dt - 1e-6))

    def _look(self) -> None:
        if self.data.time >= self._next_look_s:
            joints = self.index.joint_angles_rad(self.data.qpos)
            self.range_watch.look(self._actuation.set_pa_gauge[0], self._actuation.pressure_pa_gauge[0], joints)
            self._next_look_s = self.data.time + RANGE_WATCH_S

    @property
    def set_pressure_pa_gauge(self) -> Vector:
        """Wanted pressure per element (Pa), shape (3,): a copy; assign to change it."""
        return np.array(self._actuation.set_pa_gauge[0])

    @set_pressure_pa_gauge.setter
    def set_pressure_pa_gauge(self, value: Vector) -> None:
        self._actuation.set_pa_gauge[0] = value

    @property
    def gas(self) -> PneumaticState | None:
        """State of gas, valves and control, None without pneumatics; assign one to go back to it, bit for bit."""
        return self._actuation.gas(0)

    @gas.setter
    def gas(self, state: PneumaticState | None) -> None:
        self._actuation.set_gas(0, state)

    @property
    def loss_state(self) -> LossState:
        """State of friction, relaxation and relief; assign one to go back to it, bit for bit."""
        return self._actuation.losses(0)

    @loss_state.setter
    def loss_state(self, state: LossState) -> None:
        self._actuation.set_losses(0, state)

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

    def play_pressures(self, recorded: Iterator[Vector] | None) -> None:
        """Give the fingers recorded pressures (Pa), shape (5,) a step, while the gas stands still; None ends that."""
        self._played = recorded
        if recorded is None:
            self._actuation.stop_playing()

    def pressure_pa_gauge(self) -> Vector:
        """Present pressure of each element where its sensor sits (Pa), shape (3,)."""
        if self.pneumatics is None:
            return self.set_pressure_pa_gauge
        return np.asarray(self._actuation.pressure_pa_abs()[0] - self.pneumatics.ambient_pa_abs)

    def reading_pa_gauge(self) -> Vector:
        """Last reading of each element's sensor (Pa), shape (3,)."""
        if self.pneumatics is None:
            return self.set_pressure_pa_gauge
        return np.asarray(self._actuation.reading_pa_abs()[0] - self.pneumatics.ambient_pa_abs)

    def valves_open(self) -> Vector:
        """Which valves are open, inlet and outlet of each element, 1 or 0, shape (6,); zeros without pneumatics."""
        return np.zeros(6) if self.pneumatics is None else np.asarray(self._actuation.valves_open()[0])

    def elongations_m(self) -> Vector:
        """Elongation of each finger's actuator, shape (5,): that at the start of the engine's last step."""
        return self.index.elongations_m(self.data.ten_length)

    def chamber_volumes_m3(self) -> Vector:
        """Volume of each finger's chamber without bulging, shape (5,): V(delta) at the tendon's present length.

        Where a relief lets actuators out, delta is longer by that.
        """
        return np.array(self.calibration.chamber.volumes_m3(self.elongations_m() + self.loss_state.bulge_m))

    @property
    def wrist_arrived(self) -> bool:
        """Whether the wrist's reference stands at its target."""
        # lists of six compare in a third of the time of arrays; asked at every step
        return bool(self.wrist_reference.tolist() == self.wrist_target.tolist())

    @property
    def diverged(self) -> bool:
        """Whether the engine reported an instability or a coordinate is not finite."""
        warned = any(self.warnings[kind] > 0 for kind in INSTABILITY)
        return warned or not bool(np.isfinite(self.data.qpos).all())

    def tip_angles_rad(self) -> Vector:
        """Bending angle of each fingertip against its base, shape (5,): the sum of its joints' angles."""
        return np.asarray(self.data.qpos[self.index.joint_qpos].sum(axis=1))

    def in_palm_frame(self, body: int) -> tuple[Vector, Vector]:
        """Position (m), shape (3,), and rotation, shape (3, 3), of a body in the palm's frame."""
        palm = self.data.xmat[self.index.palm_body].reshape(3, 3)
        position = palm.T @ (self.data.xpos[body] - self.data.xpos[self.index.palm_body])
        return position, palm.T @ self.data.xmat[body].reshape(3, 3)
