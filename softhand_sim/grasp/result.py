"""The record of a grasp trial: the verdict and the figures it rests on."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import mujoco

from softhand_sim.elements import ELEMENTS, FINGERS
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.stage import SAMPLE_S, Stage
from softhand_sim.grasp.verdict import Figures, Outcome, judge
from softhand_sim.guards.caveats import caveats
from softhand_sim.guards.limits import Alarm
from softhand_sim.objects.model import ObjectModel


@dataclass(frozen=True, kw_only=True)
class TrialResult:
    """Verdict of one trial and the figures it rests on (SI units).

    Attributes
    ----------
    object, protocol, seed, outcome: what was tried, and how it ended.
    mass_kg, friction: of the object.
    phases_run: phases of the protocol begun; fewer than it has if the object was not there for the rest.
    lift_m: height of the object at the end over its rest on the table.
    slip_m, tilt_rad: way and turn of the object in the palm's frame since the mark (the start of the lift if the
        protocol has none), at the end; `worst_slip_m`, `worst_tilt_rad`: at their largest.
    creep_m_per_s: steady drift in the last hold.
    penetration_m: deepest contact of the object with anything in the whole trial; `hold_penetration_m`: with the hand,
        during holds.
    contacts, links: number of contacts of hand and object at the end, and the hand's bodies that touch.
    force_n: mean normal force of each finger and the palm on the object in the last hold.
    finger_contact_s, finger_penetration_m: time during which a finger touched another, and how deep.
    engine_warnings: the engine's warnings by name, with their number; empty if none.
    peak_pressure_pa_gauge: per element.
    beyond_calibration: what went beyond the calibrated range, and its extreme (`RangeWatch.beyond`).
    object_offset_m, object_offset_yaw_rad: displacement and turn of the object from where the hand expected it.
    simulated_s, wall_s: duration in simulated and in real time.
    caveats: why the scene's settings leave the result unverified (`softhand_sim.guards.caveats`), a line each.
    alarm: what a guard saw when it ended the trial (`softhand_sim.guards.limits.Alarm`), in a line; empty if none did.
    replay: file that repeats the alarm, if one was asked for.
    """

    object: str
    protocol: str
    seed: int
    outcome: Outcome
    mass_kg: float
    friction: float
    phases_run: int
    lift_m: float
    slip_m: float
    tilt_rad: float
    worst_slip_m: float
    worst_tilt_rad: float
    creep_m_per_s: float
    penetration_m: float
    hold_penetration_m: float
    contacts: int
    links: tuple[str, ...]
    force_n: dict[str, float]
    finger_contact_s: float
    finger_penetration_m: float
    engine_warnings: dict[str, int]
    peak_pressure_pa_gauge: dict[str, float]
    beyond_calibration: dict[str, float]
    object_offset_m: tuple[float, float]
    object_offset_yaw_rad: float
    simulated_s: float
    wall_s: float
    caveats: tuple[str, ...] = ()
    alarm: str = ""
    replay: str = ""


def result_of(
    stage: Stage,
    model: ObjectModel,
    protocol: GraspProtocol,
    *,
    seed: int,
    offset: tuple[float, float, float],
    phases_run: int,
    wall_s: float,
    ended: tuple[Alarm | None, str],
) -> TrialResult:
    """Judge a trial that has ended and put its record together.

    ``ended`` is the alarm of a guard, which is the outcome then, and the file that repeats it.
    """
    alarm, replay = ended
    simulation, recorder, thresholds = stage.simulation, stage.recorder, protocol.thresholds
    diverged = simulation.diverged
    slip, tilt = (0.0, 0.0) if diverged else recorder.slip_and_tilt(simulation)
    worst_slip, worst_tilt = (0.0, 0.0) if diverged else recorder.worst_slip_and_tilt()
    lift = 0.0 if diverged else recorder.lift_m(simulation)
    creep = 0.0 if diverged else recorder.creep_m_per_s()
    contacts, links = (0, ()) if diverged else recorder.touching(simulation)
    outcome = judge(
        thresholds,
        Figures(
            commanded_lift_m=protocol.lift_m,
            final_lift_m=lift,
            highest_lift_m=recorder.highest_lift_m,
            slip_m=worst_slip if thresholds.at_any_time else slip,
            tilt_rad=worst_tilt if thresholds.at_any_time else tilt,
            creep_m_per_s=creep,
            penetration_m=recorder.lifted_deepest_m,
            in_hand=contacts > 0,
            diverged=diverged,
        ),
    )
    return TrialResult(
        object=model.name,
        protocol=protocol.name,
        seed=seed,
        outcome=outcome if alarm is None else Outcome(alarm.kind.value),
        mass_kg=model.mass_kg,
        friction=model.friction,
        phases_run=phases_run,
        lift_m=lift,
        slip_m=slip,
        tilt_rad=tilt,
        worst_slip_m=worst_slip,
        worst_tilt_rad=worst_tilt,
        creep_m_per_s=creep,
        penetration_m=recorder.deepest_m,
        hold_penetration_m=recorder.lifted_deepest_m,
        contacts=contacts,
        links=links,
        force_n=_named((*FINGERS, "palm"), recorder.force_n()),
        finger_contact_s=recorder.finger_contact_samples * SAMPLE_S,
        finger_penetration_m=recorder.finger_deepest_m,
        engine_warnings=_warnings(simulation.data),
        peak_pressure_pa_gauge=_named(ELEMENTS, recorder.peak_pressure_pa_gauge),
        beyond_calibration=simulation.range_watch.beyond(),
        object_offset_m=offset[:2],
        object_offset_yaw_rad=offset[2],
        simulated_s=float(simulation.data.time),
        wall_s=wall_s,
        caveats=caveats(simulation.model),
        alarm="" if alarm is None else alarm.text(),
        replay=replay,
    )


def crashed(model: ObjectModel, protocol: GraspProtocol, seed: int) -> TrialResult:
    """Return the record of a trial whose process died: nothing was measured, all figures are zero."""
    return TrialResult(
        object=model.name,
        protocol=protocol.name,
        seed=seed,
        outcome=Outcome.CRASHED,
        mass_kg=model.mass_kg if protocol.mass_kg is None else protocol.mass_kg,
        friction=model.friction if protocol.friction is None else protocol.friction,
        phases_run=0,
        lift_m=0.0,
        slip_m=0.0,
        tilt_rad=0.0,
        worst_slip_m=0.0,
        worst_tilt_rad=0.0,
        creep_m_per_s=0.0,
        penetration_m=0.0,
        hold_penetration_m=0.0,
        contacts=0,
        links=(),
        force_n=dict.fromkeys((*FINGERS, "palm"), 0.0),
        finger_contact_s=0.0,
        finger_penetration_m=0.0,
        engine_warnings={},
        peak_pressure_pa_gauge=dict.fromkeys(ELEMENTS, 0.0),
        beyond_calibration={},
        object_offset_m=(0.0, 0.0),
        object_offset_yaw_rad=0.0,
        simulated_s=0.0,
        wall_s=0.0,
    )


def _named(names: Sequence[str], values: Iterable[float]) -> dict[str, float]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def _warnings(data: mujoco.MjData) -> dict[str, int]:
    kinds = [mujoco.mjtWarning(i) for i in range(int(mujoco.mjtWarning.mjNWARNING))]
    return {kind.name: int(data.warning[kind].number) for kind in kinds if data.warning[kind].number}
