"""Checks of load lists, made before any mesh is built."""

from collections.abc import Sequence

import numpy as np

VACUUM_PA_GAUGE = -100e3
"""No gauge pressure lies below this: rounded standard atmosphere, as the command lines state it."""


def check_pressures(pressures_pa_gauge: Sequence[float]) -> None:
    """Refuse pressures that cannot be swept.

    Raises
    ------
    ValueError
        If a pressure is not finite or below -100 kPa, or if they are not positive and increasing.
    """
    for pressure in pressures_pa_gauge:
        if not np.isfinite(pressure) or pressure < VACUUM_PA_GAUGE:
            raise ValueError(f"pressures_pa_gauge: {pressure:g} Pa must be finite and at least {VACUUM_PA_GAUGE:g} Pa")
    _check_increasing("pressures_pa_gauge", pressures_pa_gauge)


def check_loads(loads_n: Sequence[float]) -> None:
    """Refuse loads that are not finite, positive and increasing.

    Raises
    ------
    ValueError
        Naming the loads.
    """
    _check_increasing("loads_n", loads_n)


def _check_increasing(name: str, values: Sequence[float]) -> None:
    if not values or not np.isfinite(values).all() or np.any(np.diff([0.0, *values]) <= 0.0):
        raise ValueError(f"{name} = {list(values)} must be positive and increasing")
