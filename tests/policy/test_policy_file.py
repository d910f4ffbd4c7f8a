"""Policies as files: back as they were, bytes that repeat, and every kind of bad file refused by name."""

import json
import pickle
import zipfile
from dataclasses import asdict

import numpy as np
import pytest

from softhand_sim.policy.network import Network
from softhand_sim.policy.policy_file import FORMAT, Policy, PolicyFileError, dump_policy, load_policy
from softhand_sim.policy.reach import ACTIONS, ReachSpec

SPEC = ReachSpec(decisions=4)


def policy_of(rng, spec=SPEC, hidden=5):
    shapes = [(hidden, spec.features), (ACTIONS, hidden)]
    weights = tuple(rng.normal(size=shape) for shape in shapes)
    biases = tuple(rng.normal(size=shape[0]) for shape in shapes)
    return Policy(network=Network(weights=weights, biases=biases), spec=spec, about="drawn")


def entries_of(policy):
    arrays = {f"weight_{k}": w for k, w in enumerate(policy.network.weights)}
    arrays |= {f"bias_{k}": b for k, b in enumerate(policy.network.biases)}
    texts = {"format": FORMAT, "spec": json.dumps(asdict(policy.spec)), "about": policy.about}
    return arrays | {name: np.array(text) for name, text in texts.items()}


def test_a_policy_comes_back_as_it_was(tmp_path):
    rng = np.random.default_rng(0)
    policy, path = policy_of(rng), tmp_path / "p.npz"
    path.write_bytes(dump_policy(policy))
    back = load_policy(path)
    assert dump_policy(back) == path.read_bytes()
    assert (back.spec, back.about) == (policy.spec, "drawn")
    seen = rng.normal(size=SPEC.features)
    np.testing.assert_array_equal(back.act(seen), policy.act(seen))
    # two layers by hand, and clipping
    (first, second), (one, two) = policy.network.weights, policy.network.biases
    np.testing.assert_allclose(back.network(seen), second @ np.tanh(first @ seen + one) + two, atol=1e-14)
    assert np.abs(back.act(100.0 * seen)).max() <= 1.0


CHANGES = {
    "format": ({"format": np.array("other")}, "format"),
    "no spec": ({"spec": None}, "spec"),
    "spec is no JSON": ({"spec": np.array("{")}, "spec"),
    "spec lacks keys": ({"spec": np.array('{"decisions": 4}')}, "spec"),
    "decisions out of range": ({"spec": np.array(json.dumps(asdict(SPEC) | {"decisions": 0}))}, "decisions"),
    "decisions no number": ({"spec": np.array(json.dumps(asdict(SPEC) | {"decisions": "4"}))}, "decisions"),
    "other decisions": ({"spec": np.array(json.dumps(asdict(SPEC) | {"decisions": 5}))}, "inputs"),
    "NaN": ({"bias_1": np.full(ACTIONS, np.nan)}, "bias_1"),
    "short bias": ({"bias_0": np.zeros(4)}, "bias_0"),
    "whole numbers": ({"bias_0": np.zeros(5, dtype=int)}, "bias_0"),
    "one action less": ({"weight_1": np.zeros((8, 5)), "bias_1": np.zeros(8)}, "outputs"),
    "no last bias": ({"bias_1": None}, "weight_1"),
    "unknown entry": ({"extra": np.zeros(1), "more": np.zeros(1)}, "weight_2"),
}


@pytest.mark.parametrize(("change", "named"), CHANGES.values(), ids=CHANGES)
def test_a_bad_entry_is_named(tmp_path, change, named):
    entries = entries_of(policy_of(np.random.default_rng(0))) | change
    path = tmp_path / "p.npz"
    np.savez(path, **{name: value for name, value in entries.items() if value is not None})
    with pytest.raises(PolicyFileError, match=named) as told:
        load_policy(path)
    assert str(path) in str(told.value)


class Trap:
    def __reduce__(self):
        return (pytest.fail, ("code of the file was executed",))


def test_files_of_other_kinds_are_refused_and_no_code_runs(tmp_path):
    path = tmp_path / "p.npz"
    with pytest.raises(FileNotFoundError):
        load_policy(path)
    for data in (b"", b"PK\x03\x04 torn", pickle.dumps(Trap()), dump_policy(policy_of(np.random.default_rng(0)))[:-30]):
        path.write_bytes(data)
        with pytest.raises(PolicyFileError, match="npz"):
            load_policy(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("format.npy", pickle.dumps(Trap()))
    with pytest.raises(PolicyFileError):
        load_policy(path)
    trapped = np.empty(1, dtype=object)
    trapped[0] = Trap()
    np.savez(path, **entries_of(policy_of(np.random.default_rng(0))) | {"bias_0": trapped})
    with pytest.raises(PolicyFileError, match="pickle"):
        load_policy(path)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("weight_0.npy", bytes(65 << 20))
    with pytest.raises(PolicyFileError, match="unpacked"):
        load_policy(path)
