"""Many hands in time: worlds of one model, stepped together, each as `HandSimulation` would step it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import mujoco
import mujoco.batch
import numpy as np
import numpy.typing as npt

from softhand_sim.actuation import EngineArrays, HandParts, prepare_actuation, wrist_mover
from softhand_sim.calibration import FingerCalibration
from softhand_sim.calibration.limits import CalibratedRange, RangeWatches
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.index import HandIndex
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.simulation import INSTABILITY, RANGE_WATCH_S

Vector = npt.NDArray[np.float64]
Ids = Sequence[int] | npt.NDArray[np.int64]


@dataclass(kw_only=True)
class HandBatch:
    """n worlds of one model; the same trajectories to the bit as n `HandSimulation`, for any number of threads.

    Attributes
    ----------
    worlds, threads: how many; 0 threads for all processors.
    engine: the engine's `mujoco.batch.Batch`; ``engine.bind(field)`` gives a field of all worlds, shape (n, ...), and
        ``engine.get_data(world)`` one world alone.
    wrist_target, wrist_reference: shape (n, 6), as in `HandSimulation`; write to them in place.
    set_pressure_pa_gauge: wanted pressures (Pa), shape (n, 3); write to it in place.
    pneumatics, losses: as in `HandSimulation`, the same for all worlds.
    persistent: whether the engine keeps a whole ``MjData`` of each world, so that ``engine.get_data`` shows contacts.
    """

    model: mujoco.MjModel
    calibration: FingerCalibration
    pneumatics: PneumaticSystem | None
    worlds: int
    threads: int = 0
    anatomy: HandAnatomy = field(default_factory=HandAnatomy)
    losses: Losses | None = None
    persistent: bool = False

    def __post_init__(self) -> None:
        if self.worlds < 1:
            raise ValueError(f"worlds = {self.worlds!r}: must be 1 or more")
        n = self.worlds
        self.index = HandIndex.of(self.model)
        self.dt = float(self.model.opt.timestep)
        self.engine = mujoco.batch.Batch(self.model, n, nthread=self.threads, persistent=self.persistent)
        self._qpos, self._ctrl, self._time = (self.engine.bind(name) for name in ("qpos", "ctrl", "time"))
        arrays = EngineArrays(ten_length=self.engine.bind("ten_length"), qpos=self._qpos, ctrl=self._ctrl)
        self.losses = losses = Losses.of(self.calibration) if self.losses is None else self.losses
        parts = HandParts(index=self.index, calibration=self.calibration, pneumatics=self.pneumatics, losses=losses)
        self.actuation = prepare_actuation(parts, arrays)
        self.set_pressure_pa_gauge = self.actuation.set_pa_gauge
        self.wrist_reference, self.wrist_target = np.zeros((n, 6)), np.zeros((n, 6))
        self._watch = RangeWatches(limits=CalibratedRange.of(self.calibration), worlds=n)
        self._next_look_s = np.zeros(n)
        self._move_wrists = wrist_mover()
        self._played: Iterator[Vector] | None = None

    def reset(self, worlds: Ids, rngs: Sequence[np.random.Generator], wrist_poses: Vector) -> None:
        """Start some worlds anew, as `HandSimulation.reset` does one.

        Parameters
        ----------
        worlds
            Which, (m,).
        rngs
            A generator for each of them; one integer is drawn from it.
        wrist_poses
            Where their wrists stand, (m, 6) or (6,).
        """
        ids = np.asarray(worlds, dtype=np.int64)
        poses = np.broadcast_to(wrist_poses, (len(ids), 6))
        self.engine.reset(ids, stage=mujoco.mjtStage.mjSTAGE_NONE.value)
        self._qpos[np.ix_(ids, self.index.wrist_qpos)] = poses
        self._ctrl[np.ix_(ids, self.index.wrist_ctrl)] = poses
        self.engine.forward(ids)
        self.wrist_reference[ids] = self.wrist_target[ids] = poses
        self.set_pressure_pa_gauge[ids] = 0.0
        self._watch.forget(ids)
        self._next_look_s[ids] = 0.0
        for world, rng in zip(ids.tolist(), rngs, strict=True):
            self.actuation.reset(world, rng)

    def forward(self, worlds: Ids) -> None:
        """Bring the engine's derived fields of some worlds up to date after writing to their state."""
        self.engine.forward(np.asarray(worlds, dtype=np.int64))

    def step(self) -> None:
        """Advance all worlds by one time step of the engine."""
        speed, rate = self.anatomy.wrist_speed_m_per_s, self.anatomy.wrist_rate_rad_per_s
        self._move_wrists(self.wrist_reference, self.wrist_target, speed * self.dt, rate * self.dt)
        self._ctrl[:, self.index.wrist_ctrl] = self.wrist_reference
        if self._played is not None:
            self.actuation.play(next(self._played))
        self.actuation.step(self.dt)
        self.engine.step()
        due = self._time >= self._next_look_s
        if due.any():
            joints = self.index.joint_angles_rad(self._qpos)
            self._watch.look(due, self.set_pressure_pa_gauge, self.actuation.pressure_pa_gauge, joints)
            self._next_look_s[due] = self._time[due] + RANGE_WATCH_S

    def play_pressures(self, recorded: Iterator[Vector] | None) -> None:
        """Give the fingers recorded pressures (Pa), (n, 5) a step, while the gas stands still; None ends that."""
        self._played = recorded
        if recorded is None:
            self.actuation.stop_playing()

    def pressure_pa_gauge(self) -> Vector:
        """Present pressure of each element where its sensor sits (Pa), shape (n, 3)."""
        if self.pneumatics is None:
            return self.set_pressure_pa_gauge.copy()
        return np.asarray(self.actuation.pressure_pa_abs() - self.pneumatics.ambient_pa_abs)

    def reading_pa_gauge(self) -> Vector:
        """Last reading of each element's sensor (Pa), shape (n, 3)."""
        if self.pneumatics is None:
            return self.set_pressure_pa_gauge.copy()
        return np.asarray(self.actuation.reading_pa_abs() - self.pneumatics.ambient_pa_abs)

    def tip_angles_rad(self) -> Vector:
        """Bending angle of each fingertip against its base, shape (n, 5): the sum of its joints' angles."""
        return np.asarray(self._qpos[:, self.index.joint_qpos].sum(axis=2))

    @property
    def diverged(self) -> npt.NDArray[np.bool_]:
        """Whether the engine reported an instability of a world or a coordinate of it is not finite, shape (n,)."""
        warned = (self.engine.warning[:, INSTABILITY, 1] > 0).any(axis=1)
        return np.asarray(warned | ~np.isfinite(self._qpos).all(axis=1))

    def valves_open(self) -> Vector:
        """Which valves are open, inlet and outlet of each element, 1 or 0, shape (n, 6); zeros without pneumatics."""
        return np.zeros((self.worlds, 6)) if self.pneumatics is None else self.actuation.valves_open()

    def passed_calibration(self) -> npt.NDArray[np.bool_]:
        """Whether anything of each world went beyond the calibrated range since its reset, shape (n,)."""
        return self._watch.passed()

    def beyond_calibration(self, world: int) -> dict[str, float]:
        """Return what went beyond the calibrated range in a world since its reset (`RangeWatch.beyond`)."""
        return self._watch.of_world(world).beyond()
