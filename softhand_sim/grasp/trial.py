"""One grasp trial: approach, close, lift, hold, verdict."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects import BENCH, Effects
from softhand_sim.effects.auto import Answer, choose
from softhand_sim.effects.build import apply_to_model, build_losses, build_pneumatics
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.elements import ELEMENTS
from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.protocol import LiftProtocol
from softhand_sim.grasp.record import Recorder
from softhand_sim.grasp.scripted import GraspPlan, plan_grasp
from softhand_sim.grasp.verdict import Outcome, Thresholds, judge
from softhand_sim.hand.scene import EngineSettings, Scene, build_scene
from softhand_sim.losses import Losses
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.simulation import HandSimulation

# the sensor's and the controller's rate; the recorder samples at the same
SAMPLE_S = 0.02


@dataclass(frozen=True, kw_only=True)
class TrialResult:
    """Verdict of one trial and the figures it rests on (SI units; `peak_pressure_pa_gauge` per element).

    `beyond_calibration` holds what went beyond the calibrated range, and its extreme (`RangeWatch.beyond`).
    """

    object: str
    seed: int
    outcome: Outcome
    lift_m: float
    slip_m: float
    tilt_rad: float
    creep_m_per_s: float
    penetration_m: float
    peak_pressure_pa_gauge: dict[str, float]
    object_offset_m: tuple[float, float]
    object_offset_yaw_rad: float
    simulated_s: float
    wall_s: float
    beyond_calibration: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class TrialSetup:
    """Everything that trials of one object share: built once, used for any number of seeds."""

    model: ObjectModel
    calibration: FingerCalibration
    scene: Scene
    plan: GraspPlan
    pneumatics: PneumaticSystem | None
    losses: Losses
    protocol: LiftProtocol = field(default_factory=LiftProtocol)
    thresholds: Thresholds = field(default_factory=Thresholds)
    answers: tuple[Answer, ...] = ()


def prepare(
    model: ObjectModel,
    calibration: FingerCalibration,
    *,
    protocol: LiftProtocol | None = None,
    engine: EngineSettings | None = None,
    effects: Effects = BENCH,
    tolerance: Tolerance | None = None,
) -> TrialSetup:
    """Build the scene of an object and choose its grasp.

    With a tolerance, effects that the scene does not call for are left out (`choose`), and `TrialSetup.answers` says
    why.
    """
    answers: tuple[Answer, ...] = ()
    if tolerance is not None:
        effects, answers = choose(SceneFacts.of(model, calibration, effects, protocol), tolerance)

    def add_object(root: Any) -> None:
        apply_to_model(effects, root)
        attach_object(root, model)

    scene = build_scene(calibration, engine=engine, add_object=add_object)
    return TrialSetup(
        model=model,
        calibration=calibration,
        scene=scene,
        plan=plan_grasp(model),
        pneumatics=build_pneumatics(effects, calibration),
        losses=build_losses(effects, calibration),
        protocol=protocol or LiftProtocol(),
        answers=answers,
    )


def run_trial(setup: TrialSetup, seed: int, watch: Callable[[HandSimulation], None] | None = None) -> TrialResult:
    """Run one trial; the same setup and seed give the same result to the bit (but for `wall_s`).

    Parameters
    ----------
    setup: scene, grasp, protocol.
    seed: of the object's offset and the sensors' noise, 0 or above.
    watch: called every 20 ms of simulated time, for pictures.
    """
    started = time.perf_counter()
    rng = np.random.default_rng(seed)
    offset = setup.protocol.draw_offset(rng)
    simulation = HandSimulation(
        model=setup.scene.model, calibration=setup.calibration, pneumatics=setup.pneumatics, losses=setup.losses
    )
    simulation.reset(rng, setup.plan.standoff(setup.protocol.approach_m))
    place_object(simulation, setup.model.rest_height_m, offset)
    recorder = Recorder.of(simulation, setup.model.rest_height_m)
    for phase in _phases(setup, simulation, recorder):
        while not phase():
            _advance(simulation, recorder)
            if watch is not None:
                watch(simulation)
            if simulation.diverged:
                break
        if simulation.diverged:
            break
    return _result(setup, simulation, recorder, seed, offset, time.perf_counter() - started)


def _advance(simulation: HandSimulation, recorder: Recorder) -> None:
    for _ in range(max(1, round(SAMPLE_S / simulation.dt))):
        simulation.step()
    recorder.sample(simulation)


def _phases(setup: TrialSetup, simulation: HandSimulation, recorder: Recorder) -> Iterator[Callable[[], bool]]:
    """Give each phase's command, then yield the question whether it is over."""
    protocol, data = setup.protocol, simulation.data
    grasp = setup.plan.standoff(0.0)

    def until(end_s: float) -> Callable[[], bool]:
        return lambda: bool(data.time >= end_s)

    def arrived() -> bool:
        return simulation.wrist_arrived

    simulation.wrist_target = grasp
    yield arrived
    yield until(data.time + protocol.settle_s)
    simulation.set_pressure_pa_gauge = np.array(
        [setup.calibration.closing_pressure(angle) for angle in setup.plan.set_angle_deg]
    )
    yield until(data.time + protocol.close_s)
    recorder.mark_lift_start(simulation)
    simulation.wrist_target = grasp + np.array([0, 0, protocol.lift_m, 0, 0, 0])
    yield arrived
    yield until(data.time + protocol.settle_s)
    end_s = data.time + protocol.hold_s

    def held() -> bool:
        recorder.sample_hold(simulation)
        return bool(data.time >= end_s)

    yield held


def _result(
    setup: TrialSetup,
    simulation: HandSimulation,
    recorder: Recorder,
    seed: int,
    offset: tuple[float, float, float],
    wall_s: float,
) -> TrialResult:
    diverged = simulation.diverged
    slip, tilt = (0.0, 0.0) if diverged else recorder.slip_and_tilt(simulation)
    lift = 0.0 if diverged else recorder.lift_m(simulation)
    outcome = judge(
        thresholds=setup.thresholds,
        commanded_lift_m=setup.protocol.lift_m,
        final_lift_m=lift,
        highest_lift_m=recorder.highest_lift_m,
        slip_m=slip,
        tilt_rad=tilt,
        diverged=diverged,
    )
    peaks = zip(ELEMENTS, recorder.peak_pressure_pa_gauge, strict=True)
    return TrialResult(
        object=setup.model.name,
        seed=seed,
        outcome=outcome,
        lift_m=lift,
        slip_m=slip,
        tilt_rad=tilt,
        creep_m_per_s=0.0 if diverged else recorder.creep_m_per_s(),
        penetration_m=recorder.deepest_m,
        peak_pressure_pa_gauge={name: float(value) for name, value in peaks},
        object_offset_m=offset[:2],
        object_offset_yaw_rad=offset[2],
        simulated_s=float(simulation.data.time),
        wall_s=wall_s,
        beyond_calibration=simulation.range_watch.beyond(),
    )
