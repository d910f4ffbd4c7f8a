"""What a policy decides while it reaches and closes, what it sees for that, and the commands that follow.

A policy takes the place of the scripted approach: from the standoff of a grasp plan it makes a fixed number of
decisions, each of which holds for a while. A decision moves and turns the palm on from where the script has it, in the
palm's frame of the plan, and changes how far each element is filled. With all actions at zero the script is what
happens. Places add up from decision to decision, so that random actions try out ways, not jitter.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from softhand_sim.checks import require_in
from softhand_sim.grasp.plan import GraspPlan, palm_axes, pose_of_palm
from softhand_sim.hand.hand import HINGE_RANGE_RAD, SLIDE_RANGE_M

Vector = npt.NDArray[np.float64]

SAMPLE_S = 0.04
"""Choice: how often a policy reads sensors and valves between decisions: every other tick of the controller."""
ACTIONS = 9
"""Position x, y, z and turn about x, y, z in the palm's frame, then thumb, index, middle-ring-little."""
_WRIST_RANGE = np.array([*SLIDE_RANGE_M, *[HINGE_RANGE_RAD] * 3])


@dataclass(frozen=True, kw_only=True)
class ReachSpec:
    """How a policy's decisions are laid out in time and how far they may go.

    Attributes
    ----------
    decisions
        Number of decisions from the standoff to the end of closing.
    decision_s
        Time that each holds [s], a multiple of `SAMPLE_S`.
    approach_decisions
        Decisions at the start in which the script keeps the fingers open.
    step_m, step_rad
        What an action of 1 adds to the position [m] and to the turn (a rotation vector's component [rad]).
    across_share
        Share of `step_m` that an action may take across the palm's normal: fingers that close from the side clear the
        table by millimetres.
    closing_share
        Share of these steps that an action may take while the script closes: a hand that wanders loses what it holds.
    reach_m, turn_rad
        Farthest from the script, along each axis [m] and of each component [rad].
    pressure_share
        Change of a set pressure for an action of 1, as share of the highest.

    Raises
    ------
    ValueError
        If a value is out of range; the message names the field.
    """

    decisions: int = 10
    decision_s: float = 0.48
    approach_decisions: int = 4
    step_m: float = 0.03
    step_rad: float = 0.1
    across_share: float = 0.3
    closing_share: float = 0.2
    reach_m: float = 0.08
    turn_rad: float = 0.4
    pressure_share: float = 0.5

    def __post_init__(self) -> None:
        require_in("decisions", self.decisions, 1, 100)
        require_in("decision_s", self.decision_s, SAMPLE_S, 10.0)
        require_in("approach_decisions", self.approach_decisions, 0, self.decisions)
        require_in("step_m", self.step_m, 0.0, 0.2)
        require_in("step_rad", self.step_rad, 0.0, 1.0)
        require_in("across_share", self.across_share, 0.0, 1.0)
        require_in("closing_share", self.closing_share, 0.0, 1.0)
        require_in("reach_m", self.reach_m, 1e-3, 0.2)
        require_in("turn_rad", self.turn_rad, 1e-3, 1.0)
        require_in("pressure_share", self.pressure_share, 0.0, 1.0)
        if abs(self.decision_s / SAMPLE_S - round(self.decision_s / SAMPLE_S)) > 1e-6:
            raise ValueError(f"decision_s: {self.decision_s} must be a multiple of {SAMPLE_S}")

    @property
    def samples(self) -> int:
        """Readings of sensors and valves within a decision."""
        return round(self.decision_s / SAMPLE_S)

    @property
    def features(self) -> int:
        """Number of values that a policy sees: 19 and one for each decision."""
        return 19 + self.decisions


