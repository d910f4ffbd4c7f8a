"""One grasp trial: approach, close, the protocol's phases, verdict."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects import BENCH, Effects
from softhand_sim.effects.auto import Answer, choose
from softhand_sim.effects.build import apply_to_contacts, apply_to_model, build_losses, build_pneumatics
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.grasp.choice.shipped import default_grasp
from softhand_sim.grasp.place import place_object, stand_off
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.record import Recorder
from softhand_sim.grasp.result import TrialResult, result_of
from softhand_sim.grasp.stage import SAMPLE_S, Stage
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.guards.limits import Guards
from softhand_sim.guards.replay import save_replay
from softhand_sim.guards.watch import Watch
from softhand_sim.hand.scene import EngineSettings, Scene, build_scene, for_friction
from softhand_sim.losses import Losses
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.policy.policy_file import Policy
from softhand_sim.policy.trial import reach_and_close
from softhand_sim.simulation import HandSimulation

STRESS_SEEDS, STRESS_MASS_RATIO = (900, 901, 902), 1.25
"""Choices: trials that stand for all offsets of a protocol, where a scene is to serve for any; heavier object."""


@dataclass(frozen=True, kw_only=True)
class TrialSetup:
    """Everything that trials of one object share: built once, used for any number of seeds.

    Set pressures are looked up in ``control``, the fingers' own calibration by default. A ``policy`` reaches and closes
    in the place of the script. ``guards`` end a trial that can't be trusted.
    """

    model: ObjectModel
    calibration: FingerCalibration
    scene: Scene
    plan: GraspPlan
    pneumatics: PneumaticSystem | None
    losses: Losses
    protocol: GraspProtocol
    answers: tuple[Answer, ...] = ()
    control: FingerCalibration | None = None
    policy: Policy | None = None
    guards: Guards = field(default_factory=Guards)


def prepare(  # noqa: PLR0913 - one keyword for each thing that a caller may choose
    model: ObjectModel,
    calibration: FingerCalibration,
    *,
    protocol: GraspProtocol | None = None,
    engine: EngineSettings | None = None,
    effects: Effects = BENCH,
    tolerance: Tolerance | None = None,
    plan: GraspPlan | None = None,
    control: FingerCalibration | None = None,
    links: int | None = None,
) -> TrialSetup:
    """Build the scene of an object; by default for the paper's protocol and with the object's `default_grasp`.

    With ``links`` fingers are chains of that many hinges. ``control`` is the calibration that the controller knows,
    where that is not the fingers' own. With a tolerance, effects that the scene does not call for are left out
    (`choose`), and `TrialSetup.answers` says why.
    """
    protocol = protocol or load_protocol()
    model = model.with_overrides(mass_kg=protocol.mass_kg, friction=protocol.friction)
    answers: tuple[Answer, ...] = ()
    if tolerance is not None:
        effects, answers = choose(facts_of(model, calibration, effects, protocol, plan=plan), tolerance)

    def add_object(root: Any) -> None:
        apply_to_model(effects, root)
        attach_object(root, model)
        apply_to_contacts(effects, root)

    engine = for_friction(engine or EngineSettings(), model.friction)
    scene = build_scene(calibration, engine=engine, add_object=add_object, links=links)
    return TrialSetup(
        model=model,
        calibration=calibration,
        scene=scene,
        plan=default_grasp(model) if plan is None else plan,
        pneumatics=build_pneumatics(effects, calibration),
        losses=build_losses(effects, calibration),
        protocol=protocol,
        answers=answers,
        control=control,
    )


def facts_of(
    model: ObjectModel,
    calibration: FingerCalibration,
    offered: Effects,
    protocol: GraspProtocol | None = None,
    seeds: Sequence[int] = STRESS_SEEDS,
    plan: GraspPlan | None = None,
) -> SceneFacts:
    """Return what the effects may know of a grasp, `survives_more_mass` included."""

    def survives() -> bool:
        return survives_more_mass(model, calibration, protocol, seeds, plan)

    return SceneFacts.of(model, calibration, offered, protocol, survives, plan)


def survives_more_mass(
    model: ObjectModel,
    calibration: FingerCalibration,
    protocol: GraspProtocol | None,
    seeds: Sequence[int],
    plan: GraspPlan | None = None,
) -> bool:
    """Whether the trials of some seeds are all held with a heavier object: a margin that small changes don't use up.

    Choice: a quarter more mass, with `BENCH`; the effects that may be left out with an object in the hand change the
    thrust of a finger by up to a tenth.
    """
    heavier = model.with_overrides(mass_kg=STRESS_MASS_RATIO * model.mass_kg)
    setup = prepare(heavier, calibration, protocol=replace(protocol or load_protocol(), mass_kg=None), plan=plan)
    return all(run_trial(setup, seed).outcome is Outcome.HELD for seed in seeds)


def run_trial(
    setup: TrialSetup,
    seed: int,
    watch: Callable[[HandSimulation], None] | None = None,
    replays: Path | None = None,
) -> TrialResult:
    """Run one trial; the same setup and seed give the same result to the bit (but for `wall_s`).

    Parameters
    ----------
    setup: scene, grasp, protocol.
    seed: of the object's offset and the sensors' noise, 0 or above.
    watch: called every 20 ms of simulated time, for pictures.
    replays: folder that gets a replay file where a guard ends the trial (`softhand_sim.guards.replay`).
    """
    started = time.perf_counter()
    rng = np.random.default_rng(seed)
    offset = setup.protocol.draw_offset(rng, seed)
    simulation = HandSimulation(
        model=setup.scene.model, calibration=setup.calibration, pneumatics=setup.pneumatics, losses=setup.losses
    )
    simulation.reset(rng, setup.plan.standoff(setup.protocol.approach_m))
    place_object(simulation, setup.model.rest_height_m, offset)
    stand_off(simulation, setup.plan, setup.protocol.approach_m)
    stage = Stage(
        simulation=simulation,
        recorder=Recorder.of(simulation, setup.model.rest_height_m),
        mass_kg=setup.model.mass_kg,
        settle_s=setup.protocol.settle_s,
    )
    guard = Watch(simulation=simulation, recorder=stage.recorder, limits=setup.guards)
    phases_run = 0
    for done, number in _commands(setup, stage):
        phases_run = number
        guard.keep()
        while guard.alarm is None and not done():
            _advance(stage, guard)
            if watch is not None:
                watch(simulation)
        if guard.alarm is not None:
            break
    return result_of(
        stage,
        setup.model,
        setup.protocol,
        seed=seed,
        offset=offset,
        phases_run=phases_run,
        wall_s=time.perf_counter() - started,
        ended=(guard.alarm, _kept(setup, seed, guard, replays)),
    )


def _kept(setup: TrialSetup, seed: int, guard: Watch, folder: Path | None) -> str:
    """Write a replay file if a guard ended the trial; return its path, or why there is none."""
    if guard.alarm is None or folder is None:
        return ""
    path = folder / f"{setup.model.name}_{setup.protocol.name}_{seed}_{guard.alarm.kind.value.lower()}.npz"
    about = {"object": setup.model.name, "protocol": setup.protocol.name, "seed": seed}
    try:
        save_replay(path, guard, setup.scene.xml, about)
    except (ValueError, OSError) as error:
        # the trial's own result must not be lost with it
        return f"none: {error}"
    return str(path)


def _advance(stage: Stage, guard: Watch) -> None:
    simulation = stage.simulation
    steps = max(1, round(SAMPLE_S / simulation.dt))
    if stage.drive is None:
        simulation.advance(steps)
    else:
        for _ in range(steps):
            stage.drive()
            guard.driven.append(simulation.wrist_reference)
            simulation.step()
    stage.recorder.sample(simulation)
    guard.look()


def _commands(setup: TrialSetup, stage: Stage) -> Iterator[tuple[Callable[[], bool], int]]:
    """Give each command, then yield the question whether it is over, and the number of the protocol's phase."""
    simulation = stage.simulation
    known = setup.calibration if setup.control is None else setup.control
    closing_pa_gauge = setup.protocol.closing_pressures_pa_gauge(known, setup.plan.set_angle_deg)
    if setup.policy is None:
        simulation.wrist_target = setup.plan.standoff(0.0)
        yield stage.arrived, 0
        yield stage.after(stage.settle_s), 0
        simulation.set_pressure_pa_gauge = closing_pa_gauge
        yield stage.after(setup.protocol.close_s), 0
    else:
        highest = float(known.curve.pressure_pa_gauge[-1])
        for done in reach_and_close(setup.policy, simulation, setup.plan, closing_pa_gauge, highest):
            yield done, 0
    stage.recorder.mark(simulation)
    for number, phase in enumerate(setup.protocol.phases, start=1):
        if phase.needs_object and not _in_hand(setup, stage):
            return
        for done in phase.run(stage):
            yield done, number


def _in_hand(setup: TrialSetup, stage: Stage) -> bool:
    lifted = stage.recorder.lift_m(stage.simulation) >= setup.protocol.thresholds.lifted_m
    return lifted and stage.recorder.touching(stage.simulation)[0] > 0
