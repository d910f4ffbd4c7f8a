"""Dead time of the valves: edges shifted, short pulses swallowed, whatever the step."""

import math

import numpy as np
import pytest

from softhand_sim.control.protocol import ValveCommand
from softhand_sim.pneumatics.delay import ValveDelay
from softhand_sim.pneumatics.system import PneumaticSystem

V0 = 2.5e-6


class Pulse:
    """Inlets open for the first `ticks` ticks."""

    def __init__(self, ticks):
        self.ticks = ticks

    def reset(self):
        return (0.0,)

    def command(self, _readings, _sets, state):
        return (ValveCommand(state[0] < self.ticks, False),) * 3, (state[0] + 1.0,)


def gained_kg(delay, ticks, dt=1e-3, duration=0.3):
    """Mass that the thumb takes in from one pulse."""
    system = PneumaticSystem(controller=Pulse(ticks), delay=delay, sensor=None)
    state = start = system.reset([V0] * 5, np.random.default_rng(0))
    for _ in range(round(duration / dt)):
        state = system.step(state, [V0] * 5, [0.0] * 3, dt)
    return state.mass_kg[0] - start.mass_kg[0]


def test_equal_delays_shift_a_pulse_and_keep_its_length():
    assert gained_kg(ValveDelay(opening_s=0.013, closing_s=0.013), 3) == pytest.approx(gained_kg(None, 3), rel=1e-3)


def test_unequal_delays_change_its_length():
    longer = gained_kg(ValveDelay(opening_s=0.0, closing_s=0.02), 3)
    assert longer == pytest.approx(gained_kg(None, 4), rel=1e-3)
    shorter = gained_kg(ValveDelay(opening_s=0.03, closing_s=0.01), 3)
    assert shorter == pytest.approx(gained_kg(None, 2), rel=1e-3)


def test_a_pulse_shorter_than_the_opening_lets_nothing_through():
    assert gained_kg(ValveDelay(opening_s=0.021, closing_s=0.0), 1) == 0.0
    assert gained_kg(ValveDelay(opening_s=0.019, closing_s=0.0), 1) > 0.0


def test_moves_fall_inside_a_step_not_at_its_end():
    delay = ValveDelay(opening_s=0.0137, closing_s=0.0071)
    masses = [gained_kg(delay, 4, dt, 0.28) for dt in (1e-4, 7e-3, 2e-2)]
    np.testing.assert_allclose(masses, masses[0], rtol=0.01)


@pytest.mark.parametrize(
    ("opening", "closing", "named"),
    [(-1e-3, 0.0, "opening_s"), (0.0, math.nan, "closing_s"), (0.0, 0.0, "opening_s = closing_s = 0")],
)
def test_bad_parameters_are_named(opening, closing, named):
    with pytest.raises(ValueError, match=named):
        ValveDelay(opening_s=opening, closing_s=closing)
