"""Reach and close in a few decisions: what a learned policy of `softhand_sim.policy` is trained on and judged by.

Around ``SoftHandGrasp-v0`` with ``observation_mode="hardware"`` and nothing else of it: the policy is given what the
real hand's sensors say, and the grasp plan that the script has as well. After the last decision the wrist lifts.
"""

from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from envs.grasp import SoftHandGraspEnv
from envs.observer import object_in_palm
from envs.script import Driver
from softhand_sim.checks import require_in
from softhand_sim.grasp.choice.shipped import default_grasp
from softhand_sim.guards.limits import Guards
from softhand_sim.policy.reach import ACTIONS, SAMPLE_S, Reach, ReachSpec

Vector = npt.NDArray[np.float64]
Info = dict[str, Any]

PRIVILEGED = 12
"""Values that only a critic may see."""
APPROACH_M = 0.13
"""Choice: from there the open fingers are clear of objects that lie 30 mm nearer than expected."""


@dataclass(frozen=True, kw_only=True)
class LiftSpec:
    """What follows the last decision (choices).

    Attributes
    ----------
    height_m, hold_s
        Lift [m] and hold [s].
    steady_m, steady_rad
        How far the object may move and turn in the palm meanwhile to count as steady, as in the paper's protocol.
    if_touched
        Whether both are left out where neither a finger nor the palm touches the object.
    """

    height_m: float = 0.15
    hold_s: float = 1.2
    steady_m: float = 0.010
    steady_rad: float = 0.2617993877991494
    if_touched: bool = False

    def __post_init__(self) -> None:
        require_in("height_m", self.height_m, 1e-3, 0.5)
        require_in("hold_s", self.hold_s, 0.0, 60.0)


SHORT_LIFT = LiftSpec(height_m=0.06, hold_s=0.4, if_touched=True)
"""Choice: tells held from missed for training, at a third of the time."""


