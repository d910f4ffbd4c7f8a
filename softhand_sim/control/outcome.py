"""What a stretch of control came to: held, still moving, or saturated."""

from collections.abc import Sequence
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from softhand_sim.control.protocol import ValveCommand


class ControlOutcome(StrEnum):
    """How an element's pressure stood at the end of a stretch.

    HELD: within the tolerance of the set pressure all the time.
    MOVING: outside it, on the way there or hunting round it.
    SATURATED: outside it with the valve towards it open all the time, and no nearer at the end than at the start: the
        valve gives all it can and that is not enough (a leak larger than the inlet, a supply too low).
    """

    HELD = "HELD"
    MOVING = "MOVING"
    SATURATED = "SATURATED"


def control_outcome(
    readings_pa_gauge: npt.NDArray[np.float64],
    set_pa_gauge: float,
    commands: Sequence[ValveCommand],
    tolerance_pa: float,
) -> ControlOutcome:
    """Judge one element over a stretch of constant set pressure, from what the controller itself knows.

    Parameters
    ----------
    readings_pa_gauge
        Sensor readings at the ticks [Pa gauge], (n,), n >= 10, over a time long beside a fill's (0.5 s or more).
    set_pa_gauge
        Set pressure [Pa gauge].
    commands
        Valve positions commanded at the ticks, (n,).
    tolerance_pa
        Half width of what counts as held, and least approach that counts as one [Pa]; above the sensor's noise.

    Raises
    ------
    ValueError
        If the readings are fewer than ten, or their number isn't that of the commands.
    """
    if len(readings_pa_gauge) < 10 or len(commands) != len(readings_pa_gauge):
        raise ValueError(f"readings: {len(readings_pa_gauge)}, commands: {len(commands)}; must be the same, 10 or more")
    error = set_pa_gauge - np.asarray(readings_pa_gauge, dtype=np.float64)
    if float(np.abs(error).max()) <= tolerance_pa:
        return ControlOutcome.HELD
    # means of the first and last fifth: a single reading carries the sensor's noise
    fifth = len(error) // 5
    first, last = float(error[:fifth].mean()), float(error[-fifth:].mean())
    towards = [command.inlet_open if last > 0.0 else command.outlet_open for command in commands]
    if all(towards) and abs(last) > tolerance_pa and abs(first) - abs(last) < tolerance_pa:
        return ControlOutcome.SATURATED
    return ControlOutcome.MOVING
