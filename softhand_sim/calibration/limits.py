"""The range that a finger was calibrated in, and what a simulation did beyond it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration.parts import JOINT_RANGE_RAD, JOINTS
from softhand_sim.calibration.reader import FingerCalibration
from softhand_sim.elements import ELEMENTS, FINGERS

Vector = npt.NDArray[np.float64]

ANGLE_MARGIN_RAD = 0.035
"""Choice: 2 degrees, what the calibration's joint angles differ from the complete finger's at most."""
SET_PRESSURE_MARGIN_PA, PRESSURE_MARGIN_PA = 1.0, 1e3
"""Choices: rounding of a set pressure at the range's end; what noise lets a finger pass it by (0.6 kPa were seen)."""

PRESSURES = len(ELEMENTS)
HIGHEST = PRESSURES + len(FINGERS)
LOWEST = HIGHEST + len(FINGERS) * len(JOINTS)
EXTREMES = LOWEST + len(FINGERS) * len(JOINTS)
"""Where extremes begin in an array of them: set pressures first, then the fingers', highest and lowest angles; size."""
_WIDER = (np.maximum, np.maximum, np.maximum, np.minimum)


@dataclass(frozen=True, kw_only=True)
class CalibratedRange:
    """Highest pressure [Pa gauge] and joint angles [rad], (3,), of the calibration's curve; the lowest are 0.

    ``highest`` has them in the order of `RangeWatch.extremes`, without the lowest angles, with their margins, (23,).
    """

    pressure_pa_gauge: float
    joint_angle_rad: Vector
    highest: Vector = field(init=False)

    def __post_init__(self) -> None:
        pressure, angles = self.pressure_pa_gauge, np.tile(self.joint_angle_rad, len(FINGERS)) + ANGLE_MARGIN_RAD
        sets, chambers = [pressure + SET_PRESSURE_MARGIN_PA] * PRESSURES, [pressure + PRESSURE_MARGIN_PA] * len(FINGERS)
        object.__setattr__(self, "highest", np.array([*sets, *chambers, *angles]))

    @classmethod
    def of(cls, calibration: FingerCalibration) -> "CalibratedRange":
        """Return the range of a calibration."""
        curve = calibration.curve
        return cls(
            pressure_pa_gauge=float(curve.pressure_pa_gauge[-1]),
            joint_angle_rad=np.radians(curve.joint_angle_deg).max(axis=0),
        )


@dataclass(kw_only=True)
class RangeWatch:
    """Extremes of a simulation since its start; mutable on purpose, it is looked at every step.

    The engine limits the pressure that acts on a finger to the calibrated one without a word; here it is told.

    Attributes
    ----------
    limits: the calibrated range.
    extremes: set pressures, the fingers' pressures, joint angles at their highest and lowest, shape (38,).
    """

    limits: CalibratedRange
    extremes: Vector = field(default_factory=lambda: np.zeros(EXTREMES))

    def look(self, set_pa_gauge: Vector, pressure_pa_gauge: Sequence[float] | Vector, joint_angle_rad: Vector) -> None:
        """Take in set pressures per element (3,), pressures per finger (5,) and joint angles (5, 3)."""
        for part, now, wider in zip(
            _parts(self.extremes),
            (set_pa_gauge, pressure_pa_gauge, joint_angle_rad, joint_angle_rad),
            _WIDER,
            strict=True,
        ):
            wider(part, now, out=part)

    def passed(self) -> bool:
        """Return whether anything went beyond the calibrated range: what `beyond` would name, without the names."""
        return bool(_passed(self.limits, self.extremes))

    def farthest(self) -> tuple[float, float]:
        """Return by how much a pressure [Pa] passed the calibrated one, and a joint [rad] its stops; 0 without."""
        seen = self.extremes
        pressure = seen[:HIGHEST].max() - self.limits.pressure_pa_gauge
        angle = max(seen[HIGHEST:LOWEST].max() - JOINT_RANGE_RAD[1], JOINT_RANGE_RAD[0] - seen[LOWEST:].min())
        return max(0.0, float(pressure)), max(0.0, float(angle))

    def beyond(self) -> dict[str, float]:
        """Return what went beyond the calibrated range: the extreme value (Pa gauge or rad) by name, none if empty."""
        found: dict[str, float] = {}
        sets, pressures, high, low = _parts(self.extremes)
        for names, values, what, margin in (
            (ELEMENTS, sets, "set_pressure", SET_PRESSURE_MARGIN_PA),
            (FINGERS, pressures, "pressure", PRESSURE_MARGIN_PA),
        ):
            highest = self.limits.pressure_pa_gauge + margin
            found |= {f"{n}_{what}_pa_gauge": float(v) for n, v in zip(names, values, strict=True) if v > highest}
        for values, outside in (
            (high, high > self.limits.joint_angle_rad + ANGLE_MARGIN_RAD),
            (low, low < -ANGLE_MARGIN_RAD),
        ):
            for finger, joint in np.argwhere(outside):
                side = "highest" if values is high else "lowest"
                found[f"{FINGERS[finger]}_{JOINTS[joint]}_{side}_rad"] = float(values[finger, joint])
        return found


class RangeWatches:
    """`RangeWatch` of n worlds, looked at together."""

    def __init__(self, *, limits: CalibratedRange, worlds: int) -> None:
        self._limits = limits
        self.extremes: Vector = np.zeros((worlds, EXTREMES))

    def forget(self, worlds: npt.NDArray[np.int64]) -> None:
        """Start some worlds anew."""
        self.extremes[worlds] = 0.0

    def look(
        self, due: npt.NDArray[np.bool_], set_pa_gauge: Vector, pressure_pa_gauge: Vector, joint_angle_rad: Vector
    ) -> None:
        """Take in what the worlds that are due, (n,), show: as `RangeWatch.look`, one row a world."""
        seen = (set_pa_gauge, pressure_pa_gauge, joint_angle_rad, joint_angle_rad)
        for part, now, wider in zip(_parts(self.extremes), seen, _WIDER, strict=True):
            wider(part, now, out=part, where=due.reshape(-1, *[1] * (now.ndim - 1)))

    def passed(self) -> npt.NDArray[np.bool_]:
        """Return whether anything of each world went beyond the calibrated range, (n,): `RangeWatch.passed`."""
        return _passed(self._limits, self.extremes)

    def of_world(self, world: int) -> RangeWatch:
        """Return what one world showed."""
        return RangeWatch(limits=self._limits, extremes=self.extremes[world].copy())


def _passed(limits: CalibratedRange, extremes: Vector) -> npt.NDArray[np.bool_]:
    """Return whether any of the extremes, (..., 38), is outside the range and its margins."""
    high = (extremes[..., :LOWEST] > limits.highest).any(axis=-1)
    return np.asarray(high | (extremes[..., LOWEST:] < -ANGLE_MARGIN_RAD).any(axis=-1))


def _parts(extremes: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Return views of extremes, (..., 38): (..., 3), (..., 5), and twice (..., 5, 3)."""
    joints = (*extremes.shape[:-1], len(FINGERS), len(JOINTS))
    high, low = extremes[..., HIGHEST:LOWEST].reshape(joints), extremes[..., LOWEST:].reshape(joints)
    return extremes[..., :PRESSURES], extremes[..., PRESSURES:HIGHEST], high, low
