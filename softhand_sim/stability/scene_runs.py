"""What the scene cases share: trials against a reference step, and worlds that are watched by the guards."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.record import Recorder
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.stage import SAMPLE_S
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.guards.caveats import caveats
from softhand_sim.guards.limits import Alarm, AlarmKind, Guards
from softhand_sim.guards.watch import Watch
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.scene import EngineSettings, build_scene
from softhand_sim.objects.model import ObjectModel
from softhand_sim.simulation import HandSimulation, default_pneumatics
from softhand_sim.stability.case import Finding, judged

Vector = npt.NDArray[np.float64]

REFERENCE_STEP_S = 5e-4
"""Choice: a quarter of the default step, as in the benchmark's step check."""
SEED = 0
DEEPEST_M = 2e-3
"""Choice: what a held object may sink into a finger (`Thresholds.penetration_m`)."""
TYPED = {Outcome(kind.value) for kind in AlarmKind}


@cache
def shipped() -> FingerCalibration:
    """Return the shipped finger."""
    return load_calibration()


def stiffened(factor: float) -> FingerCalibration:
    """Return the shipped finger with joints that are stiffer by a factor."""
    finger = shipped()
    names = ("stiffness_n_m_per_rad", "stiffness_n_m_per_rad2", "stiffness_n_m_per_rad3")
    joints = tuple(replace(j, **{name: factor * getattr(j, name) for name in names}) for j in finger.joints)
    return replace(finger, joints=joints)


def trial(
    model: ObjectModel,
    timestep_s: float,
    *,
    calibration: FingerCalibration | None = None,
    change: Callable[[Any], None] | None = None,
    seed: int = SEED,
) -> TrialResult:
    """Return a trial: scripted grasp, lift of 0.1 m, 3 s of hold; ``change`` is made to the compiled model."""
    protocol = replace(load_protocol(), phases=(Lift(height_m=0.1), Hold(duration_s=3.0)))
    engine = EngineSettings(timestep_s=timestep_s)
    setup = prepare(
        model, calibration or shipped(), protocol=protocol, engine=engine, plan=plan_grasp(model), control=shipped()
    )
    if change is not None:
        change(setup.scene.model)
    return run_trial(setup, seed)


@dataclass(frozen=True, kw_only=True)
class Grasped:
    """A grasp case: an object, and the finger that grasps it; compared with the same at the reference step, if any."""

    make: Callable[[], ObjectModel]
    stiffness: float = 1.0
    seed: int = SEED
    reference_step_s: float | None = REFERENCE_STEP_S

    def __call__(self, timestep_s: float) -> Finding:
        """Run at a step; the figure is 1 for another verdict, else the depth over what is allowed."""
        result = trial(self.make(), timestep_s, calibration=self._finger(), seed=self.seed)
        criterion = "same verdict as at 0.5 ms; depth over 5 mm, <= 1"
        if result.outcome in TYPED:
            return judged(criterion, 0.0, 1.0, typed=result.alarm or result.outcome.value)
        reference = result.outcome if self.reference_step_s is None else _reference(self, self.reference_step_s)
        depth = max(result.penetration_m, result.finger_penetration_m) / 5e-3
        flipped = result.outcome is not reference
        detail = f"{result.outcome.value}, at the reference step {reference.value}"
        return judged(criterion, 2.0 if flipped else depth, 1.0, caveats=result.caveats, detail=detail)

    def _finger(self) -> FingerCalibration | None:
        return None if self.stiffness == 1.0 else stiffened(self.stiffness)


@cache
def _reference(case: Grasped, step_s: float) -> Outcome:
    return trial(case.make(), step_s, calibration=case._finger(), seed=case.seed).outcome


@dataclass(kw_only=True)
class World:
    """A hand and perhaps an object, under the guards."""

    simulation: HandSimulation
    recorder: Recorder
    watch: Watch
    deepest_m: float = 0.0

    @classmethod
    def of(
        cls,
        timestep_s: float,
        add_object: Callable[[Any], Any],
        wrist_pose: tuple[float, ...],
        *,
        calibration: FingerCalibration | None = None,
        gas: bool = True,
        anatomy: HandAnatomy | None = None,
        guards: Guards | None = None,
    ) -> "World":
        """Build a world at rest; ``add_object`` adds the body ``object`` with its free joint."""
        finger = calibration or shipped()
        scene = build_scene(finger, add_object=add_object, engine=EngineSettings(timestep_s=timestep_s))
        simulation = HandSimulation(
            model=scene.model,
            calibration=finger,
            pneumatics=default_pneumatics(finger) if gas else None,
            anatomy=anatomy or HandAnatomy(),
        )
        simulation.reset(np.random.default_rng(SEED), np.array(wrist_pose))
        recorder = Recorder.of(simulation, 0.0)
        watch = Watch(simulation=simulation, recorder=recorder, limits=guards or Guards())
        return cls(simulation=simulation, recorder=recorder, watch=watch)

    def go(self, duration_s: float, each: Callable[[], None] = lambda: None) -> Alarm | None:
        """Advance tick by tick, calling ``each`` after every one, until a guard fires."""
        steps = max(1, round(SAMPLE_S / self.simulation.dt))
        self.watch.keep()
        end_s = self.simulation.data.time + duration_s
        while self.watch.alarm is None and self.simulation.data.time < end_s - 1e-9:
            self.simulation.advance(steps)
            self.recorder.sample(self.simulation)
            if self.simulation.data.ncon:
                self.deepest_m = max(self.deepest_m, -float(self.simulation.data.contact.dist.min()))
            self.watch.look()
            each()
        return self.watch.alarm

    def finding(self, criterion: str, figure: float, limit: float) -> Finding:
        """Return the finding of this world: a guard's alarm is a typed end, flags and caveats are warnings."""
        alarm = self.watch.alarm
        beyond = self.simulation.range_watch.beyond()
        flags = (f"beyond the calibration: {', '.join(beyond)}",) if beyond else ()
        typed = "" if alarm is None else alarm.text()
        return judged(criterion, figure, limit, typed=typed, caveats=caveats(self.simulation.model), flags=flags)


def ball(
    radius_m: float, mass_kg: float, place_m: tuple[float, float, float], friction: float = 0.8
) -> Callable[[Any], Any]:
    """Return what adds a ball as the body ``object``, contact as soft as that of objects."""
    return _body({"type": "sphere", "size": (radius_m,)}, mass_kg, place_m, friction)


def box(
    half_m: tuple[float, float, float], mass_kg: float, place_m: tuple[float, float, float]
) -> Callable[[Any], Any]:
    """Return what adds a box as the body ``object``."""
    return _body({"type": "box", "size": half_m}, mass_kg, place_m, 0.8)


def _body(
    shape: dict[str, Any], mass_kg: float, place_m: tuple[float, float, float], friction: float
) -> Callable[[Any], Any]:
    def add(root: Any) -> Any:
        body = root.worldbody.add("body", name="object", pos=place_m)
        body.add("freejoint", name="object_joint")
        body.add(
            "geom", mass=mass_kg, condim=4, friction=(friction, 0.002, 1e-4), solref=(0.006, 1.0), priority=1, **shape
        )
        return body

    return add
