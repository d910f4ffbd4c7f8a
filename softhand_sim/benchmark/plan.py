"""What a benchmark runs, and its division into shards."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from softhand_sim.calibration import load_calibration
from softhand_sim.effects import BENCH, Effects
from softhand_sim.effects.scene import Tolerance
from softhand_sim.grasp.choice.shipped import default_grasp
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.trial import TrialSetup, prepare, run_trial
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.model import ObjectModel
from softhand_sim.policy.policy_file import Policy

# choice: small enough to keep two workers busy to the end, large enough to share the building of a scene
TRIALS_A_SHARD = 5


@dataclass(frozen=True, kw_only=True)
class Shard:
    """An object and the seeds of some of its trials."""

    model: ObjectModel
    seeds: tuple[int, ...]


@dataclass(frozen=True, kw_only=True)
class BenchmarkPlan:
    """What to run.

    Attributes
    ----------
    objects: the objects, each with its own name.
    trials: per object; their seeds are ``seed .. seed + trials - 1``, the same for every object.
    calibration: finger calibration file; None for the shipped one.
    control: calibration file that set pressures are looked up in; None for that of the fingers.
    protocol, engine, effects: what a trial does, the engine's settings, and the effects of the scene.
    tolerance: within it each scene leaves out the effects that it does not call for; None: it has all of them.
    grasps: by the name of the object; the others get their `default_grasp`.
    policy: reaches and closes in the place of the script; None for the script.
    replays: folder for the replay files of trials that a guard ends.
    """

    objects: tuple[ObjectModel, ...]
    trials: int
    seed: int = 0
    calibration: Path | None = None
    control: Path | None = None
    protocol: GraspProtocol = field(default_factory=load_protocol)
    engine: EngineSettings = field(default_factory=EngineSettings)
    effects: Effects = BENCH
    tolerance: Tolerance | None = None
    grasps: Mapping[str, GraspPlan] = field(default_factory=dict)
    policy: Policy | None = None
    replays: Path | None = None

    def __post_init__(self) -> None:
        names = [model.name for model in self.objects]
        if not names or len(set(names)) != len(names):
            raise ValueError(f"objects: {names} must be one or more different names")
        if self.trials < 1 or self.seed < 0:
            raise ValueError(f"trials: {self.trials} must be 1 or above, seed: {self.seed} 0 or above")

    def grasp(self, model: ObjectModel) -> GraspPlan:
        """Return the grasp of one of the objects."""
        return self.grasps.get(model.name) or default_grasp(model)

    @property
    def trial_keys(self) -> tuple[tuple[str, int], ...]:
        """All trials as object's name and seed, in order."""
        return tuple((model.name, seed) for model in self.objects for seed in self.seeds)

    @property
    def seeds(self) -> range:
        """Seeds of each object's trials."""
        return range(self.seed, self.seed + self.trials)

    def shards(self, wanted: frozenset[tuple[str, int]]) -> list[Shard]:
        """Return the wanted trials, given as object's name and seed, in pieces."""
        shards = []
        for model in self.objects:
            open_seeds = [seed for seed in self.seeds if (model.name, seed) in wanted]
            pieces = (open_seeds[i : i + TRIALS_A_SHARD] for i in range(0, len(open_seeds), TRIALS_A_SHARD))
            shards += [Shard(model=model, seeds=tuple(piece)) for piece in pieces]
        return shards

    def without_objects(self) -> "BenchmarkPlan":
        """Return the plan with one object only: a shard carries its own, the others need not travel with it."""
        return replace(self, objects=self.objects[:1])


def tapered(shards: Sequence[Shard], workers: int) -> list[Shard]:
    """Return shards of the same trials in the same order, shorter towards the end, so that all workers end together.

    Choice: none is longer than a third of what is left for each worker; at the end they are single trials.
    """
    left, pieces = sum(len(shard.seeds) for shard in shards), []
    for shard in shards:
        seeds = shard.seeds
        while seeds:
            size = max(1, left // (3 * workers))
            pieces.append(Shard(model=shard.model, seeds=seeds[:size]))
            seeds, left = seeds[size:], left - len(pieces[-1].seeds)
    return pieces


def prepare_for(plan: BenchmarkPlan, model: ObjectModel) -> TrialSetup:
    """Return what the trials of one object of the plan share."""
    control = None if plan.control is None else load_calibration(plan.control)
    setup = prepare(
        model,
        load_calibration(plan.calibration),
        protocol=plan.protocol,
        engine=plan.engine,
        effects=plan.effects,
        tolerance=plan.tolerance,
        control=control,
        plan=plan.grasp(model),
    )
    return replace(setup, policy=plan.policy)


def run_shard(plan: BenchmarkPlan, shard: Shard, last: TrialSetup | None) -> tuple[TrialSetup, Iterator[TrialResult]]:
    """Return what the trials of a shard share, and their results as they are asked for.

    `last` is that of the shard before: it serves again if the object is the same (names are unique within a plan).
    """
    setup = last if last is not None and last.model.name == shard.model.name else prepare_for(plan, shard.model)
    return setup, (run_trial(setup, seed, replays=plan.replays) for seed in shard.seeds)
