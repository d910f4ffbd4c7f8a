"""The scripted grasp as a policy of ``SoftHandGrasp-v0``: approach, close, lift, hold, by what the hardware knows."""

import numpy as np
import numpy.typing as npt

from envs.actions import encode_pressures
from envs.episode import Episode
from softhand_sim.grasp.choice.shipped import default_grasp
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.wrist import limited_step

Vector = npt.NDArray[np.float64]


class Driver:
    """Turns wrist poses and set pressures that are wanted into actions, no faster than the arm may.

    Parameters
    ----------
    episode
        Of the environment: its action layout and limits are read, not its state.
    wrist_pose
        Measured when the wrist stands still, (6,) in m and rad.
    """

    def __init__(self, episode: Episode, wrist_pose: Vector) -> None:
        spec, anatomy = episode.spec, episode.here.settings.anatomy
        self._action, self._period_s = spec.action, spec.control_period_s
        self._largest = (
            self._period_s * anatomy.wrist_speed_m_per_s,
            self._period_s * anatomy.wrist_rate_rad_per_s,
        )
        self.reference = wrist_pose.copy()

    def toward(self, target: Vector, set_pa_gauge: Vector) -> Vector:
        """Return the action, (9,), that goes on to a pose, (6,) in m and rad, with set pressures [Pa gauge], (3,)."""
        on_way = limited_step(self.reference, target, *self._largest)
        wrist = (on_way - self.reference) / (self._period_s * self._action.wrist_rates)
        self.reference = on_way
        action = np.concatenate([encode_pressures(self._action, set_pa_gauge), wrist])
        return np.asarray(np.clip(action, -1.0, 1.0))


class ScriptedGrasp:
    """The default grasp of the object, in the times of a protocol; for a new episode, make a new one.

    Parameters
    ----------
    episode
        Just reset; in an action mode with a controller, the wrist included.
    protocol
        Of its times and its lift; the paper's by default.
    """

    def __init__(self, episode: Episode, protocol: GraspProtocol | None = None) -> None:
        here, p = episode.here, protocol or load_protocol()
        known, plan = here.settings.calibrations[0], default_grasp(here.object)
        start = episode.observe()[episode.spec.layout.where["wrist_position_m"].start :][:6]
        self._driver, self._period_s = Driver(episode, start), episode.spec.control_period_s
        self._grasp = plan.standoff(0.0)
        self._closed_pa = p.closing_pressures_pa_gauge(known, plan.set_angle_deg)
        self._settle_s, self._close_s, self._lift_m = p.settle_s, p.close_s, p.lift_m
        self._since_arrival_s = 0.0

    def act(self) -> Vector:
        """Return the next action, (9,)."""
        waited = self._since_arrival_s
        closing, lifting = waited >= self._settle_s, waited >= self._settle_s + self._close_s
        target = self._grasp + np.array([0.0, 0.0, self._lift_m * lifting, 0.0, 0.0, 0.0])
        action = self._driver.toward(target, self._closed_pa * closing)
        if lifting or np.array_equal(self._driver.reference, self._grasp):
            self._since_arrival_s += self._period_s
        return action
