"""The cases, one file a theme, found by their `KINDS`."""

from collections.abc import Mapping

from softhand_sim.kinds import found_kinds
from softhand_sim.stability.case import HardCase

CASES: Mapping[str, HardCase] = found_kinds(__name__, __path__)
"""Cases by name."""
