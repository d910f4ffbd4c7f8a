"""The last word in the choice of a grasp: full trials of the best that searches found, beside the scripted one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.grasp.choice.grasp_file import KeptGrasp, rounded
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.refine import PARENTS, TriedGrasp, refined
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.trial import TrialSetup, prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.model import ObjectModel

TRIALS = 20
"""Choice: tells grasps apart that differ by a quarter."""
HEATS, FINALISTS = 6, 6
"""Choices: trials that each of several found grasps gets, and how many of them get all trials."""
FIRST_SEED = 1_000_000
"""Choice: far from the seeds of anybody's run, so that no run is of the trials that its grasp was chosen by."""
_STREAM = 8


@dataclass(frozen=True, kw_only=True)
class ProvenGrasp:
    """The best of several grasps, and how often it and the scripted one held in `TRIALS` trials.

    Attributes
    ----------
    kept: the grasp.
    found_held, scripted_held: trials held by the best grasp that was found (with `refine`, of trials that no variation
        was chosen by), and by the scripted one.
    trials: full trials that the choice took.
    """

    kept: KeptGrasp
    found_held: int
    scripted_held: int
    trials: int


def proven(
    found: Sequence[KeptGrasp],
    model: ObjectModel,
    calibration: FingerCalibration,
    protocol: GraspProtocol,
    *,
    refine: int = 0,
    seed: int = 0,
) -> ProvenGrasp:
    """Return the best of the found grasps, or the scripted one if that holds in more trials.

    Closings have no noise of the sensors, no friction in the fingers and a larger time step; scores that are close say
    little about trials. Those of several found grasps that hold most of `HEATS` trials get all of them. With `refine`,
    that many more trials go to variations of the best (`softhand_sim.grasp.refine`), in twice as many trials each;
    `TRIALS` others count as well then, since among many that were tried in the same trials some are lucky in them. Of
    equals the first one is kept.

    Parameters
    ----------
    found: grasps, best first.
    model, calibration, protocol: of the trials.
    refine: trials for variations.
    seed: of the variations; the trials' seeds begin with `FIRST_SEED`.
    """
    course = _Course(setup=prepare(model, calibration, protocol=protocol, plan=found[0].plan))
    several = len(found) > 1
    heats = [course.lost(one.plan, range(HEATS)) if several else () for one in found]
    best = sorted(range(len(found)), key=lambda k: len(heats[k]))[:FINALISTS]
    rest = range(HEATS if several else 0, TRIALS)
    tried = [TriedGrasp(kept=found[k], lost=heats[k] + course.lost(found[k].plan, rest)) for k in best]
    tried.sort(key=lambda one: len(one.lost))
    plan = rounded(plan_grasp(model))
    scripted = next((one for one in tried if one.kept.plan == plan), None)
    if scripted is None:
        kept = KeptGrasp(plan=plan, closings=found[0].closings)
        scripted = TriedGrasp(kept=kept, lost=course.lost(plan, range(TRIALS)))
    first = scripted if len(scripted.lost) < len(tried[0].lost) else tried[0]
    kept, held = first.kept, TRIALS - len(tried[0].lost)
    if refine and len(first.lost) < TRIALS:
        every = sorted([first, *tried], key=lambda one: len(one.lost))
        kept, held = _refined(
            list(dict.fromkeys(every))[:PARENTS], course, refine, np.random.default_rng([seed, _STREAM])
        )
    return ProvenGrasp(kept=kept, found_held=held, scripted_held=TRIALS - len(scripted.lost), trials=course.spent)


def _refined(
    tried: list[TriedGrasp], course: "_Course", budget: int, rng: np.random.Generator
) -> tuple[KeptGrasp, int]:
    """Vary grasps in twice `TRIALS`; return the best of all, and how many of `TRIALS` others it holds.

    Those that lose none in `TRIALS` may still lose one in ten.
    """
    more, others = range(TRIALS, 2 * TRIALS), range(2 * TRIALS, 3 * TRIALS)
    before = [TriedGrasp(kept=one.kept, lost=one.lost + course.lost(one.kept.plan, more)) for one in tried]
    before.sort(key=lambda one: len(one.lost))

    def holds(plan: GraspPlan, trial: int) -> bool:
        return not course.lost(plan, range(trial, trial + 1))

    after = refined(before, holds, trials=2 * TRIALS, budget=budget, rng=rng)
    rivals = list(dict.fromkeys([before[0], *after]))
    again = [len(course.lost(one.kept.plan, others)) for one in rivals]
    best = min(range(len(rivals)), key=lambda k: len(rivals[k].lost) + again[k])
    return rivals[best].kept, TRIALS - again[best]


@dataclass(kw_only=True)
class _Course:
    """The trials of one object, counted."""

    setup: TrialSetup
    spent: int = 0

    def lost(self, plan: GraspPlan, trials: range) -> tuple[int, ...]:
        """Return those of some trials, by their numbers from 0, that a grasp loses."""
        self.spent += len(trials)
        return lost_trials(replace(self.setup, plan=plan), trials)


def lost_trials(setup: TrialSetup, trials: range) -> tuple[int, ...]:
    """Return those of some trials, by their numbers from 0, that a grasp does not hold."""
    return tuple(k for k in trials if run_trial(setup, FIRST_SEED + k).outcome is not Outcome.HELD)
