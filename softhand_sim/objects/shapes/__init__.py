"""Generators of the catalogue's shapes: one family a file, found by their `KINDS`.

A new family is one file in this folder with a mapping `KINDS` from the name of a kind (`shape.kind` in the catalogue)
to a function that returns a `ShapeGeometry`. The function's keyword arguments, all numbers, are the keys of the TOML
table.
Every mesh is closed, outward oriented, in metres, z up in its resting pose, and the same on every call.
"""

from collections.abc import Callable, Mapping

from softhand_sim.kinds import found_kinds
from softhand_sim.objects.geometry import ShapeGeometry

GENERATORS: Mapping[str, Callable[..., ShapeGeometry]] = found_kinds(__name__, __path__)
"""Shape kinds of the catalogue."""
