"""What leaving one effect out changes in a scene, measured by running both."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects.bare import BareHand
from softhand_sim.effects.effects import NEED_GAS, Effects
from softhand_sim.grasp.trial import TrialSetup, run_trial
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.simulation import HandSimulation

_NOISE_CHANGE = 1.01
SCATTER = "noise 1 % larger"
"""Name of the run that leaves nothing out: how much a grasp scatters by itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneRun:
    """One run of a scene.

    Attributes
    ----------
    tip_angle_deg: every 20 ms from a grasp's lift, or the end of a bare hand's closing, on [deg], shape (n, 5).
    slip_m: of the object in the hand; at most the height of the lift, by which a lost one stays behind; 0 without one.
    verdict: of the trial; empty without an object.
    processor_s: time of this thread [s], which other work on the machine disturbs less than the clock's.
    """

    tip_angle_deg: npt.NDArray[np.float64]
    slip_m: float
    verdict: str
    processor_s: float


@dataclass(frozen=True, kw_only=True)
class Omission:
    """Change against the run with everything.

    Attributes
    ----------
    effect: what was left out.
    angle_deg: largest difference of any fingertip's angle at any time from the lift's start on [deg].
    slip_m: difference of the slip in the hand [m].
    same_outcome: whether the verdict stayed.
    time_ratio: processor time without the effect over that with everything.
    """

    effect: str
    angle_deg: float
    slip_m: float
    same_outcome: bool
    time_ratio: float


def without_each(effects: Effects) -> Mapping[str, Effects]:
    """Return the effects without each of those present; without gas also without what needs it."""
    gone: dict[str, Effects] = {}
    for name in effects.present:
        names = {name}
        if name == "gas":
            names |= set(NEED_GAS)
        gone[name] = replace(effects, **dict.fromkeys(names))
    if effects.sensor is not None:
        louder = replace(effects.sensor, noise_v=_NOISE_CHANGE * effects.sensor.noise_v)
        gone[SCATTER] = replace(effects, sensor=louder)
    return gone


def run_grasp(setup: TrialSetup, seed: int) -> SceneRun:
    """Run one trial."""
    rows: list[npt.NDArray[np.float64]] = []
    times: list[float] = []

    def watch(simulation: HandSimulation) -> None:
        times.append(float(simulation.data.time))
        rows.append(np.degrees(simulation.tip_angles_rad()))

    began = time.thread_time()
    result = run_trial(setup, seed, watch)
    took = time.thread_time() - began
    protocol = setup.protocol
    late = np.array(times) >= protocol.approach_m / 0.1 + protocol.settle_s + protocol.close_s
    slip_m = min(result.slip_m, protocol.lift_m)
    return SceneRun(tip_angle_deg=np.array(rows)[late], slip_m=slip_m, verdict=str(result.outcome), processor_s=took)


def run_bare(
    scene: BareHand,
    calibration: FingerCalibration,
    effects: Effects,
    seed: int,
    engine: EngineSettings | None = None,
) -> SceneRun:
    """Run a hand without an object."""
    angles, took = scene.run(calibration, effects, seed, engine=engine)
    return SceneRun(tip_angle_deg=angles, slip_m=0.0, verdict="", processor_s=took)


def omission(effect: str, everything: SceneRun, without: SceneRun) -> Omission:
    """Compare two runs of the same scene."""
    n = min(len(everything.tip_angle_deg), len(without.tip_angle_deg))
    apart = np.abs(everything.tip_angle_deg[:n] - without.tip_angle_deg[:n])
    return Omission(
        effect=effect,
        angle_deg=float(apart.max(initial=0.0)),
        slip_m=abs(everything.slip_m - without.slip_m),
        same_outcome=everything.verdict == without.verdict,
        time_ratio=without.processor_s / everything.processor_s,
    )
