"""What a learning run is told: a TOML file, read and checked before anything starts."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from assets import asset_path
from envs.randomization import Randomization
from softhand_sim.checks import require_in
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.objects.catalogue import load_catalogue
from softhand_sim.policy.reach import ReachSpec


@dataclass(frozen=True, kw_only=True)
class PpoSettings:
    """Settings of proximal policy optimisation (choices, but for the usual discount and clipping of libraries).

    Attributes
    ----------
    episodes_an_update, epochs, batches
        Episodes gathered before an update, passes over them, and mini-batches in a pass.
    learning_rate, discount, gae_lambda, target_kl
        As usual; an update ends early at 1.5 times the target.
    first_std
        Standard deviation of actions at the start.
    hidden
        Units of each hidden layer.
    """

    episodes_an_update: int
    epochs: int
    batches: int
    learning_rate: float
    discount: float
    gae_lambda: float
    target_kl: float
    first_std: float
    hidden: int

    def __post_init__(self) -> None:
        limits = {
            "episodes_an_update": (1, 10_000), "epochs": (1, 100), "batches": (1, 100), "learning_rate": (1e-7, 1.0),
            "discount": (0.0, 1.0), "gae_lambda": (0.0, 1.0), "target_kl": (1e-4, 10.0), "first_std": (1e-3, 2.0),
            "hidden": (1, 1024),
        }  # fmt: skip
        for name, (low, high) in limits.items():
            require_in(f"ppo.{name}", getattr(self, name), low, high)


@dataclass(frozen=True, kw_only=True)
class EvaluationSettings:
    """Protocol, trials an object, and the seed of the first."""

    protocol: str
    trials: int
    first_seed: int

    def __post_init__(self) -> None:
        load_protocol(self.protocol)
        require_in("evaluation.trials", self.trials, 1, 100_000)
        require_in("evaluation.first_seed", self.first_seed, 0, 2**31)


@dataclass(frozen=True, kw_only=True)
class LearningConfig:
    """A learning run; see `assets/policies/reach.toml`.

    Attributes
    ----------
    objects, unseen
        Catalogue names: trained on, and only evaluated.
    position_m, yaw_rad
        Largest displacement of the object along x and y [m], and turn [rad].
    episodes
        To train for.
    workers
        Processes with an environment each.
    decisions, ppo, evaluation
        Tables of their own.

    Raises
    ------
    ValueError
        If a value is unknown or out of range; the message names the key.
    """

    objects: tuple[str, ...]
    unseen: tuple[str, ...]
    position_m: float
    yaw_rad: float
    episodes: int
    workers: int
    decisions: ReachSpec
    ppo: PpoSettings
    evaluation: EvaluationSettings

    def __post_init__(self) -> None:
        known = set(load_catalogue())
        if not self.objects or len(set(self.objects + self.unseen)) < len(self.objects + self.unseen):
            raise ValueError("objects, unseen: must be one or more, each once")
        for name in (*self.objects, *self.unseen):
            if name not in known:
                raise ValueError(f"objects, unseen: {name!r} is not in the catalogue")
        require_in("episodes", self.episodes, 1, 10_000_000)
        require_in("workers", self.workers, 1, 256)
        _ = self.randomization

    @property
    def randomization(self) -> Randomization:
        """What is drawn in training."""
        return Randomization(position_m=self.position_m, yaw_rad=self.yaw_rad)


DEFAULT = asset_path("policies", "reach.toml")


def load_config(path: Path | None) -> LearningConfig:
    """Read a configuration, None for the shipped one.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no TOML, or a key is unknown, missing or out of range; names file and key.
    """
    path = DEFAULT if path is None else path
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such configuration")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        parts = {"decisions": ReachSpec, "ppo": PpoSettings, "evaluation": EvaluationSettings}
        for name, kind in parts.items():
            if not isinstance(data.get(name), dict):
                raise ValueError(f"[{name}]: must be a table")
            data[name] = kind(**_keys(data[name], kind, f"{name}."))
        for name in ("objects", "unseen"):
            if not isinstance(data.get(name), list):
                raise ValueError(f"{name}: must be a list of catalogue names")
            data[name] = tuple(data[name])
        return LearningConfig(**_keys(data, LearningConfig, ""))
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None


def _keys(values: Mapping[str, Any], kind: type[Any], where: str) -> dict[str, Any]:
    wanted = {f.name: f.type for f in fields(kind)}
    if strange := sorted(set(values) ^ set(wanted)):
        what = "missing" if strange[0] in wanted else "unknown"
        raise ValueError(f"{where}{strange[0]}: {what}")
    for name, value in values.items():
        if wanted[name] is int and (isinstance(value, bool) or not isinstance(value, int)):
            raise ValueError(f"{where}{name} = {value!r}: must be a whole number")
    return dict(values)
