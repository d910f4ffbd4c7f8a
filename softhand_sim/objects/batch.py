"""Loading many objects: one that cannot be used is set aside with its reason, the others go on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from softhand_sim.objects.model import ObjectModel


@dataclass(frozen=True, kw_only=True)
class Batch:
    """What could be loaded, and why the rest could not.

    Attributes
    ----------
    models : tuple of ObjectModel
    failures : mapping of str to str
        Reason, in one line, by name.
    """

    models: tuple[ObjectModel, ...]
    failures: Mapping[str, str]


def load_all(loaders: Mapping[str, Callable[[], ObjectModel]]) -> Batch:
    """Call each loader, in order.

    Raises
    ------
    ValueError
        If none of them gives an object; the message has every reason.
    """
    models, failures = [], {}
    for name, load in loaders.items():
        try:
            models.append(load())
        except (ValueError, OSError, MemoryError) as error:
            failures[name] = " ".join(str(error).split()) or type(error).__name__
    if not models:
        raise ValueError("; ".join(failures.values()) or "no objects asked for")
    return Batch(models=tuple(models), failures=failures)