class ReachEnv(gymnasium.Env[Vector, Any]):
    """One step is one decision.

    Action: ``Box(-1, 1, (9,))``, corrections of the script (`softhand_sim.policy.reach.Reach.decide`). Observation:
    `Reach.features`, and, with ``privileged=True``, 12 values more for a critic: the object's position and orientation
    in the palm's frame (7), its height, its displacement along x and y, its mass and friction.

    Reward: what the distance d [m] of the object's centre from the site `grasp` has gained in 1 - tanh(10 d); after
    the last decision and the lift, 1 times the share of the lift that the object gained, and 1 more if it moved in
    the palm by less than 10 mm and 15 degrees meanwhile. The terms are choices. The episode terminates then, or lost
    when a joint is bent so far past its stops that a trial's guard would end it (`softhand_sim.guards`).
    ``info["is_success"]`` is that of ``SoftHandGrasp-v0``, ``info["lifted"]`` whether 0.8 of the lift was gained.

    Parameters
    ----------
    spec
        Of the decisions.
    lift
        What follows them.
    privileged
        Whether observations end with what only a critic may see.
    config
        Arguments of `envs.grasp.SoftHandGraspEnv`, but for modes, control period and guards.
    """

    def __init__(
        self, *, spec: ReachSpec | None = None, lift: LiftSpec = SHORT_LIFT, privileged: bool = False, **config: Any
    ) -> None:
        self._spec = spec or ReachSpec()
        self._lift, self._privileged = lift, privileged
        self.env = SoftHandGraspEnv(
            action_mode="pressure", wrist=True, observation_mode="hardware", control_period_s=SAMPLE_S,
            approach_m=APPROACH_M, guards=None, **config,
        )  # fmt: skip
        size = self._spec.features + PRIVILEGED * privileged
        self.observation_space = spaces.Box(-np.inf, np.inf, (size,), dtype=np.float64)
        self.action_space = spaces.Box(-1.0, 1.0, (ACTIONS,), dtype=np.float32)
        self._seen = np.zeros(15)
        self._info: Info = {}
        self._lost = False

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Vector, Info]:
        """Start an episode; options as of the environment inside."""
        self._seen, info = self.env.reset(seed=seed, options=options)
        here = self.env.episode.here
        plan, known = default_grasp(here.object), here.settings.calibrations[0]
        self._reach = Reach(
            spec=self._spec,
            plan=plan,
            script_pa_gauge=np.array([known.closing_pressure(angle) for angle in plan.set_angle_deg]),
            highest_pa_gauge=float(known.curve.pressure_pa_gauge[-1]),
        )
        self._driver = Driver(self.env.episode, self._seen[9:15])
        self._lost, self._info = False, info
        self._near = self._nearness()
        return self._observed(), info

    def step(self, action: Vector) -> tuple[Vector, float, bool, bool, Info]:
        """Carry out one decision, and the lift after the last one."""
        target, pressures = self._reach.decide(action)
        self._go(target, pressures, self._spec.samples)
        past_stop_rad = self.env.episode.here.simulation.range_watch.farthest()[1]
        if past_stop_rad > (Guards().past_stop_rad or np.inf):
            self._lost, self._info = True, {**self._info, "is_success": False}
        near = self._nearness()
        reward, self._near = near - self._near, near
        if not (self._reach.over or self._lost):
            return self._observed(), reward, False, False, self._info
        return self._observed(), reward + self._lift_it(pressures), True, False, self._info

    def render(self) -> Any:
        """Return the picture of the environment inside."""
        return self.env.render()

    def close(self) -> None:
        """Free windows and GL contexts."""
        self.env.close()

    def _lift_it(self, pressures: Vector) -> float:
        """Lift, say in the info how that went, and return its reward."""
        lift, speed = self._lift, self.env.episode.here.settings.anatomy.wrist_speed_m_per_s
        # the last decision may end before the wrist has arrived: it is lifted from where it is
        up = self._driver.reference + np.array([0.0, 0.0, lift.height_m, 0.0, 0.0, 0.0])
        before, height_before = self._object(), self._info.get("object_height_m", 0.0)
        if not lift.if_touched or self.env.episode.here.touching():
            self._go(up, pressures, round((lift.height_m / speed + lift.hold_s) / SAMPLE_S))
        after = self._object()
        gained = 0.0 if self._lost else self._info["object_height_m"] - height_before
        share = min(max(gained / lift.height_m, 0.0), 1.0)
        slip = float(np.linalg.norm(after[:3] - before[:3]))
        tilt = 2.0 * float(np.arccos(min(abs(float(after[3:] @ before[3:])), 1.0)))
        lifted = share >= 0.8
        steady = lifted and slip <= lift.steady_m and tilt <= lift.steady_rad
        self._info = {**self._info, "object": self.env.episode.here.object.name, "lifted": lifted, "steady": steady}
        return share + float(steady)

    def _go(self, target: Vector, pressures: Vector, samples: int) -> None:
        """Ask for a wrist pose and set pressures for so many actions of the environment inside."""
        for _ in range(samples):
            if self._lost:
                return
            action = self._driver.toward(target, pressures)
            self._seen, _, self._lost, _, self._info = self.env.step(action)
            self._reach.see(1e3 * self._seen[:3], self._seen[3:9])

    def _object(self) -> Vector:
        here = self.env.episode.here
        data = here.simulation.data
        return np.nan_to_num(object_in_palm(data.xpos, data.xquat, here.simulation.index.palm_body, here.body))

    def _nearness(self) -> float:
        here = self.env.episode.here
        data = here.simulation.data
        if self._lost:
            return 0.0
        return 1.0 - float(np.tanh(10.0 * np.linalg.norm(data.xpos[here.body] - data.site_xpos[here.grasp_site])))

    def _observed(self) -> Vector:
        seen = self._reach.features(self._seen[9:15])
        if not self._privileged:
            return seen
        episode, here = self.env.episode, self.env.episode.here
        place = here.simulation.data.xpos[here.body]
        scales = (10.0 * self._object()[:3], self._object()[3:], 10.0 * np.nan_to_num(place))
        known = (10.0 * here.mass_kg(episode.draw), here.friction(episode.draw))
        return np.concatenate([seen, *scales, known])
