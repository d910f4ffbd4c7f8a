"""Hard cases of the solid: each named, with what makes it hard, its criteria and its run.

A new case is one file in `fea/stability/cases` with a mapping `KINDS` from names to `SolidCase`. Those of gas and scene
are in `softhand_sim/stability`; `scripts/hard_cases.py` runs both.
"""
