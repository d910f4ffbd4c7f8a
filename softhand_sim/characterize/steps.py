"""Step test: 0-15-30-45-30-15-0 kPa, five seconds each."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.characterize.bands import confidence_band
from softhand_sim.characterize.pressure_run import PressureRecord, Stretch, run_schedule
from softhand_sim.elements import ELEMENTS
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.system import PneumaticSystem

SET_PA = (15e3, 30e3, 45e3, 30e3, 15e3, 0.0)
STEP_S = 5.0
STATED = (
    "on the way up pressure sags slightly under the set value, on the way down it creeps slightly up",
    "held values sit slightly below the set ones",
)
"""The paper's observations."""

# choice: the last second of each step counts as held
_HELD_S = 1.0


@dataclass(frozen=True, kw_only=True, eq=False)
class StepsStudy:
    """Repeats of the step test; r repeats, s = 6 steps, 3 elements.

    Attributes
    ----------
    records: one a repeat.
    held_minus_set_pa: mean over the last second of a step less the set pressure, shape (r, s, 3).
    drift_pa: mean over the last second less the pressure when the valves shut for the last time, shape (r, s, 3);
        zero where they never shut.
    pulse_pa: largest change in one control period while a valve was open, shape (r, s, 3).
    resolution_pa, noise_pa: one count of the sensor's converter, and the deviation of its noise.
    """

    records: tuple[PressureRecord, ...]
    held_minus_set_pa: npt.NDArray[np.float64]
    drift_pa: npt.NDArray[np.float64]
    pulse_pa: npt.NDArray[np.float64]
    resolution_pa: float
    noise_pa: float

    @property
    def upward(self) -> npt.NDArray[np.bool_]:
        """Which steps go up, shape (s,)."""
        return np.diff([0.0, *SET_PA]) > 0.0

    def held_below_within_a_pulse(self) -> bool:
        """Whether every held value on the way up is below the set one, by at most a count and a pulse.

        A count and two deviations of the noise above it pass: the sensor could not tell.
        """
        below, count = -self.held_minus_set_pa[:, self.upward], self.resolution_pa
        unseen = count + 2.0 * self.noise_pa
        return bool((below >= -unseen).all() and (below <= count + self.pulse_pa[:, self.upward]).all())

    def signs_hold(self) -> bool:
        """Whether the pressure sags after each step up and creeps up after each step down.

        On average over repeats and elements: where the swing of a finger goes on when the valve shuts, a single one
        may read up to a count the other way. Release to ambient, the last step, is left out.
        """
        drift = self.drift_pa.mean(axis=(0, 2))
        down = ~self.upward
        down[-1] = False
        return bool((drift[self.upward] < 0.0).all() and (drift[down] > 0.0).all())

    def summary(self) -> dict[str, Any]:
        """Return the figures, SI units, means with 95 % bands; shape of each list: (s, 3)."""
        out: dict[str, Any] = {"stated": list(STATED), "set_pa_gauge": list(SET_PA), "elements": list(ELEMENTS)}
        for name in ("held_minus_set_pa", "drift_pa"):
            band = confidence_band(getattr(self, name))
            out[name] = band.mean.tolist()
            out[f"{name}_band"] = band.half_width.tolist()
        out["largest_pulse_pa"] = self.pulse_pa.max(axis=0).tolist()
        out["resolution_pa"] = self.resolution_pa
        out["held_below_within_a_pulse"] = self.held_below_within_a_pulse()
        out["signs_hold"] = self.signs_hold()
        return out


def run_steps(
    calibration: FingerCalibration, pneumatics: PneumaticSystem, seeds: Sequence[int], losses: Losses | None = None
) -> Iterator[PressureRecord]:
    """Run the test once for each seed of the sensors' noise; judge the records with `judge_steps`."""
    for seed in seeds:
        schedule = [Stretch(duration_s=STEP_S, set_pa_gauge=p) for p in SET_PA]
        yield run_schedule(calibration, pneumatics, schedule, seed, losses)


def judge_steps(records: Sequence[PressureRecord], pneumatics: PneumaticSystem) -> StepsStudy:
    """Return the figures of the records of `run_steps`."""
    late = 0 if pneumatics.delay is None else math.ceil(pneumatics.delay.closing_s / pneumatics.tick_s)
    figures = np.array([[_step_figures(record, k, late) for k in range(len(SET_PA))] for record in records])
    sensor = pneumatics.sensor
    return StepsStudy(
        records=tuple(records),
        held_minus_set_pa=figures[:, :, 0],
        drift_pa=figures[:, :, 1],
        pulse_pa=figures[:, :, 2],
        resolution_pa=0.0 if sensor is None else sensor.resolution_pa,
        noise_pa=0.0 if sensor is None else sensor.noise_pa,
    )


def _step_figures(record: PressureRecord, step: int, late: int) -> npt.NDArray[np.float64]:
    """Return held less set, drift and pulse [Pa] of one step, shape (3, 3): figure, element.

    ``late`` is how many samples after the last one with an open valve it has surely shut.
    """
    span = record.within(step * STEP_S, (step + 1) * STEP_S)
    pressure, valves = record.pressure_pa_gauge[span], record.valves[span]
    held = pressure[record.within((step + 1) * STEP_S - _HELD_S, (step + 1) * STEP_S).start - span.start :].mean(axis=0)
    drift, pulse = np.zeros(len(ELEMENTS)), np.zeros(len(ELEMENTS))
    for k in range(len(ELEMENTS)):
        open_ = np.array([any(row[k]) for row in valves])
        if open_.any() and not open_[-1 - late :].any():
            drift[k] = held[k] - pressure[np.flatnonzero(open_)[-1] + late, k]
        change = np.abs(np.diff(pressure[:, k], prepend=pressure[0, k]))
        pulse[k] = change[open_].max(initial=0.0)
    return np.array([held - SET_PA[step], drift, pulse])
