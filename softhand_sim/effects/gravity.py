"""Gravity on the fingers."""

from dataclasses import dataclass
from typing import Any

from softhand_sim.effects.kind import ActsOn
from softhand_sim.elements import FINGERS

ACTS_ON = ActsOn.MODEL


@dataclass(frozen=True, kw_only=True)
class FingerGravity:
    """The fingers' own weight bends them; it has no parameters of its own (see `EngineSettings`)."""


def without_gravity(root: Any) -> None:
    """Take the weight off the fingers of a hand's MJCF, before it is compiled; palm and object keep theirs."""
    for finger in FINGERS:
        for body in root.find_all("body"):
            if body.name is not None and body.name.startswith(f"{finger}_"):
                body.gravcomp = 1.0
