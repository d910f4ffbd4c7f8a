"""The points of a design sweep: parameters, their values, and the finger of each combination."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any

from fea.finger_design import ROLES, FingerDesign, material_named, with_fields
from fea.geometry import FingerGeometry


@dataclass(frozen=True, kw_only=True)
class Variable:
    """A dimension or a material, and the values that it takes (numbers in SI, or names of materials)."""

    name: str
    values: tuple[float, ...] | tuple[int, ...] | tuple[str, ...]


def variable(text: str) -> Variable:
    """Parse ``NAME=VALUE,VALUE``.

    Raises
    ------
    ValueError
        If there is no such parameter, or a value is not of its kind.
    """
    name, _, listed = text.partition("=")
    kinds: dict[str, Any] = {f.name: f.type for f in fields(FingerGeometry) if f.type in (float, int)}
    kinds |= dict.fromkeys(ROLES, str)
    if name not in kinds:
        raise ValueError(f"--vary {name}: no such parameter; allowed: {', '.join(kinds)}")
    try:
        values = tuple(kinds[name](item.strip()) for item in listed.split(","))
    except ValueError:
        raise ValueError(f"--vary {text}: must read NAME=VALUE,VALUE with {kinds[name].__name__} values") from None
    if len(set(values)) < len(values):
        raise ValueError(f"--vary {text}: a value is there twice")
    return Variable(name=name, values=values)


def designs(
    base: FingerDesign, variables: Sequence[Variable]
) -> list[tuple[dict[str, Any], FingerDesign | ValueError]]:
    """Return every combination of the variables' values, with its finger or why there cannot be one.

    Raises
    ------
    ValueError, FileNotFoundError
        If a value is allowed in none of its combinations.
    """
    made = []
    for combination in product(*(v.values for v in variables)):
        values = {v.name: value for v, value in zip(variables, combination, strict=True)}
        made.append((values, _design(base, values)))
    for v in variables:
        for value in v.values:
            own = [design for values, design in made if values[v.name] == value]
            if all(isinstance(design, ValueError) for design in own):
                raise ValueError(f"--vary {v.name}={value}: {own[0]}")
    return made


def _design(base: FingerDesign, values: dict[str, Any]) -> FingerDesign | ValueError:
    materials = {name: material_named(value) for name, value in values.items() if name in ROLES}
    dimensions = {name: value for name, value in values.items() if name not in ROLES}
    try:
        return FingerDesign(
            geometry=with_fields(base.geometry, dimensions), materials=replace(base.materials, **materials)
        )
    except ValueError as error:
        return error
