"""The last word in the choice of a grasp: full trials of the best that a search found, beside the scripted one."""

from collections.abc import Sequence
from dataclasses import dataclass

from softhand_sim.calibration import FingerCalibration
from softhand_sim.grasp.choice.grasp_file import KeptGrasp, rounded
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.model import ObjectModel

TRIALS = 20
"""Choice: tells grasps apart that differ by a quarter; costs as much as the search."""
HEATS, FINALISTS = 6, 3
"""Choices: trials that each of several found grasps gets, and how many of them get all trials."""
FIRST_SEED = 1_000_000
"""Choice: far from the seeds of anybody's run, so that no run is of the trials that its grasp was chosen by."""


@dataclass(frozen=True, kw_only=True)
class ProvenGrasp:
    """The better one of two grasps, and how often each of them held in `TRIALS` trials."""

    kept: KeptGrasp
    found_held: int
    scripted_held: int


def proven(
    found: Sequence[KeptGrasp], model: ObjectModel, calibration: FingerCalibration, protocol: GraspProtocol
) -> ProvenGrasp:
    """Return the best of the found grasps, or the scripted one if that holds in more trials.

    Closings have no noise of the sensors, no friction in the fingers and a larger time step; scores that are close say
    little about trials. Those of several found grasps that hold most of `HEATS` trials get all of them; of equals the
    one with the better score is kept.
    """

    def holds(plan: GraspPlan, trials: range) -> int:
        return held(plan, model, calibration, protocol, trials)

    scripted = rounded(plan_grasp(model))
    heats = [holds(one.plan, range(HEATS)) if len(found) > 1 else 0 for one in found]
    begun = HEATS if len(found) > 1 else 0
    finalists = sorted(range(len(found)), key=lambda k: -heats[k])[:FINALISTS]
    full = [heats[k] + holds(found[k].plan, range(begun, TRIALS)) for k in finalists]
    found_held = max(full)
    best = found[finalists[full.index(found_held)]]
    scripted_held = found_held if scripted == best.plan else holds(scripted, range(TRIALS))
    kept = KeptGrasp(plan=scripted, closings=best.closings) if scripted_held > found_held else best
    return ProvenGrasp(kept=kept, found_held=found_held, scripted_held=scripted_held)


def held(
    plan: GraspPlan, model: ObjectModel, calibration: FingerCalibration, protocol: GraspProtocol, trials: range
) -> int:
    """Return in how many of some trials, by their numbers from 0, a grasp holds."""
    setup = prepare(model, calibration, protocol=protocol, plan=plan)
    return sum(run_trial(setup, FIRST_SEED + k).outcome is Outcome.HELD for k in trials)
