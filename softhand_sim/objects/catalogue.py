"""The shipped objects: a TOML table each, turned into models by the shape generators."""

import inspect
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assets import asset_path
from softhand_sim.objects.model import ObjectModel, build_object, check_friction, check_mass
from softhand_sim.objects.shapes import GENERATORS


@dataclass(frozen=True, kw_only=True)
class CatalogueEntry:
    """One object of the catalogue.

    Attributes
    ----------
    name, source : str
        `source` says where each value comes from.
    ycb : str
        Identifier in the YCB set, such as ``013_apple``; empty if it has none.
    mass_kg, friction : float
    kind : str
        Shape kind, a key of `shapes.GENERATORS`.
    parameters : mapping of str to float
        Arguments of that generator.
    rgba : tuple of float
        Colour in pictures.

    Raises
    ------
    ValueError
        If a value is out of range, or the parameters are not those of the shape kind.
    """

    name: str
    source: str
    mass_kg: float
    friction: float
    kind: str
    parameters: Mapping[str, float]
    rgba: tuple[float, float, float, float]
    ycb: str = ""

    def __post_init__(self) -> None:
        check_mass(self.mass_kg)
        check_friction(self.friction)
        if not self.source.strip():
            raise ValueError("source is empty: say where the values come from")
        if len(self.rgba) != 4 or not all(0.0 <= c <= 1.0 for c in self.rgba):
            raise ValueError(f"rgba is {self.rgba}, needs four numbers from 0 to 1")
        if self.kind not in GENERATORS:
            raise ValueError(f"shape.kind is {self.kind!r}, allowed {sorted(GENERATORS)}")
        wanted = set(inspect.signature(GENERATORS[self.kind]).parameters)
        if set(self.parameters) != wanted:
            missing, unknown = sorted(wanted - set(self.parameters)), sorted(set(self.parameters) - wanted)
            raise ValueError(f"shape of kind {self.kind!r}: missing {missing}, unknown {unknown}")


def _number(table: Mapping[str, Any], key: str) -> float:
    value = table.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{key} is {value!r}, needs a number")
    return float(value)


def _entry(name: str, table: Mapping[str, Any]) -> CatalogueEntry:
    needed = {"mass_kg", "friction", "source", "rgba", "shape"}
    if set(table) - {"ycb"} != needed or not isinstance(table["shape"], dict):
        raise ValueError(f"has the keys {sorted(table)}, needs {sorted(needed)}, may have ycb, with a table `shape`")
    shape = dict(table["shape"])
    kind = str(shape.pop("kind", ""))
    rgba = tuple(float(c) for c in table["rgba"])
    if len(rgba) != 4:
        raise ValueError(f"rgba is {rgba}, needs four numbers from 0 to 1")
    return CatalogueEntry(
        name=name,
        source=str(table["source"]),
        ycb=str(table.get("ycb", "")),
        mass_kg=_number(table, "mass_kg"),
        friction=_number(table, "friction"),
        kind=kind,
        parameters={key: _number(shape, key) for key in shape},
        rgba=rgba,
    )


def load_catalogue(path: Path | None = None) -> dict[str, CatalogueEntry]:
    """Read the catalogue, by default the shipped one, in the order of the file.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is no TOML or a value is wrong; the message names file, object and key.
    """
    path = asset_path("objects", "catalogue.toml") if path is None else path
    if not path.is_file():
        raise FileNotFoundError(f"no object catalogue at {path}")
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not a TOML file: {error}") from error
    entries = {}
    for name, table in tables.items():
        try:
            if not isinstance(table, dict):
                raise ValueError("is no table")
            entries[name] = _entry(name, table)
        except (ValueError, TypeError) as error:
            raise ValueError(f"{path}: object {name!r}: {error}") from error
    return entries


def make_object(name: str) -> ObjectModel:
    """Return a catalogue object as a model.

    Raises
    ------
    ValueError
        If the catalogue has no such object, or its shape parameters do not fit together.
    """
    entries = load_catalogue()
    if name not in entries:
        raise ValueError(f"no object {name!r} in the catalogue; it has {', '.join(entries)}")
    entry = entries[name]
    return build_object(
        GENERATORS[entry.kind](**entry.parameters),
        name=name,
        kind=entry.kind,
        mass_kg=entry.mass_kg,
        friction=entry.friction,
        rgba=entry.rgba,
    )
