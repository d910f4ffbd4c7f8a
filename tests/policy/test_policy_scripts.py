"""Policies in the scripts: the benchmark runs one, refuses a bad one, and a store knows which one it was."""

import json

import numpy as np
import pytest

from scripts import grasp_benchmark, train
from scripts._learning import DEFAULT, load_config
from softhand_sim.policy.network import Network
from softhand_sim.policy.policy_file import Policy, dump_policy
from softhand_sim.policy.reach import ACTIONS, ReachSpec


def write(path, forward):
    spec = ReachSpec(decisions=3, approach_decisions=1)
    bias = forward * np.eye(ACTIONS)[2]
    network = Network(weights=(np.zeros((ACTIONS, spec.features)),), biases=(bias,))
    path.write_bytes(dump_policy(Policy(network=network, spec=spec)))
    return path


def test_the_benchmark_runs_a_policy_and_its_store_knows_it(tmp_path, capsys):
    # backs off at once: nothing is held
    policy, out, store = write(tmp_path / "away.npz", -1.0), tmp_path / "out.json", tmp_path / "run.sqlite"
    call = ["--objects", "apple", "--trials", "1", "--no-pictures", "--store", str(store)]
    assert grasp_benchmark.main([*call, "--policy", str(policy), "--json", str(out)]) == 0
    data = json.loads(out.read_text())
    assert data["trials"][0]["outcome"] == "MISSED"
    assert len(data["settings"]["policy_sha256"]) == 64
    capsys.readouterr()
    assert grasp_benchmark.main(call) == 2
    assert "policy_sha256" in capsys.readouterr().err
    assert grasp_benchmark.main([*call, "--policy", str(write(tmp_path / "other.npz", 0.5))]) == 2
    assert "policy_sha256" in capsys.readouterr().err


def test_a_bad_policy_is_one_line(tmp_path, capsys):
    path = tmp_path / "bad.npz"
    path.write_bytes(b"nothing")
    assert grasp_benchmark.main(["--objects", "apple", "--policy", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert "bad.npz" in told
    assert told.count("\n") == 1


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("episodes = 0", "episodes"),
        ('objects = ["human_being"]', "human_being"),
        ("strange = 1", "strange"),
        ("position_m = 0.5", "position_m"),
        ("workers = 1.5", "workers"),
        ("yaw_rad =", "config.toml"),
    ],
)
def test_a_bad_configuration_is_named_before_anything_starts(tmp_path, capsys, line, named):
    key = line.split()[0]
    shipped = load_config(None)
    assert set(shipped.objects).isdisjoint(shipped.unseen)
    text = DEFAULT.read_text()
    lines = [old for old in text.splitlines() if not old.startswith((f"{key} ", f"[{key}]"))]
    path = tmp_path / "config.toml"
    path.write_text("\n".join([line, *lines]))
    assert train.main(["--config", str(path), "--out", str(tmp_path / "p.npz")]) == 2
    assert named in capsys.readouterr().err
    assert not (tmp_path / "p.npz").exists()
