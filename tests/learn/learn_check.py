"""Torch's actor and the NumPy one agree, training writes what the benchmark runs, demonstrations are read back."""

import json

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3 import PPO

from scripts import export_demonstrations, train
from scripts._learning import DEFAULT
from scripts._ppo import AsymmetricPolicy, actor
from softhand_sim.policy.policy_file import Policy, dump_policy, load_policy
from softhand_sim.policy.reach import ReachSpec


class Anything(gymnasium.Env):
    """Spaces of the decisions, without a simulation."""

    def __init__(self):
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (ReachSpec().features + 12,))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (9,))

    def reset(self, *, seed=None, options=None):  # noqa: ARG002 - as Gymnasium has it
        return np.zeros(self.observation_space.shape, dtype=np.float32), {}

    def step(self, action):  # noqa: ARG002
        return self.reset()[0], 0.0, True, False, {}


def test_torch_and_numpy_agree(tmp_path):
    torch.manual_seed(0)
    model = PPO(AsymmetricPolicy, Anything(), policy_kwargs={"net_arch": {"pi": [16, 8], "vf": [8]}}, device="cpu")
    with torch.no_grad():
        for parameter in model.policy.parameters():
            parameter.add_(0.3 * torch.randn_like(parameter))
    spec, path = ReachSpec(), tmp_path / "p.npz"
    path.write_bytes(dump_policy(Policy(network=actor(model.policy, spec.features), spec=spec)))
    policy, rng = load_policy(path), np.random.default_rng(0)
    for _ in range(50):
        seen, hidden = rng.normal(size=spec.features), rng.normal(size=12)
        wanted = model.predict(np.concatenate([seen, hidden]).astype(np.float32), deterministic=True)[0]
        # torch computes in single precision
        np.testing.assert_allclose(policy.act(seen), wanted, atol=2e-6)


def test_the_critic_sees_what_the_actor_does_not():
    model = PPO(AsymmetricPolicy, Anything(), device="cpu")
    seen = torch.randn(1, ReachSpec().features + 12)
    other = seen.clone()
    other[:, -12:] += 1.0
    mean, changed = (model.policy.get_distribution(x).distribution.mean for x in (seen, other))
    assert torch.equal(mean, changed)
    assert not torch.allclose(model.policy.predict_values(seen), model.policy.predict_values(other))


def test_training_repeats_and_writes_policy_and_curve(tmp_path):
    text = DEFAULT.read_text()
    lines = [line for line in text.splitlines() if not line.startswith(("objects =", "episodes_an_update"))]
    lines.insert(0, 'objects = ["apple"]')
    config = tmp_path / "config.toml"
    config.write_text("\n".join(lines).replace("[ppo]", "[ppo]\nepisodes_an_update = 2"))
    written = []
    for name in ("a", "b"):
        out, curve = tmp_path / f"{name}.npz", tmp_path / f"{name}.json"
        call = ["--config", str(config), "--episodes", "4", "--workers", "1", "--out", str(out), "--json", str(curve)]
        assert train.main(call) == 0
        assert len(json.loads(curve.read_text())["curve"]) == 2
        assert out.with_suffix(".png").stat().st_size > 10_000
        written.append(out.read_bytes())
    assert written[0] == written[1]
    assert load_policy(tmp_path / "a.npz").spec == ReachSpec()


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_demonstrations_are_read_back(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    call = ["--objects", "lemon", "--episodes", "2", "--out", str(tmp_path)]
    assert export_demonstrations.main(call) == 0
    minari = pytest.importorskip("minari")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    data = minari.load_dataset("softhand/grasp-scripted-v0")
    assert (data.total_episodes, data.total_steps) == (2, 500)
    episode = next(data.iterate_episodes())
    assert episode.observations.shape == (251, 15)
    assert episode.rewards[-1] > 4.0
    # the actions do the same again
    env = data.recover_environment()
    env.reset(seed=0)
    rewards = [env.step(action)[1] for action in episode.actions]
    np.testing.assert_allclose(rewards, episode.rewards, atol=1e-6)
    assert export_demonstrations.main(call) == 2
    assert "exists already" in capsys.readouterr().err
