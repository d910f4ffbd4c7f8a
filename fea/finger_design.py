"""A finger as its designer writes it: a TOML file with dimensions and materials, checked before anything is meshed."""

import difflib
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from assets import asset_path
from fea.calibration import Materials
from fea.geometry import FingerGeometry
from fea.laws import IsochoricOgden
from fea.materials import Material, load_material

ROLES = ("silicone", "tpu", "pet")
"""Materials of a finger: actuator's wall, exoskeleton, rings."""
DEFAULT_MATERIALS = {"silicone": "ecoflex-00-50/set3", "tpu": "ninjaflex/set3", "pet": "pet/paper"}
_TABLES = ("geometry", "materials")


@dataclass(frozen=True, kw_only=True)
class FingerDesign:
    """What a finger is made of: dimensions and materials.

    Raises
    ------
    ValueError
        If silicone or TPU has no law for rubber.
    """

    geometry: FingerGeometry
    materials: Materials

    def __post_init__(self) -> None:
        for role in ("silicone", "tpu"):
            material: Material = getattr(self.materials, role)
            # St. Venant-Kirchhoff softens under compression until it has no stiffness: not for parts that strain
            if not isinstance(material.law, IsochoricOgden):
                raise ValueError(f"materials.{role}: {material.name} must have a law for rubber: ogden, mooney_rivlin")


def load_design(path: Path) -> FingerDesign:
    """Read a finger's TOML file.

    Table ``geometry`` holds any fields of :class:`fea.geometry.FingerGeometry`, in the units of their names; table
    ``materials`` any of ``silicone``, ``tpu`` and ``pet`` (:func:`material_named`). What is left out has its default.

    Raises
    ------
    FileNotFoundError
        If there is no such file, or no such sheet.
    ValueError
        If a field is unknown, of the wrong type or out of range; the message names file, field, value and range.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no finger file {path}")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not valid TOML: {error}") from None
    try:
        _check_names("", data, _TABLES)
        tables = {name: data.get(name, {}) for name in _TABLES}
        for name, table in tables.items():
            if not isinstance(table, dict):
                raise ValueError(f"{name} = {table!r} must be a table")
        return FingerDesign(
            geometry=with_fields(FingerGeometry(), tables["geometry"]),
            materials=named_materials(tables["materials"], path.parent),
        )
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def with_fields(geometry: FingerGeometry, values: Mapping[str, Any]) -> FingerGeometry:
    """Return a geometry with some of its fields replaced.

    Raises
    ------
    ValueError
        If there is no such field, a value is no number of its kind, or the geometry refuses it.
    """
    kinds = {f.name: f.type for f in fields(FingerGeometry)}
    _check_names("geometry.", values, tuple(kinds))
    return replace(geometry, **{name: _value(name, kinds[name], value) for name, value in values.items()})


def named_materials(names: Mapping[str, Any], folder: Path | None = None) -> Materials:
    """Return the materials of a finger by name; those left out have their default.

    Raises
    ------
    FileNotFoundError, ValueError
        If a role or a sheet is unknown or a sheet is wrong; the message names the role.
    """
    _check_names("materials.", names, ROLES)
    found = {}
    for role, default in DEFAULT_MATERIALS.items():
        name = names.get(role, default)
        try:
            found[role] = material_named(name, folder)
        except FileNotFoundError as error:
            raise FileNotFoundError(f"materials.{role} = {name!r}: {error}") from None
        except ValueError as error:
            raise ValueError(f"materials.{role} = {name!r}: {error}") from None
    return Materials(**found)


def material_named(name: Any, folder: Path | None = None) -> Material:
    """Return a material by ``sheet`` or ``sheet/set``.

    A sheet is a shipped one (``ecoflex-00-50/set3``) or the path of a TOML file like those in ``assets/materials``,
    relative to ``folder`` (``silicones/mine.toml`` or ``silicones/mine.toml/soft``). Without a set: its default set.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such sheet or set, or the sheet is wrong.
    """
    if not isinstance(name, str) or not name:
        raise ValueError("must be a text like 'ecoflex-00-50/set3' or 'my_sheet.toml'")
    sheet, parameter_set = name, None
    if not name.endswith(".toml"):
        head, slash, tail = name.rpartition("/")
        sheet, parameter_set = (head, tail) if slash else (name, None)
    if sheet.endswith(".toml"):
        return load_material((folder or Path()) / sheet, parameter_set)
    shipped = {file.stem.replace("_", "-"): file for file in sorted(asset_path("materials").glob("*.toml"))}
    if sheet.replace("_", "-") not in shipped:
        raise ValueError(f"no such sheet; shipped: {', '.join(shipped)}; a file's path ends in .toml")
    return load_material(shipped[sheet.replace("_", "-")], parameter_set)


def _check_names(place: str, given: Mapping[str, Any], known: Sequence[str]) -> None:
    for name in given:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f" (did you mean {near[0]}?)" if near else ""
            raise ValueError(f"{place}{name}: unknown field{hint}; allowed: {', '.join(known)}")


def _value(name: str, kind: Any, value: Any) -> Any:
    if kind is int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError(f"geometry.{name} = {value!r} must be a whole number")
        return value
    if kind is float:
        return _number(f"geometry.{name}", value)
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError(f"geometry.{name} = {value!r} must be a list of three numbers")
    return tuple(_number(f"geometry.{name}[{k}]", v) for k, v in enumerate(value))


def _number(place: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{place} = {value!r} must be a finite number, in the unit of its name")
    return float(value)
