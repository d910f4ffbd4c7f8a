"""Kinds that are found, not listed: each module of a package names its own in a mapping `KINDS`."""

import importlib
import pkgutil
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any


def found_kinds(package: str, path: Iterable[str]) -> Mapping[str, Any]:
    """Collect the `KINDS` of every module of a package, sorted by name; for use in its ``__init__``.

    Parameters
    ----------
    package, path: the package's ``__name__`` and ``__path__``.

    Raises
    ------
    ValueError
        If two modules define a kind of the same name.
    """
    kinds: dict[str, Any] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(path)):
        for kind, value in importlib.import_module(f"{package}.{module}").KINDS.items():
            if kind in kinds:
                raise ValueError(f"{package}.{module}: the kind {kind!r} is defined in another file already")
            kinds[kind] = value
    return MappingProxyType(dict(sorted(kinds.items())))
