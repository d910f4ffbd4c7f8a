"""Finger-finger interference: fingers can touch one another."""

from dataclasses import dataclass
from typing import Any

from softhand_sim.effects.kind import ActsOn
from softhand_sim.elements import FINGERS

ACTS_ON = ActsOn.MODEL


@dataclass(frozen=True, kw_only=True)
class FingerInterference:
    """Contact pairs between different fingers; it has no parameters of its own (see `ContactSettings`)."""


def without_interference(root: Any) -> None:
    """Take the pairs between different fingers out of a hand's MJCF, before it is compiled.

    Each finger's shapes get a bit of their own: they still meet everything else, their own finger included.
    """
    for k, finger in enumerate(FINGERS):
        own = 1 << (k + 1)
        for geom in root.find_all("geom"):
            if geom.name is not None and geom.name.startswith(f"{finger}_"):
                geom.contype = own
                geom.conaffinity = 1 | own
