"""Protocols from TOML files: the shipped ones by name, a user's by path."""

import dataclasses
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from assets import asset_path
from softhand_sim.grasp.phases import PHASES
from softhand_sim.grasp.protocol import GraspProtocol, Offsets
from softhand_sim.grasp.stage import Phase
from softhand_sim.grasp.verdict import Thresholds

DEFAULT = "paper"
_KEYS = {
    "source": str,
    "approach_m": float,
    "close_s": float,
    "settle_s": float,
    "mass_kg": float,
    "friction": float,
    "closing_pressure_pa_gauge": float,
    "offsets": dict,
    "thresholds": dict,
    "phase": list,
}
_OPTIONAL = {"mass_kg", "friction", "closing_pressure_pa_gauge", "offsets", "thresholds"}


def protocol_names() -> tuple[str, ...]:
    """Return the names of the shipped protocols."""
    return tuple(sorted(path.stem for path in asset_path("protocols").glob("*.toml")))


def load_protocol(name: str | Path = DEFAULT) -> GraspProtocol:
    """Return a shipped protocol by its name, or that of a TOML file by its path (with its ending).

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If there is no such name, or the file is not a protocol; the message names file, key and what is allowed.
    """
    path = Path(name)
    if path.suffix.lower() != ".toml":
        if str(name) not in protocol_names():
            raise ValueError(f"no protocol {str(name)!r}; there are {', '.join(protocol_names())}, or a TOML file")
        path = asset_path("protocols", f"{name}.toml")
    if not path.is_file():
        raise FileNotFoundError(f"no protocol file at {path}")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not a TOML file: {error}") from error
    try:
        return _protocol(path.stem, table)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from error


def _protocol(name: str, table: Mapping[str, Any]) -> GraspProtocol:
    unknown, missing = sorted(set(table) - set(_KEYS)), sorted(set(_KEYS) - _OPTIONAL - set(table))
    if unknown or missing:
        raise ValueError(f"unknown keys {unknown}, missing keys {missing}; a protocol has {sorted(_KEYS)}")
    for key, value in table.items():
        number = isinstance(value, int) and not isinstance(value, bool)
        if not isinstance(value, _KEYS[key]) and not (_KEYS[key] is float and number):
            raise ValueError(f"{key} is {value!r}, needs a {_KEYS[key].__name__}")
    values = {key: value for key, value in table.items() if key not in ("phase", "offsets", "thresholds")}
    offsets = dict(table.get("offsets", {}))
    if "stated_m" in offsets:
        offsets["stated_m"] = tuple(tuple(pair) for pair in offsets["stated_m"])
    return GraspProtocol(
        name=name,
        phases=tuple(_phase(i, entry) for i, entry in enumerate(table["phase"], start=1)),
        offsets=_filled(Offsets, "offsets", offsets),
        thresholds=_filled(Thresholds, "thresholds", table.get("thresholds", {})),
        **values,
    )


def _phase(number: int, entry: Any) -> Phase:
    if not isinstance(entry, dict):
        raise ValueError(f"phase {number} is {entry!r}, needs a table")
    values = {key: value for key, value in entry.items() if key != "do"}
    word = str(entry.get("do"))
    if word not in PHASES:
        raise ValueError(f"phase {number}: do is {word!r}, allowed {', '.join(PHASES)}")
    phase: Phase = _filled(PHASES[word], f"phase {number} ({word})", values)
    return phase


def _filled(kind: Any, where: str, values: Mapping[str, Any]) -> Any:
    """Return a dataclass made of a table's values; `needs_object` belongs to the kind of phase, not to the file."""
    allowed = [f.name for f in dataclasses.fields(kind) if f.name != "needs_object"]
    unknown = sorted(set(values) - set(allowed))
    if unknown:
        raise ValueError(f"{where}: unknown keys {unknown}, allowed {allowed}")
    try:
        return kind(**values)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{where}: {error}") from error
