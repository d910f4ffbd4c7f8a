"""Generators of the catalogue's shapes: one family a file, found by their `KINDS`.

A new family is one file in this folder with a mapping `KINDS` from the name of a kind (`shape.kind` in the catalogue)
to a function that returns a `ShapeGeometry`. The function's keyword arguments, all numbers, are the keys of the TOML
table.
Every mesh is closed, outward oriented, in metres, z up in its resting pose, and the same on every call.
"""

import importlib
import pkgutil
from collections.abc import Callable, Mapping
from types import MappingProxyType

from softhand_sim.objects.geometry import ShapeGeometry


def _found() -> Mapping[str, Callable[..., ShapeGeometry]]:
    """Collect the `KINDS` of every module in this folder.

    Raises
    ------
    ValueError
        If two files define a kind of the same name.
    """
    kinds: dict[str, Callable[..., ShapeGeometry]] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(__path__)):
        for kind, generator in importlib.import_module(f"{__name__}.{module}").KINDS.items():
            if kind in kinds:
                raise ValueError(f"{__name__}.{module}: the kind {kind!r} is defined in another file already")
            kinds[kind] = generator
    return MappingProxyType(dict(sorted(kinds.items())))


GENERATORS: Mapping[str, Callable[..., ShapeGeometry]] = _found()
"""Shape kinds of the catalogue."""
