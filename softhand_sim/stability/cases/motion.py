"""Fast moves, sudden commands, bodies left to themselves, commands that are no numbers."""

from functools import cache

import mujoco
import numpy as np

from softhand_sim.guards.limits import Guards
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.catalogue import make_object
from softhand_sim.stability.case import Finding, judged, refused, scene_cases
from softhand_sim.stability.scene_runs import REFERENCE_STEP_S, TYPED, World, ball, trial

HIGH = (0.0, 0.0, 0.4, 0.0, 0.0, 0.0)
FAR = (0.4, 0.4, 0.02)


def _stopped(timestep_s: float) -> tuple[World, float]:
    """Run 0.3 m at 1 m/s and stop dead, fingers at 40 kPa; return the world and the largest joint angle after it."""
    world = World.of(
        timestep_s,
        ball(0.02, 0.05, FAR),
        (-0.15, 0.0, 0.4, 0.0, 0.0, 0.0),
        anatomy=HandAnatomy(wrist_speed_m_per_s=1.0),
    )
    world.simulation.set_pressure_pa_gauge = np.full(3, 40e3)
    world.go(2.0)
    world.simulation.wrist_target = np.array([0.15, 0.0, 0.4, 0.0, 0.0, 0.0])
    largest = 0.0

    def look() -> None:
        nonlocal largest
        joints = world.simulation.data.qpos[world.simulation.index.joint_qpos]
        largest = max(largest, float(joints.sum(axis=1).max()))

    world.go(1.0, look)
    return world, largest


@cache
def _stopped_reference() -> float:
    return _stopped(REFERENCE_STEP_S)[1]


def sudden_stop(timestep_s: float) -> Finding:
    """Compare the fingers' swing after the stop with that at the reference step."""
    world, largest = _stopped(timestep_s)
    off = abs(np.degrees(largest - _stopped_reference()))
    return world.finding("largest tip angle against that at 0.5 ms [degrees], <= 1", float(off), 1.0)


def pressure_at_once(timestep_s: float) -> Finding:
    """No gas: 75 kPa from one step to the next and back, ten times; the fingers snap, and end straight."""
    world = World.of(timestep_s, ball(0.02, 0.05, FAR), (0.0, 0.0, 0.4, 0.0, 0.0, np.pi / 2), gas=False)
    simulation = world.simulation
    for _ in range(10):
        for pressure in (75e3, 0.0):
            simulation.set_pressure_pa_gauge = np.full(3, pressure)
            world.go(0.1)
    world.go(2.0)
    rest = float(np.abs(np.degrees(simulation.data.qpos[simulation.index.joint_qpos])).max())
    return world.finding("joint farthest from straight, at rest under its weight [degrees], <= 6", rest, 6.0)


def left_alone(timestep_s: float) -> Finding:
    """Run: a ball dropped onto the open hand, no pressure: the energy of a world left to itself never grows."""
    pose = (0.0, 0.0, 0.2, 0.0, 0.0, np.pi)
    world = World.of(timestep_s, ball(0.03, 0.1, (0.01, 0.0, 0.36)), pose, gas=False)
    simulation = world.simulation
    model, data, index = simulation.model, simulation.data, simulation.index
    gains = model.actuator_gainprm[index.wrist_ctrl, 0]
    lowest, rise = np.inf, 0.0
    for _ in range(round(2.0 / timestep_s)):
        simulation.step()
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
        servo = 0.5 * float(gains @ (data.actuator_length[index.wrist_ctrl] - np.array(pose)) ** 2)
        energy = float(data.energy.sum()) + servo
        lowest = min(lowest, energy)
        rise = max(rise, energy - lowest)
    world.go(0.1)
    # contacts are springs that store up to what the ball brings: 0.1 kg from 0.1 m
    return world.finding(
        "rise of the energy over its lowest so far, share of the ball's fall, <= 0.02", rise / 0.1, 0.02
    )


def coarse_step_refused(_timestep_s: float) -> Finding:
    """Run: a time step of 20 ms in the settings."""
    return refused("refused", lambda: EngineSettings(timestep_s=0.02))


