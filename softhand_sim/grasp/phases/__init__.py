"""Phases of a protocol after the hand has closed: one a file, found by their `KINDS`.

A new phase is one file in this folder with a frozen dataclass that fulfils `softhand_sim.grasp.stage.Phase` and a
mapping `KINDS` from the word for it (`do` in a protocol file) to the class. Its fields, numbers or true and false, are
the keys.
"""

from collections.abc import Callable, Mapping

from softhand_sim.grasp.stage import Phase
from softhand_sim.kinds import found_kinds

PHASES: Mapping[str, Callable[..., Phase]] = found_kinds(__name__, __path__)
"""Phases by the word for them."""
