"""A learned policy as a file: weights and plain values in NumPy's ``.npz``; nothing in it is ever executed."""

import json
import zipfile
from dataclasses import asdict, dataclass, fields
from io import BytesIO
from pathlib import Path

import numpy as np
import numpy.typing as npt

from softhand_sim.policy.network import Network
from softhand_sim.policy.reach import ACTIONS, ReachSpec

Vector = npt.NDArray[np.float64]

FORMAT = "softhand-policy-1"
LARGEST_BYTES = 64 << 20
"""Choice: a thousand times what a shipped policy takes; a file that unpacks to more is refused unread."""


class PolicyFileError(ValueError):
    """A policy file that cannot be used; the message names file, entry and what is wrong."""


@dataclass(frozen=True, kw_only=True)
class Policy:
    """A network, the layout of its decisions, and where it comes from.

    Attributes
    ----------
    network
        From `ReachSpec.features` values to `ACTIONS`.
    spec
        Of the decisions.
    about
        Where it comes from: objects, seed, episodes, library versions; one text.

    Raises
    ------
    ValueError
        If the network does not fit the layout.
    """

    network: Network
    spec: ReachSpec
    about: str = ""

    def __post_init__(self) -> None:
        for name, found, wanted in (
            ("inputs", self.network.inputs, self.spec.features),
            ("outputs", self.network.outputs, ACTIONS),
        ):
            if found != wanted:
                raise ValueError(f"network: {found} {name}, must be {wanted}")

    def act(self, features: Vector) -> Vector:
        """Return the action (9,) in [-1, 1] for what is seen, (features,)."""
        return np.clip(self.network(features), -1.0, 1.0)


def dump_policy(policy: Policy) -> bytes:
    """Return a policy as the bytes of its file; the same policy gives the same bytes."""
    entries: dict[str, npt.NDArray[np.generic]] = {
        "format": np.array(FORMAT),
        "spec": np.array(json.dumps(asdict(policy.spec))),
        "about": np.array(policy.about),
    }
    for k, (weight, bias) in enumerate(zip(policy.network.weights, policy.network.biases, strict=True)):
        entries[f"weight_{k}"], entries[f"bias_{k}"] = weight, bias
    out = BytesIO()
    np.savez(out, allow_pickle=False, **entries)
    return out.getvalue()


def load_policy(path: Path) -> Policy:
    """Read a policy.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    PolicyFileError
        If it is no policy, or a value in it is missing, strange or out of range.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such policy file")
    try:
        return _policy(_entries(path))
    except PolicyFileError:
        raise
    except (ValueError, TypeError, KeyError) as error:
        text = f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error)
        raise PolicyFileError(f"{path}: {text}") from None


def _entries(path: Path) -> dict[str, npt.NDArray[np.generic]]:
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(member.file_size for member in archive.infolist())
        if size > LARGEST_BYTES:
            raise PolicyFileError(f"{path}: {size} bytes unpacked, must be {LARGEST_BYTES} or less")
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except (zipfile.BadZipFile, EOFError, OSError) as error:
        raise PolicyFileError(f"{path}: not an npz file ({error})") from None


def _policy(entries: dict[str, npt.NDArray[np.generic]]) -> Policy:
    found = str(entries.pop("format"))
    if found != FORMAT:
        raise ValueError(f"format: {found!r} must be {FORMAT!r}")
    spec, about = _spec(str(entries.pop("spec"))), str(entries.pop("about"))
    layers = len(entries) // 2
    weights = tuple(_numbers(entries, f"weight_{k}") for k in range(layers))
    biases = tuple(_numbers(entries, f"bias_{k}") for k in range(layers))
    if entries:
        raise ValueError(f"{sorted(entries)[0]}: unknown entry")
    return Policy(network=Network(weights=weights, biases=biases), spec=spec, about=about)


def _numbers(entries: dict[str, npt.NDArray[np.generic]], name: str) -> Vector:
    values = entries.pop(name)
    if values.dtype.kind != "f":
        raise ValueError(f"{name}: type {values.dtype} must be floating point")
    return values.astype(np.float64)


def _spec(text: str) -> ReachSpec:
    try:
        values = json.loads(text)
    except json.JSONDecodeError as error:
        raise ValueError(f"spec: not JSON ({error})") from None
    names = {f.name: f.type for f in fields(ReachSpec)}
    if not isinstance(values, dict) or set(values) != set(names):
        raise ValueError(f"spec: {text[:200]!r} must have exactly the keys {sorted(names)}")
    for name, kind in names.items():
        allowed = (int,) if kind is int else (int, float)
        if isinstance(values[name], bool) or not isinstance(values[name], allowed):
            raise ValueError(f"spec: {name} = {values[name]!r} must be a number")
    return ReachSpec(**values)
