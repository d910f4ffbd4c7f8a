"""What a benchmark runs, and its division into shards."""

from dataclasses import dataclass, field, replace
from pathlib import Path

from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import TrialSetup, prepare
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.model import ObjectModel

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
    protocol, engine: what a trial does, and the engine's settings.
    """

    objects: tuple[ObjectModel, ...]
    trials: int
    seed: int = 0
    calibration: Path | None = None
    control: Path | None = None
    protocol: GraspProtocol = field(default_factory=load_protocol)
    engine: EngineSettings = field(default_factory=EngineSettings)

    def __post_init__(self) -> None:
        names = [model.name for model in self.objects]
        if not names or len(set(names)) != len(names):
            raise ValueError(f"objects: {names} must be one or more different names")
        if self.trials < 1 or self.seed < 0:
            raise ValueError(f"trials: {self.trials} must be 1 or above, seed: {self.seed} 0 or above")

    @property
    def seeds(self) -> range:
        """Seeds of each object's trials."""
        return range(self.seed, self.seed + self.trials)

    def shards(self, done: frozenset[tuple[str, int]] = frozenset()) -> list[Shard]:
        """Return the work in pieces, without the trials, as object's name and seed, that are done already."""
        shards = []
        for model in self.objects:
            open_seeds = [seed for seed in self.seeds if (model.name, seed) not in done]
            pieces = (open_seeds[i : i + TRIALS_A_SHARD] for i in range(0, len(open_seeds), TRIALS_A_SHARD))
            shards += [Shard(model=model, seeds=tuple(piece)) for piece in pieces]
        return shards

    def without_objects(self) -> "BenchmarkPlan":
        """Return the plan with one object only: a shard carries its own, the others need not travel with it."""
        return replace(self, objects=self.objects[:1])


def prepare_for(plan: BenchmarkPlan, model: ObjectModel) -> TrialSetup:
    """Return what the trials of one object of the plan share."""
    control = None if plan.control is None else load_calibration(plan.control)
    fingers = load_calibration(plan.calibration)
    return prepare(model, fingers, protocol=plan.protocol, engine=plan.engine, control=control)
