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
HEATS = 6
"""Choice: trials by which one of several found grasps is picked."""
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
    little about trials. One of several found grasps is picked by `HEATS` trials, of equals the one with the best score.
    """
    best = found[0]
    if len(found) > 1:
        heats = [held(one.plan, model, calibration, protocol, HEATS) for one in found]
        best = found[heats.index(max(heats))]
    scripted = rounded(plan_grasp(model))
    found_held = held(best.plan, model, calibration, protocol, TRIALS)
    same = scripted == best.plan
    scripted_held = found_held if same else held(scripted, model, calibration, protocol, TRIALS)
    kept = KeptGrasp(plan=scripted, closings=best.closings) if scripted_held > found_held else best
    return ProvenGrasp(kept=kept, found_held=found_held, scripted_held=scripted_held)


def held(
    plan: GraspPlan, model: ObjectModel, calibration: FingerCalibration, protocol: GraspProtocol, trials: int
) -> int:
    """Return in how many of so many trials a grasp holds."""
    setup = prepare(model, calibration, protocol=protocol, plan=plan)
    return sum(run_trial(setup, FIRST_SEED + k).outcome is Outcome.HELD for k in range(trials))
