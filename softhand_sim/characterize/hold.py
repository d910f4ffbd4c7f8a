"""Long hold: one set pressure for a minute."""

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

SET_PA = 75e3
"""Choice: the pressure of the paper's one stated angle."""
HOLD_S = 60.0
SETTLE_S = 3.0
"""Choice: three times what the middle-ring-little element takes to fill."""
STATED = ("the controller holds the pressure that belongs to the wanted angle",)
LIMIT_PA = 2e3
"""What counts as held (this project's own requirement)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HoldStudy:
    """Repeats of the hold; r repeats.

    Attributes
    ----------
    records: one a repeat.
    spread_pa: highest less lowest true pressure after the settling time, shape (r, 3).
    largest_error_pa: largest distance of the true pressure from the set one meanwhile, shape (r, 3).
    drift_pa: mean of the last ten seconds less that of the first ten, shape (r, 3).
    valve_moves: how often a valve opened or shut meanwhile, shape (r, 3).
    """

    records: tuple[PressureRecord, ...]
    spread_pa: npt.NDArray[np.float64]
    largest_error_pa: npt.NDArray[np.float64]
    drift_pa: npt.NDArray[np.float64]
    valve_moves: npt.NDArray[np.float64]

    def steady(self) -> bool:
        """Whether every element of every repeat kept its pressure within the limit."""
        return bool((self.spread_pa <= LIMIT_PA).all())

    def near_set(self) -> bool:
        """Whether every element of every repeat stayed within the limit of the set pressure."""
        return bool((self.largest_error_pa <= LIMIT_PA).all())

    def summary(self) -> dict[str, Any]:
        """Return the figures, SI units, means with 95 % bands, each shape (3,)."""
        out: dict[str, Any] = {"stated": list(STATED), "set_pa_gauge": SET_PA, "hold_s": HOLD_S}
        out["elements"] = list(ELEMENTS)
        for name in ("spread_pa", "largest_error_pa", "drift_pa", "valve_moves"):
            band = confidence_band(getattr(self, name))
            out[name] = band.mean.tolist()
            out[f"{name}_band"] = band.half_width.tolist()
        out["largest_error_of_all_pa"] = float(self.largest_error_pa.max())
        out["limit_pa"] = LIMIT_PA
        out["steady"] = self.steady()
        out["near_set"] = self.near_set()
        return out


def run_hold(
    calibration: FingerCalibration, pneumatics: PneumaticSystem, seeds: Sequence[int], losses: Losses | None = None
) -> Iterator[PressureRecord]:
    """Run the test once for each seed of the sensors' noise; judge the records with `judge_hold`."""
    for seed in seeds:
        schedule = [Stretch(duration_s=SETTLE_S + HOLD_S, set_pa_gauge=SET_PA)]
        yield run_schedule(calibration, pneumatics, schedule, seed, losses)


def judge_hold(records: Sequence[PressureRecord]) -> HoldStudy:
    """Return the figures of the records of `run_hold`."""
    spreads, errors, drifts, moves = [], [], [], []
    for record in records:
        span = record.within(SETTLE_S, SETTLE_S + HOLD_S)
        pressure = record.pressure_pa_gauge[span]
        spreads.append(np.ptp(pressure, axis=0))
        errors.append(np.abs(pressure - SET_PA).max(axis=0))
        late, early = record.within(SETTLE_S + HOLD_S - 10.0, SETTLE_S + HOLD_S), record.within(SETTLE_S, 10.0)
        drifts.append(record.pressure_pa_gauge[late].mean(axis=0) - record.pressure_pa_gauge[early].mean(axis=0))
        positions = np.array(record.valves[span])
        moves.append((positions[1:] != positions[:-1]).sum(axis=(0, 2)))
    return HoldStudy(
        records=tuple(records),
        spread_pa=np.array(spreads),
        largest_error_pa=np.array(errors),
        drift_pa=np.array(drifts),
        valve_moves=np.array(moves, dtype=np.float64),
    )
