"""The ON-OFF law by itself, and which fingers belong to which element."""

import numpy as np
import pytest

from softhand_sim.air import AMBIENT_PA_ABS as P0
from softhand_sim.control.onoff import OnOffController
from softhand_sim.elements import (
    ELEMENT_FINGERS,
    ELEMENT_OF_FINGER,
    ELEMENTS,
    FINGERS,
    FINGERS_OF_ELEMENT,
    spread_to_fingers,
    sum_over_fingers,
)

LITERAL = OnOffController(dead_band_pa=500.0, lookahead=False)


def drive(controller, gauges, sets):
    """Valve positions of the first element over a series of gauge readings and set values."""
    state, out = controller.reset(), []
    for gauge, wanted in zip(gauges, sets, strict=True):
        commands, state = controller.command([P0 + gauge] * 3, [wanted] * 3, state)
        assert commands[0] == commands[1] == commands[2]
        out.append((commands[0].inlet_open, commands[0].outlet_open))
    return out


SHUT, FILL, VENT = (False, False), (True, False), (False, True)


def test_inlet_opens_below_the_band_and_shuts_at_the_set_value():
    gauges = [29_600.0, 29_400.0, 29_900.0, 30_000.0, 29_600.0, 29_499.0]
    assert drive(LITERAL, gauges, [30e3] * 6) == [SHUT, FILL, FILL, SHUT, SHUT, FILL]


def test_outlet_mirrors_it():
    gauges = [30_400.0, 30_600.0, 30_100.0, 30_000.0, 30_400.0, 30_501.0]
    assert drive(LITERAL, gauges, [30e3] * 6) == [SHUT, VENT, VENT, SHUT, SHUT, VENT]


def test_lookahead_stops_one_pulse_early_and_does_not_fire_again():
    controller = OnOffController(dead_band_pa=500.0)
    # pulses of 4 kPa: from 24 a further one ends at 28, from 28 it would end at 32
    gauges = [16e3, 20e3, 24e3, 28e3, 28e3, 26.5e3, 25.9e3]
    assert drive(controller, gauges, [30e3] * 7) == [FILL, FILL, FILL, SHUT, SHUT, SHUT, FILL]
    gauges = [44e3, 40e3, 36e3, 32e3, 32e3, 33.5e3, 34.1e3]
    assert drive(controller, gauges, [30e3] * 7) == [VENT, VENT, VENT, SHUT, SHUT, SHUT, VENT]


def test_inlet_stays_open_against_a_leak_that_it_cannot_win():
    gauges = [20e3, 19e3, 18e3, 17e3]
    assert drive(OnOffController(), gauges, [30e3] * 4) == [FILL] * 4


def test_release_vents_to_ambient():
    controller = OnOffController(dead_band_pa=500.0)
    assert drive(controller, [40e3, 36e3, 3e3, 100.0, 0.0, 400.0], [0.0] * 6) == [VENT] * 4 + [SHUT] * 2


def test_a_pulse_lasts_its_shortest_time():
    controller = OnOffController(dead_band_pa=500.0, lookahead=False, minimum_pulse_ticks=3)
    gauges = [29e3, 31e3, 31e3, 31e3, 30e3, 30e3]
    assert drive(controller, gauges, [30e3] * 6) == [FILL, FILL, FILL, VENT, VENT, VENT]
    gauges = [10e3, 12e3, 14e3, 16e3, 18e3, 30e3]
    assert drive(controller, gauges, [30e3] * 6) == [FILL] * 5 + [SHUT]


def test_lookahead_reckons_with_the_whole_shortest_pulse():
    controller = OnOffController(dead_band_pa=500.0, minimum_pulse_ticks=3)
    # 4 kPa a tick, so a new pulse would bring 12: no pulse from 19 kPa, one from 17
    gauges = [4e3, 8e3, 12e3, 16e3, 20e3, 24e3, 28e3, 19e3, 17e3]
    assert drive(controller, gauges, [30e3] * 9) == [FILL] * 6 + [SHUT, SHUT, FILL]


def test_dead_time_is_looked_ahead_too():
    """4 kPa a tick and half a tick of flow after the command: shut 6 kPa early, and no pulse that would pass."""
    controller = OnOffController(dead_band_pa=500.0, dead_time_ticks=0.5)
    gauges = [10e3, 12e3, 16e3, 20e3, 24e3, 26e3, 26e3, 25.9e3, 27.8e3, 29.8e3]
    assert drive(controller, gauges, [30e3] * 10) == [FILL] * 4 + [SHUT] * 3 + [FILL, SHUT, SHUT]


@pytest.mark.parametrize("lookahead", [True, False])
def test_never_both_open(lookahead):
    rng = np.random.default_rng(0)
    controller = OnOffController(lookahead=lookahead)
    positions = drive(controller, rng.uniform(0.0, 80e3, 5000).tolist(), rng.uniform(0.0, 80e3, 5000).tolist())
    assert (True, True) not in positions
    assert {SHUT, FILL, VENT} == set(positions)


def test_elements_are_independent():
    commands, _ = LITERAL.command([P0 + 10e3, P0 + 30e3, P0 + 50e3], [30e3] * 3, LITERAL.reset())
    assert [tuple(c) for c in commands] == [FILL, SHUT, VENT]


def test_elements_and_fingers_agree():
    assert ELEMENTS == ("thumb", "index", "middle_ring_little")
    assert [f for e in ELEMENTS for f in ELEMENT_FINGERS[e]] == list(FINGERS)
    values = [1.0, 20.0, 300.0, 4000.0, 50_000.0]
    assert sum_over_fingers(values) == tuple(sum(values[f] for f in members) for members in FINGERS_OF_ELEMENT)
    assert spread_to_fingers([7.0, 8.0, 9.0]) == tuple([7.0, 8.0, 9.0][k] for k in ELEMENT_OF_FINGER)


def test_bad_parameters_are_named():
    with pytest.raises(ValueError, match="dead_band_pa"):
        OnOffController(dead_band_pa=-1.0)
    with pytest.raises(ValueError, match="minimum_pulse_ticks"):
        OnOffController(minimum_pulse_ticks=0)
    with pytest.raises(ValueError, match="ambient_pa_abs"):
        OnOffController(ambient_pa_abs=float("nan"))
