"""Absolute-pressure sensor MPX4250A read by a 10-bit converter."""

import math
from dataclasses import dataclass

import numpy as np

from softhand_sim.checks import require_finite


@dataclass(frozen=True, kw_only=True)
class PressureSensor:
    """Transfer function, saturation, noise and quantisation of one sensor and its converter.

    ``Vout = Vs (0.004 P - 0.04)`` with P in kPa abs, from 20 to 250 kPa (NXP data sheet MPX4250A). The
    output is ratiometric and the converter's reference is the same supply.

    Attributes
    ----------
    supply_v
        ``Vs`` [V] (data sheet: 4.85 to 5.35, typically 5.1; 5.0 is what an Arduino Nano offers).
    low_pa_abs, high_pa_abs
        Range outside which the output saturates [Pa abs] (data sheet).
    converter_bits
        Resolution of the converter (ATmega328P: 10 bit); 10 bit of 5 V are 0.244 kPa.
    noise_v
        Standard deviation of the white noise ahead of the converter [V]. Choice: half a count (the sheet
        states none); it breaks up the quantisation and is far below the sheet's accuracy.
    offset_pa
        Constant error [Pa]. Choice: 0, sensors being zeroed against ambient; the sheet allows +-1.5 % of
        the span, 3.45 kPa.

    Raises
    ------
    ValueError
        If a parameter is out of its range.
    """

    supply_v: float = 5.0
    low_pa_abs: float = 20e3
    high_pa_abs: float = 250e3
    converter_bits: int = 10
    noise_v: float = 2.5e-3
    offset_pa: float = 0.0

    def __post_init__(self) -> None:
        require_finite("supply_v", self.supply_v, above=0.0)
        require_finite("low_pa_abs", self.low_pa_abs, at_least=10e3)  # the line crosses 0 V at 10 kPa
        require_finite("high_pa_abs", self.high_pa_abs, above=self.low_pa_abs)
        if self.converter_bits not in range(1, 25):
            raise ValueError(f"converter_bits = {self.converter_bits!r}: must be an integer from 1 to 24")
        require_finite("noise_v", self.noise_v, at_least=0.0)
        require_finite("offset_pa", self.offset_pa)

    @property
    def resolution_pa(self) -> float:
        """Pressure that one count of the converter stands for [Pa]."""
        return 1e3 / (0.004 * (1 << self.converter_bits))

    @property
    def noise_pa(self) -> float:
        """Standard deviation of the noise in terms of pressure [Pa]."""
        return self.noise_v / (self.supply_v * 0.004e-3)

    def voltage_v(self, pressure_pa_abs: float) -> float:
        """Return the output [V] without noise at an absolute pressure [Pa], saturated outside the range."""
        seen = min(max(pressure_pa_abs + self.offset_pa, self.low_pa_abs), self.high_pa_abs)
        return self.supply_v * (0.004e-3 * seen - 0.04)

    def counts(self, voltage_v: float) -> int:
        """Return the converter's code for a voltage [V], clipped to its range."""
        full = 1 << self.converter_bits
        return min(max(math.floor(voltage_v / self.supply_v * full), 0), full - 1)

    def decode_pa_abs(self, counts: int) -> float:
        """Return the absolute pressure [Pa] that a code stands for: the middle of its interval."""
        return ((counts + 0.5) / (1 << self.converter_bits) + 0.04) / 0.004e-3

    def read_pa_abs(self, pressure_pa_abs: float, noise: float = 0.0) -> float:
        """Return a decoded reading [Pa abs].

        Parameters
        ----------
        pressure_pa_abs
            True pressure [Pa abs].
        noise
            A draw from the standard normal distribution, scaled here by ``noise_v``.
        """
        return self.decode_pa_abs(self.counts(self.voltage_v(pressure_pa_abs) + self.noise_v * noise))

    def sample_pa_abs(self, pressure_pa_abs: float, rng: np.random.Generator) -> float:
        """Return a decoded reading [Pa abs] with its noise drawn from ``rng``."""
        return self.read_pa_abs(pressure_pa_abs, float(rng.standard_normal()))
