"""Hard cases of gas and scene: each named, with what makes it hard, and run at any time step.

A new case is one file in `softhand_sim/stability/cases` with a mapping `KINDS` from names to `HardCase`. Those of the
solid are in `fea/stability`; `scripts/hard_cases.py` runs both.
"""

from collections.abc import Mapping

from softhand_sim.stability.case import HardCase


def hard_cases() -> Mapping[str, HardCase]:
    """Return all cases by name."""
    from softhand_sim.stability.cases import CASES  # noqa: PLC0415 - the cases import much, most users need none

    return CASES