def coarse_step_in_the_model(_timestep_s: float) -> Finding:
    """Run: a time step of 20 ms written into the compiled model behind the settings' back."""

    def change(model: mujoco.MjModel) -> None:
        model.opt.timestep = 0.02

    result = trial(make_object("apple"), 0.002, change=change)
    typed = result.alarm if result.outcome in TYPED else ""
    return judged(
        "told as unverified, or typed", 0.0 if result.caveats else 2.0, 1.0, typed=typed, caveats=result.caveats
    )


def _commanded(timestep_s: float, gas: bool, wrist: bool) -> Finding:
    world = World.of(timestep_s, ball(0.02, 0.05, FAR), HIGH, gas=gas)
    criterion = "refused or typed, never carried on with"
    try:
        if wrist:
            world.simulation.wrist_target = np.full(6, np.nan)
        else:
            world.simulation.set_pressure_pa_gauge = np.array([50e3, np.nan, 50e3])
        world.go(0.2)
    except ValueError as error:
        return judged(criterion, 0.0, -1.0, typed=f"REFUSED: {error}")
    return world.finding(criterion, 2.0, 1.0)


def no_number_as_pressure(timestep_s: float) -> Finding:
    """NaN as a set pressure, through gas and control."""
    return _commanded(timestep_s, gas=True, wrist=False)


def no_number_as_ideal_pressure(timestep_s: float) -> Finding:
    """NaN as a set pressure that acts at once: the engine takes zero in its place."""
    return _commanded(timestep_s, gas=False, wrist=False)


def no_number_as_wrist(timestep_s: float) -> Finding:
    """NaN as the wrist's target: the engine takes zero in its place, and the hand dives into the table."""
    return _commanded(timestep_s, gas=True, wrist=True)


def far_too_much_pressure(timestep_s: float) -> Finding:
    """140 kPa for a finger calibrated to 80: the engine would cut it in silence."""
    world = World.of(timestep_s, ball(0.02, 0.05, FAR), HIGH)
    world.simulation.set_pressure_pa_gauge = np.full(3, 140e3)
    world.go(1.0)
    return world.finding("told as far beyond the calibration", 2.0, 1.0)


def long_hold(timestep_s: float) -> Finding:
    """Run: a ball between fingers and palm for 20 s: creep without end is what soft contact does."""
    world = World.of(
        timestep_s, ball(0.033, 0.06, (0.01, 0.0, 0.26)), (0.0, 0.0, 0.2, 0.0, 0.0, np.pi), guards=Guards(energy_j=0.02)
    )
    world.simulation.set_pressure_pa_gauge = np.full(3, 60e3)
    world.go(4.0)
    world.recorder.start_hold()
    world.go(20.0, lambda: world.recorder.sample_hold(world.simulation))
    return world.finding("creep [m/s], <= 0.001", world.recorder.creep_m_per_s(), 1e-3)


KINDS = scene_cases(
    (
        "wrist at 1 m/s and a sudden stop",
        "ten times the wrist's speed, stopped in a step",
        "swing as at 0.5 ms",
        sudden_stop,
    ),
    (
        "75 kPa at once and back, ten times",
        "no gas between command and finger",
        "straight at the end",
        pressure_at_once,
    ),
    ("ball dropped onto an open hand", "impact, then nothing drives it", "energy never grows", left_alone),
    ("time step of 20 ms in the settings", "four times the largest", "refused by name", coarse_step_refused),
    (
        "time step of 20 ms in the model",
        "written behind the settings' back",
        "told or typed",
        coarse_step_in_the_model,
    ),
    ("NaN as a set pressure", "no number", "refused by name", no_number_as_pressure),
    ("NaN as a set pressure without gas", "the engine takes zero instead", "typed", no_number_as_ideal_pressure),
    ("NaN as the wrist's target", "the engine takes zero instead", "typed", no_number_as_wrist),
    ("140 kPa asked of a finger", "calibrated to 80", "typed", far_too_much_pressure),
    ("hold of 20 s", "soft contacts creep by design", "creep below 1 mm/s", long_hold),
)
