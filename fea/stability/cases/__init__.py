"""The cases, one file a theme, found by their `KINDS`."""

import importlib
import pkgutil
from collections.abc import Mapping
from types import MappingProxyType

from fea.stability.case import SolidCase


def _found() -> Mapping[str, SolidCase]:
    cases: dict[str, SolidCase] = {}
    for info in sorted(pkgutil.iter_modules(__path__), key=lambda item: item.name):
        own: Mapping[str, SolidCase] = importlib.import_module(f"{__name__}.{info.name}").KINDS
        if twice := cases.keys() & own.keys():
            raise ValueError(f"{info.name}: the cases {sorted(twice)} are defined in another file already")
        cases |= own
    return MappingProxyType(cases)


SOLID_CASES: Mapping[str, SolidCase] = _found()
"""Cases by name."""
