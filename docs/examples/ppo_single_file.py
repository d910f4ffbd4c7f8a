"""Proximal policy optimisation in one file: torch, NumPy, Gymnasium, and nothing else of a learning library.

The clipped objective of J. Schulman et al., "Proximal policy optimization algorithms", arXiv:1707.06347, with
generalised advantages (arXiv:1506.02438), on the vector environments that run in the engine's own threads. To read,
copy and change; settings stand at the top.

    python docs/examples/ppo_single_file.py --env SoftHandReorient-v0 --steps 200000 --seed 0
"""

import argparse
import time
from itertools import pairwise

import gymnasium
import numpy as np
import torch
from torch import nn
from torch.distributions import Normal

import envs  # noqa: F401 - registers the environments

WORLDS, THREADS = 16, 2
ROLLOUT, EPOCHS, BATCHES = 125, 8, 8
LEARNING_RATE, DISCOUNT, GAE_LAMBDA = 3e-4, 0.99, 0.95
CLIP, VALUE_WEIGHT, LARGEST_GRADIENT = 0.2, 0.5, 0.5


def layers(sizes: list[int], last_gain: float) -> nn.Sequential:
    """Return linear layers with tanh between them, orthogonal at the start."""
    parts: list[nn.Module] = []
    for k, (n, m) in enumerate(pairwise(sizes)):
        linear = nn.Linear(n, m)
        last = k == len(sizes) - 2
        nn.init.orthogonal_(linear.weight, last_gain if last else 2.0**0.5)
        nn.init.zeros_(linear.bias)
        parts += [linear] if last else [linear, nn.Tanh()]
    return nn.Sequential(*parts)


class Agent(nn.Module):
    """Actor and critic; observations are scaled by a running mean and deviation."""

    def __init__(self, observed: int, acted: int) -> None:
        super().__init__()
        self.actor = layers([observed, 64, 64, acted], 0.01)
        self.critic = layers([observed, 64, 64, 1], 1.0)
        self.log_std = nn.Parameter(torch.full((acted,), -0.5))
        self.register_buffer("mean", torch.zeros(observed))
        self.register_buffer("variance", torch.ones(observed))
        self.count = 1e-4

    def learn_scale(self, x: torch.Tensor) -> None:
        """Take observations (n, o) into the running mean and variance (Chan et al., 1979)."""
        n, shift = len(x), x.mean(0) - self.mean
        total = self.count + n
        spread = self.variance * self.count + x.var(0, unbiased=False) * n + shift**2 * self.count * n / total
        self.mean += shift * n / total
        self.variance.copy_(spread / total)
        self.count = total

    def scaled(self, x: torch.Tensor) -> torch.Tensor:
        """Return observations (n, o) in deviations from their mean, at most 10."""
        return ((x - self.mean) / (self.variance + 1e-8).sqrt()).clamp(-10.0, 10.0)

    def forward(self, x: torch.Tensor) -> tuple[Normal, torch.Tensor]:
        """Return the distribution of actions and the values, (n,), of scaled observations (n, o)."""
        mean = self.actor(x)
        return Normal(mean, self.log_std.exp().expand_as(mean)), self.critic(x).squeeze(-1)


def advantages(reward: np.ndarray, value: np.ndarray, ended: np.ndarray) -> np.ndarray:
    """Return generalised advantages (t, n) of rewards (t, n), values (t + 1, n), and where episodes ended (t, n)."""
    out, following = np.zeros_like(reward), np.zeros(reward.shape[1])
    for t in reversed(range(len(reward))):
        going_on = 1.0 - ended[t]
        error = reward[t] + DISCOUNT * going_on * value[t + 1] - value[t]
        out[t] = following = error + DISCOUNT * GAE_LAMBDA * going_on * following
    return out


def update(agent: Agent, optimiser: torch.optim.Optimizer, data: dict[str, torch.Tensor]) -> None:
    """Improve actor and critic on one rollout, tensors of (m, ...) each."""
    size = len(data["return"])
    for indices in (part for _ in range(EPOCHS) for part in torch.randperm(size).chunk(BATCHES)):
        batch = {name: values[indices] for name, values in data.items()}
        actions, value = agent(batch["seen"])
        ratio = (actions.log_prob(batch["action"]).sum(-1) - batch["log_prob"]).exp()
        gain = (batch["advantage"] - batch["advantage"].mean()) / (batch["advantage"].std() + 1e-8)
        clipped = torch.minimum(ratio * gain, ratio.clamp(1.0 - CLIP, 1.0 + CLIP) * gain)
        loss = -clipped.mean() + VALUE_WEIGHT * (value - batch["return"]).square().mean()
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(agent.parameters(), LARGEST_GRADIENT)
        optimiser.step()


def main() -> None:
    """Train."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--env", default="SoftHandReorient-v0", help="id (default %(default)s)")
    parser.add_argument("--steps", type=int, default=200_000, help="of all worlds together (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of networks, actions and episodes (default 0)")
    args = parser.parse_args()
    torch.manual_seed(args.seed)
    torch.set_num_threads(1)
    worlds = gymnasium.make_vec(args.env, num_envs=WORLDS, threads=THREADS, observation_mode="state")
    agent = Agent(worlds.single_observation_space.shape[0], worlds.single_action_space.shape[0])
    optimiser = torch.optim.Adam(agent.parameters(), lr=LEARNING_RATE, eps=1e-5)
    seen = worlds.reset(seed=args.seed)[0]
    # the step after an episode's last one only resets it (Gymnasium's NEXT_STEP): nothing is learned from it
    resetting, began = np.zeros(WORLDS, dtype=bool), time.perf_counter()
    for done in range(0, args.steps, ROLLOUT * WORLDS):
        rows: dict[str, list[np.ndarray]] = {k: [] for k in ("seen", "action", "log_prob", "value", "reward")}
        rows |= {"ended": [], "resetting": []}
        solved: list[float] = []
        for _ in range(ROLLOUT):
            raw = torch.as_tensor(seen, dtype=torch.float32)
            agent.learn_scale(raw)
            with torch.no_grad():
                x = agent.scaled(raw)
                actions, value = agent(x)
                action = actions.sample()
                log_prob = actions.log_prob(action).sum(-1)
            seen, reward, terminated, truncated, info = worlds.step(action.clamp(-1.0, 1.0).numpy())
            # a truncated episode is taken as ended too: the time left is not observed
            ended = terminated | truncated
            now = (x.numpy(), action.numpy(), log_prob.numpy(), value.numpy(), reward, ended, resetting.copy())
            for name, values in zip(rows, now, strict=True):
                rows[name].append(values)
            solved += info["is_success"][ended].tolist() if ended.any() else []
            resetting = ended
        with torch.no_grad():
            last = agent(agent.scaled(torch.as_tensor(seen, dtype=torch.float32)))[1].numpy()
        table = {name: np.array(values) for name, values in rows.items()}
        gain = advantages(table["reward"], np.vstack([table["value"], last]), table["ended"])
        table |= {"advantage": gain, "return": gain + table["value"]}
        kept = ~table["resetting"]
        names = ("seen", "action", "log_prob", "advantage", "return")
        update(agent, optimiser, {n: torch.as_tensor(table[n][kept], dtype=torch.float32) for n in names})
        rate = f", solved {np.mean(solved):.2f} of {len(solved)} episodes" if solved else ""
        steps = done + ROLLOUT * WORLDS
        print(f"{steps} steps, {steps / (time.perf_counter() - began):.0f} a second: reward a step ", end="")
        print(f"{table['reward'][kept].mean():.3f}{rate}", flush=True)
    worlds.close()


if __name__ == "__main__":
    main()
