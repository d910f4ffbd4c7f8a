"""Training with stable-baselines3: an actor that sees the hardware, a critic that sees the simulation's state as well.

The critic serves training alone, so it may know where the object is (L. Pinto et al., "Asymmetric actor critic for
image-based robot learning", RSS 2018); the actor's inputs from there on are zero.
"""

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from functools import partial
from importlib.metadata import version
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecEnv
from tqdm import tqdm

from envs.reach import PRIVILEGED, ReachEnv
from scripts._learning import LearningConfig
from softhand_sim.policy.network import Network
from softhand_sim.policy.policy_file import Policy


@dataclass(kw_only=True)
class Curve:
    """What happened in each update: episodes so far, shares lifted and steady, by object, processor and wall time."""

    rows: list[dict[str, Any]] = field(default_factory=list)


class Masked(BaseFeaturesExtractor):
    """Passes an observation on, with its last ``blind`` values at zero."""

    def __init__(self, space: Any, blind: int = 0) -> None:
        super().__init__(space, space.shape[0])
        mask = torch.ones(space.shape[0])
        mask[space.shape[0] - blind :] = 0.0
        self.register_buffer("mask", mask)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the observations, (n, features)."""
        return observations * self.mask


class AsymmetricPolicy(ActorCriticPolicy):
    """Actor and critic of the library, of which the actor does not see the privileged values."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        kwargs |= {
            "share_features_extractor": False,
            "features_extractor_class": Masked,
            "features_extractor_kwargs": {"blind": PRIVILEGED},
        }
        super().__init__(*args, **kwargs)
        # neither has anything to learn, so the optimiser need not know
        self.vf_features_extractor = Masked(self.observation_space)


class _Watch(BaseCallback):
    """Notes how episodes end, and shows it."""

    def __init__(self, curve: Curve, episodes: int) -> None:
        super().__init__()
        self._curve, self._bar = curve, tqdm(total=episodes, desc="training", unit="episode", disable=None)
        self._ended: list[dict[str, Any]] = []
        self._episodes, self._began = 0, time.perf_counter()

    def _on_step(self) -> bool:
        for done, info in zip(self.locals["dones"], self.locals["infos"], strict=True):
            if done:
                self._ended.append(info)
                self._bar.update()
        return True

    def _on_rollout_end(self) -> None:
        ended, self._ended = self._ended, []
        if not ended:
            return
        self._episodes += len(ended)
        names = sorted({info["object"] for info in ended})
        by_object = {n: float(np.mean([i["steady"] for i in ended if i["object"] == n])) for n in names}
        row: dict[str, Any] = {name: float(np.mean([info[name] for info in ended])) for name in ("lifted", "steady")}
        row |= {"episodes": self._episodes, "steady_by_object": by_object}
        print(f"{self._episodes} episodes: {row['steady']:.2f} lifted steadily", flush=True)
        row["action_std"] = float(self.model.policy.log_std.detach().exp().mean())
        row["wall_s"] = time.perf_counter() - self._began
        self._curve.rows.append(row)
        self._bar.set_postfix(steady=f"{row['steady']:.2f}")

    def _on_training_end(self) -> None:
        self._bar.close()


def train(config: LearningConfig, seed: int) -> tuple[Policy, Curve]:
    """Train a policy; the same seed and number of workers give the same policy on the same machine."""
    torch.set_num_threads(1)
    ppo, decisions = config.ppo, config.decisions.decisions
    worlds = _worlds(config)
    try:
        steps = max(1, math.ceil(ppo.episodes_an_update / config.workers)) * decisions
        model = PPO(
            AsymmetricPolicy,
            worlds,
            n_steps=steps,
            batch_size=max(2, math.ceil(steps * config.workers / ppo.batches)),
            n_epochs=ppo.epochs,
            learning_rate=ppo.learning_rate,
            gamma=ppo.discount,
            gae_lambda=ppo.gae_lambda,
            target_kl=ppo.target_kl,
            seed=seed,
            policy_kwargs={
                "log_std_init": math.log(ppo.first_std),
                "net_arch": {"pi": [ppo.hidden], "vf": [ppo.hidden, ppo.hidden]},
            },
            device="cpu",
        )
        curve = Curve()
        model.learn(config.episodes * decisions, callback=_Watch(curve, config.episodes))
    finally:
        worlds.close()
    about = (
        f"stable-baselines3 {version('stable-baselines3')} PPO, torch {version('torch')}, seed {seed}, "
        f"{curve.rows[-1]['episodes']} episodes on {', '.join(config.objects)}, "
        f"offsets of {1e3 * config.position_m:g} mm; {asdict(ppo)}"
    )
    return Policy(network=actor(model.policy, config.decisions.features), spec=config.decisions, about=about), curve


def actor(policy: Any, features: int) -> Network:
    """Return a trained actor in NumPy; weights of what it does not see are left out."""
    layers = [m for m in (*policy.mlp_extractor.policy_net, policy.action_net) if isinstance(m, torch.nn.Linear)]
    weights = [layer.weight.detach().numpy().astype(np.float64) for layer in layers]
    weights[0] = weights[0][:, :features]
    biases = [layer.bias.detach().numpy().astype(np.float64) for layer in layers]
    return Network(weights=tuple(weights), biases=tuple(biases))


def _worlds(config: LearningConfig) -> VecEnv:
    make: list[Callable[[], ReachEnv]] = [partial(_world, config)] * config.workers
    return DummyVecEnv(make) if config.workers == 1 else SubprocVecEnv(make, start_method="spawn")


def _world(config: LearningConfig) -> ReachEnv:
    return ReachEnv(
        spec=config.decisions,
        privileged=True,
        objects=config.objects,
        randomization=config.randomization,
    )
