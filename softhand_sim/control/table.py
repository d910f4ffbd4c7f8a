"""The controller's table from bending angle to pressure."""

import bisect
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.elements import ELEMENTS


@dataclass(frozen=True, kw_only=True)
class AngleTable:
    """Pressures that belong to bending angles, linear between the rows (the paper takes them from its analysis).

    One table serves all elements, whose fingers are identical.

    Attributes
    ----------
    angle_deg
        Tip angles [deg], (n,), rising.
    pressure_pa_gauge
        Pressures [Pa gauge], (n,), rising.

    Raises
    ------
    ValueError
        If the table has fewer than two rows, different lengths, or doesn't rise.
    """

    angle_deg: tuple[float, ...]
    pressure_pa_gauge: tuple[float, ...]

    def __post_init__(self) -> None:
        if not len(self.angle_deg) == len(self.pressure_pa_gauge) >= 2:
            raise ValueError(
                f"angle_deg has {len(self.angle_deg)} rows, pressure_pa_gauge {len(self.pressure_pa_gauge)}: "
                "must be the same number, 2 or more"
            )
        for name in ("angle_deg", "pressure_pa_gauge"):
            if not bool((np.diff(getattr(self, name)) > 0.0).all()):
                raise ValueError(f"{name} = {getattr(self, name)}: must rise from row to row")

    @classmethod
    def of(cls, calibration: FingerCalibration, rows: int | None = None) -> "AngleTable":
        """Return a finger's table: the calibration's own points, or ``rows`` angles at equal distances.

        Raises
        ------
        ValueError
            If fewer than two rows are asked for.
        """
        curve = calibration.curve
        if rows is None:
            angles = curve.tip_angle_deg
        elif rows < 2:
            raise ValueError(f"rows = {rows!r}: must be 2 or above")
        else:
            angles = np.linspace(float(curve.tip_angle_deg[0]), float(curve.tip_angle_deg[-1]), rows)
        pressures = np.interp(angles, curve.tip_angle_deg, curve.pressure_pa_gauge)
        return cls(angle_deg=tuple(angles.tolist()), pressure_pa_gauge=tuple(pressures.tolist()))

    def pressure(self, angle_deg: float) -> float:
        """Return the pressure [Pa gauge] for one angle.

        Raises
        ------
        ValueError
            If the angle lies outside the table.
        """
        low, high = self.angle_deg[0], self.angle_deg[-1]
        if not low <= angle_deg <= high:
            raise ValueError(f"angle_deg = {angle_deg!r}: must be within the table's {low:g} to {high:g}")
        k = min(bisect.bisect_right(self.angle_deg, angle_deg), len(self.angle_deg) - 1)
        share = (angle_deg - self.angle_deg[k - 1]) / (self.angle_deg[k] - self.angle_deg[k - 1])
        return self.pressure_pa_gauge[k - 1] + share * (self.pressure_pa_gauge[k] - self.pressure_pa_gauge[k - 1])

    def pressures(self, set_angle_deg: Sequence[float]) -> tuple[float, ...]:
        """Return the set pressures [Pa gauge] (3,) for a set angle of each element [deg], (3,).

        Raises
        ------
        ValueError
            If their number is wrong, or one lies outside the table; the message names the element.
        """
        if len(set_angle_deg) != len(ELEMENTS):
            raise ValueError(f"set_angle_deg has {len(set_angle_deg)} values: must have {len(ELEMENTS)}")
        out: list[float] = []
        for name, angle in zip(ELEMENTS, set_angle_deg, strict=True):
            try:
                out.append(self.pressure(angle))
            except ValueError as error:
                raise ValueError(f"set angle of {name}: {error}") from None
        return tuple(out)
