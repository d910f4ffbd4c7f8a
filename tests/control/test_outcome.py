"""What control says of itself: held, moving, saturated."""

import numpy as np
import pytest

from softhand_sim.control.outcome import ControlOutcome, control_outcome
from softhand_sim.control.protocol import ValveCommand

FILL, SHUT, VENT = ValveCommand(True, False), ValveCommand(), ValveCommand(False, True)
NOISE = np.random.default_rng(0).normal(0.0, 150.0, 50)


@pytest.mark.parametrize(
    ("readings", "commands", "expected"),
    [
        (50e3 + NOISE, [SHUT] * 50, ControlOutcome.HELD),
        (50e3 + NOISE, [FILL] * 50, ControlOutcome.HELD),
        (20e3 + NOISE, [FILL] * 50, ControlOutcome.SATURATED),
        (20e3 - np.arange(50) * 100.0 + NOISE, [FILL] * 50, ControlOutcome.SATURATED),
        (20e3 + np.arange(50) * 500.0 + NOISE, [FILL] * 50, ControlOutcome.MOVING),
        (20e3 + NOISE, [FILL] * 49 + [SHUT], ControlOutcome.MOVING),
        (20e3 + NOISE, [VENT] * 50, ControlOutcome.MOVING),
        (80e3 + NOISE, [VENT] * 50, ControlOutcome.SATURATED),
    ],
)
def test_outcome(readings, commands, expected):
    assert control_outcome(readings, 50e3, commands, 1e3) is expected


def test_too_few_readings_are_refused():
    with pytest.raises(ValueError, match="10 or more"):
        control_outcome(np.zeros(9), 0.0, [SHUT] * 9, 1.0)
    with pytest.raises(ValueError, match="commands"):
        control_outcome(np.zeros(20), 0.0, [SHUT] * 9, 1.0)
