"""MPX4250A and its converter."""

import numpy as np
import pytest

from softhand_sim.pneumatics.sensor import PressureSensor

SENSOR = PressureSensor()


@pytest.mark.parametrize(
    ("pressure_pa_abs", "volts"), [(20e3, 0.2), (100e3, 1.8), (101.325e3, 1.8265), (200e3, 3.8), (250e3, 4.8)]
)
def test_transfer_function_of_the_data_sheet(pressure_pa_abs, volts):
    assert SENSOR.voltage_v(pressure_pa_abs) == pytest.approx(volts, rel=1e-12)


def test_typical_full_scale_of_the_data_sheet():
    """At the sheet's 5.1 V the output spans 0.204 V at 20 kPa to 4.896 V at 250 kPa."""
    sensor = PressureSensor(supply_v=5.1)
    assert sensor.voltage_v(20e3) == pytest.approx(0.204)
    assert sensor.voltage_v(250e3) == pytest.approx(4.896)


def test_quantisation_is_a_quarter_of_a_kilopascal():
    readings = np.array([SENSOR.read_pa_abs(p) for p in np.arange(30e3, 240e3, 7.0).tolist()])
    steps = np.diff(np.unique(readings))
    np.testing.assert_allclose(steps, 244.140625, rtol=1e-9)
    assert SENSOR.resolution_pa == pytest.approx(244.140625, rel=1e-12)


def test_reading_is_within_half_a_count_and_unbiased():
    pressures = np.random.default_rng(0).uniform(25e3, 245e3, 4000)
    errors = np.array([SENSOR.read_pa_abs(p) for p in pressures.tolist()]) - pressures
    assert np.max(np.abs(errors)) <= 0.5 * SENSOR.resolution_pa * (1.0 + 1e-9)
    # the mean of 4000 uniform errors of one count has a deviation of count / sqrt(12 * 4000)
    assert abs(errors.mean()) < 4.0 * SENSOR.resolution_pa / np.sqrt(12.0 * 4000.0)


def test_saturation():
    assert SENSOR.read_pa_abs(1e3) == SENSOR.read_pa_abs(20e3)
    assert SENSOR.read_pa_abs(400e3) == SENSOR.read_pa_abs(250e3)
    assert SENSOR.read_pa_abs(245e3) < SENSOR.read_pa_abs(250e3)


def test_noise_has_the_stated_deviation_and_comes_from_the_generator():
    sensor = PressureSensor(noise_v=0.05)  # ten counts, so that quantisation hardly widens it
    readings = [
        [sensor.sample_pa_abs(150e3, rng) for _ in range(4000)] for rng in (np.random.default_rng(7) for _ in range(2))
    ]
    assert readings[0] == readings[1]
    assert np.std(readings[0]) == pytest.approx(0.05 / (5.0 * 0.004e-3), rel=0.05)


def test_offset_shifts_the_reading():
    shifted = PressureSensor(offset_pa=1000.0)
    assert shifted.read_pa_abs(150e3) == SENSOR.read_pa_abs(151e3)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("supply_v", 0.0),
        ("noise_v", -1.0),
        ("converter_bits", 0),
        ("converter_bits", 10.5),
        ("high_pa_abs", 10e3),
    ],
)
def test_bad_parameters_are_named(field, value):
    with pytest.raises(ValueError, match=field):
        PressureSensor(**{field: value})
