"""Phases of a protocol after the hand has closed: one a file, found by their `KINDS`.

A new phase is one file in this folder with a frozen dataclass that fulfils `softhand_sim.grasp.stage.Phase` and a
mapping `KINDS` from the word for it (`do` in a protocol file) to the class. Its fields, numbers or true and false, are
the keys.
"""

import importlib
import pkgutil
from collections.abc import Callable, Mapping
from types import MappingProxyType

from softhand_sim.grasp.stage import Phase


def _found() -> Mapping[str, Callable[..., Phase]]:
    """Collect the `KINDS` of every module in this folder.

    Raises
    ------
    ValueError
        If two files define a phase of the same name.
    """
    kinds: dict[str, Callable[..., Phase]] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(__path__)):
        for kind, phase in importlib.import_module(f"{__name__}.{module}").KINDS.items():
            if kind in kinds:
                raise ValueError(f"{__name__}.{module}: the phase {kind!r} is defined in another file already")
            kinds[kind] = phase
    return MappingProxyType(dict(sorted(kinds.items())))


PHASES: Mapping[str, Callable[..., Phase]] = _found()
"""Phases by the word for them."""
