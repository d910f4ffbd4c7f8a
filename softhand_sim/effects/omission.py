"""What leaving one effect out changes in a grasp, measured by running both."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects.effects import NEED_GAS, Effects
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.objects.model import ObjectModel
from softhand_sim.simulation import HandSimulation

_NOISE_CHANGE = 1.01
SCATTER = "noise 1 % larger"
"""Name of the run that leaves nothing out: how much a grasp scatters by itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class GraspRun:
    """A trial's result, tip angles [deg] every 20 ms from the lift's start on, shape (n, 5), and what it took.

    ``processor_s`` is the time of this thread [s], which other work on the machine disturbs less than the clock's.
    """

    result: TrialResult
    tip_angle_deg: npt.NDArray[np.float64]
    processor_s: float


@dataclass(frozen=True, kw_only=True)
class Omission:
    """Change against the run with everything.

    Attributes
    ----------
    effect: what was left out.
    angle_deg: largest difference of any fingertip's angle at any time from the lift's start on [deg].
    slip_m: difference of the slip in the hand [m].
    same_outcome: whether the verdict stayed; where it did not, the other two are those of a lost object.
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


def grasp(model: ObjectModel, calibration: FingerCalibration, effects: Effects, seed: int) -> GraspRun:
    """Run one trial with some effects."""
    setup = prepare(model, calibration, effects=effects)
    rows: list[npt.NDArray[np.float64]] = []
    times: list[float] = []

    def watch(simulation: HandSimulation) -> None:
        times.append(float(simulation.data.time))
        rows.append(np.degrees(simulation.tip_angles_rad()))

    began = time.thread_time()
    result = run_trial(setup, seed, watch)
    took = time.thread_time() - began
    protocol = setup.protocol
    closed_s = protocol.approach_m / 0.1 + protocol.settle_s + protocol.close_s
    late = np.array(times) >= closed_s
    return GraspRun(result=result, tip_angle_deg=np.array(rows)[late], processor_s=took)


def omission(effect: str, everything: GraspRun, without: GraspRun) -> Omission:
    """Compare two runs of the same trial."""
    n = min(len(everything.tip_angle_deg), len(without.tip_angle_deg))
    apart = np.abs(everything.tip_angle_deg[:n] - without.tip_angle_deg[:n])
    return Omission(
        effect=effect,
        angle_deg=float(apart.max(initial=0.0)),
        slip_m=abs(everything.result.slip_m - without.result.slip_m),
        same_outcome=everything.result.outcome is without.result.outcome,
        time_ratio=without.processor_s / everything.processor_s,
    )