@dataclass(kw_only=True)
class Reach:
    """One reach under way: gathers what the hardware says, turns actions into commands.

    Attributes
    ----------
    spec, plan
        What the policy corrects.
    script_pa_gauge
        Set pressures of the script when it closes [Pa gauge], (3,).
    highest_pa_gauge
        Highest set pressure [Pa gauge].
    step
        Decisions taken so far.
    """

    spec: ReachSpec
    plan: GraspPlan
    script_pa_gauge: Vector
    highest_pa_gauge: float
    step: int = 0
    _axes: Vector = field(init=False)
    _reading: Vector = field(init=False)
    _open: Vector = field(init=False)
    _moved: Vector = field(init=False)
    _turned: Vector = field(init=False)
    _seen: int = 0

    def __post_init__(self) -> None:
        self._axes = palm_axes(self.plan.wrist_pose)
        self._reading, self._open = np.zeros(3), np.zeros(6)
        self._moved, self._turned = np.zeros(3), np.zeros(3)

    @property
    def over(self) -> bool:
        """Whether all decisions were taken."""
        return self.step >= self.spec.decisions

    @property
    def readings(self) -> int:
        """Times that sensors and valves were read since the last decision."""
        return self._seen

    def see(self, reading_pa_gauge: Vector, valves_open: Vector) -> None:
        """Take in readings [Pa gauge], (3,), and valves (1 open), (6,), every `SAMPLE_S` after a decision."""
        self._reading, self._seen = reading_pa_gauge, self._seen + 1
        self._open = self._open + valves_open

    def features(self, wrist_pose: Vector) -> Vector:
        """Return what the policy sees, (features,), for the measured wrist pose (6,) in m and rad.

        Readings over the highest set pressure (3); share of the time since the last decision in which each valve was
        open (6), which tells how much air went in, and so whether something stopped a finger; the palm's place in the
        plan's frame over `ReachSpec.reach_m` (3) and its turn there over `ReachSpec.turn_rad` (3); the plan's height in
        decimetres (1), and the vertical along its axes (3); which decision it is, one-hot.
        """
        spec, axes = self.spec, self._axes
        away = axes.T @ (wrist_pose[:3] - np.array(self.plan.wrist_pose[:3]))
        turn = Rotation.from_matrix(axes.T @ palm_axes(tuple(wrist_pose))).as_rotvec()
        now = np.zeros(spec.decisions)
        now[min(self.step, spec.decisions - 1)] = 1.0
        return np.concatenate(
            [
                self._reading / self.highest_pa_gauge,
                self._open / max(self._seen, 1),
                away / spec.reach_m,
                turn / spec.turn_rad,
                [10.0 * self.plan.wrist_pose[2]],
                axes[2],
                now,
            ]
        )

    def decide(self, action: Vector) -> tuple[Vector, Vector]:
        """Return wrist target (6,) in m and rad and set pressures [Pa gauge], (3,), of an action (9,) in [-1, 1].

        Values beyond are clipped, as are targets beyond the wrist's range.
        """
        spec = self.spec
        a = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)
        closing = self.step >= spec.approach_decisions
        share = spec.closing_share if closing else 1.0
        step_m = share * spec.step_m * np.array([spec.across_share, spec.across_share, 1.0])
        self._moved = np.clip(self._moved + step_m * a[:3], -spec.reach_m, spec.reach_m)
        self._turned = np.clip(self._turned + share * spec.step_rad * a[3:6], -spec.turn_rad, spec.turn_rad)
        place = np.array(self.plan.wrist_pose[:3]) + self._axes @ self._moved
        turned = self._axes @ Rotation.from_rotvec(self._turned).as_matrix()
        target = np.array(pose_of_palm(place, turned))
        # the turn without a whole one more
        planned = np.array(self.plan.wrist_pose[3:])
        target[3:] -= 2.0 * np.pi * np.round((target[3:] - planned) / (2.0 * np.pi))
        pressures = self.script_pa_gauge * closing + spec.pressure_share * self.highest_pa_gauge * a[6:]
        self.step += 1
        self._open, self._seen = np.zeros(6), 0
        return np.clip(target, *_WRIST_RANGE.T), np.clip(pressures, 0.0, self.highest_pa_gauge)
