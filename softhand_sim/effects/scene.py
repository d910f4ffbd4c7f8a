"""What an effect may know of a scene when it is asked whether the scene calls for it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.checks import require_finite
from softhand_sim.effects.bare import BareHand
from softhand_sim.effects.effects import Effects
from softhand_sim.effects.gravity import weight_bend_deg
from softhand_sim.effects.rehearsal import Rehearsal, rehearse
from softhand_sim.grasp.choice.shipped import default_grasp
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.hand.scene import build_root, compile_scene
from softhand_sim.objects.model import ObjectModel
from softhand_sim.relaxation import MaxwellBranch


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """How far a scene without some effects may be from the one with all of them.

    Attributes
    ----------
    angle_deg
        Of any fingertip's angle, from the lift's start on [deg].
    slip_m
        Of the object's slip in the hand [m].

    Raises
    ------
    ValueError
        If a tolerance is negative.
    """

    angle_deg: float
    slip_m: float

    def __post_init__(self) -> None:
        require_finite("angle_deg", self.angle_deg, at_least=0.0)
        require_finite("slip_m", self.slip_m, at_least=0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneFacts:
    """One grasp of one object with its plan, or a bare hand, and the effects that it could have.

    Attributes
    ----------
    calibration, hand
        The finger, and the hand alone, compiled with all its contacts.
    offered
        Effects with their parameters; None where an effect is not to be asked.
    set_pa_gauge
        Set pressures of the closing [Pa gauge], (3,).
    closed_s, end_s
        Time from the closing's start until angles count (a grasp's lift), and to the end [s].
    lift_m
        Height that an object is lifted by [m]; None without an object.
    survives
        Whether the grasp bears a disturbance (`grasp.trial.survives_more_mass`); asked once, if at all.
    rehearsal
        The closing in free air with everything offered; None without gas.
    """

    calibration: FingerCalibration
    hand: mujoco.MjModel
    offered: Effects
    set_pa_gauge: npt.NDArray[np.float64]
    closed_s: float
    end_s: float
    lift_m: float | None = None
    survives: Callable[[], bool] = lambda: False
    rehearsal: Rehearsal | None = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "rehearsal", self.rehearse(self.offered))

    @classmethod
    def of(
        cls,
        model: ObjectModel,
        calibration: FingerCalibration,
        offered: Effects,
        protocol: GraspProtocol | None = None,
        survives: Callable[[], bool] = lambda: False,
        plan: GraspPlan | None = None,
    ) -> "SceneFacts":
        """Return the facts of an object's grasp, its default one without a plan.

        Without `survives` it counts as one that may fail.
        """
        times, angles = protocol or load_protocol(), (plan or default_grasp(model)).set_angle_deg
        travel_s = times.lift_m / 0.1  # the wrist's speed (paper)
        return cls(
            calibration=calibration,
            hand=compile_scene(build_root(calibration)).model,
            offered=offered,
            set_pa_gauge=np.array([calibration.closing_pressure(angle) for angle in angles]),
            closed_s=times.close_s,
            end_s=times.close_s + travel_s + times.settle_s + HOLD_S,
            lift_m=times.lift_m,
            survives=survives,
        )

    @classmethod
    def bare(cls, scene: BareHand, calibration: FingerCalibration, offered: Effects) -> "SceneFacts":
        """Return the facts of a hand without an object."""
        return cls(
            calibration=calibration,
            hand=compile_scene(build_root(calibration)).model,
            offered=offered,
            set_pa_gauge=scene.set_pa_gauge(calibration),
            closed_s=scene.close_s,
            end_s=scene.close_s + scene.hold_s,
        )

    @cached_property
    def firm(self) -> bool:
        """Whether no small change decides what becomes of the object; always without one."""
        return self.lift_m is None or self.survives()

    @property
    def loss_deg(self) -> float:
        """How far a tip's angle can differ whatever happens [deg].

        A finger is at most as bent as a free one at its set pressure and a pulse, under its own weight, and at least
        straight.
        """
        curve, pulse = self.calibration.curve, 0.0 if self.rehearsal is None else self.rehearsal.pulse_pa
        free = np.interp(float(self.set_pa_gauge.max()) + pulse, curve.pressure_pa_gauge, curve.tip_angle_deg)
        return float(free) + weight_bend_deg(self)

    def rehearse(self, effects: Effects) -> Rehearsal | None:
        """Return the closing in free air with some effects."""
        return rehearse(effects, self.calibration, self.set_pa_gauge, self.end_s)

    @property
    def relaxation(self) -> tuple[MaxwellBranch, ...]:
        """Branches of the walls' relaxation that are offered."""
        return self.offered.relaxation or ()

    def angle_change_deg(self, pressure_pa: float) -> float:
        """Return how far a free tip falls short [deg] when pressures fall short of the set ones by so much [Pa]."""
        curve = self.calibration.curve
        low, high = self.set_pa_gauge - pressure_pa, self.set_pa_gauge
        ends = [np.interp(p, curve.pressure_pa_gauge, curve.tip_angle_deg) for p in (low, high)]
        return float((ends[1] - ends[0]).max())

    @property
    def band_deg(self) -> float:
        """Width of the controller's band, in angle [deg]: two runs that differ in anything may hold at either end.

        One pulse of the valve and two counts of the sensor, at the set pressure.
        """
        return CONTACT_FACTOR * self.angle_change_deg(self.band_pa)

    @property
    def band_pa(self) -> float:
        """Width of the controller's band [Pa]; 0 without gas."""
        if self.rehearsal is None:
            return 0.0
        sensor = self.offered.sensor
        return self.rehearsal.pulse_pa + 2.0 * (0.0 if sensor is None else sensor.resolution_pa)


HOLD_S = 3.0
"""Choice: how long after the lift a rehearsal goes on; pressures have settled long before, and leaks have shown."""

CONTACT_FACTOR = 1.5
"""Choice: fingers that press on an object, or on one another, shift their load when the pressure changes, and a joint
then moves by more than in free air."""
