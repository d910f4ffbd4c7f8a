"""What a policy may command: pressures, angles or bare valves of the three elements, and the wrist."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from envs.errors import BadActionError
from softhand_sim.calibration import FingerCalibration
from softhand_sim.control.table import AngleTable
from softhand_sim.elements import ELEMENTS

Vector = npt.NDArray[np.float64]


class ActionMode(StrEnum):
    """What is commanded of the fingers: set pressures, set angles (both through the ON-OFF controller), or valves."""

    PRESSURE = "pressure"
    ANGLE = "angle"
    VALVE = "valve"


class Command(NamedTuple):
    """A decoded action: the finger command, (3,), and the wrist's velocity [m/s] and rate [rad/s], (w,), or None.

    ``fingers`` holds set pressures [Pa gauge], or the codes of `envs.valves` in the mode of bare valves.
    """

    fingers: Vector
    wrist: Vector | None


@dataclass(frozen=True, kw_only=True)
class ActionSpec:
    """How an action is laid out, checked and decoded.

    Attributes
    ----------
    mode
        What the first entries mean.
    wrist_rates
        Wrist speed along x, y, z [m/s], and turning rate in yaw, pitch, roll [rad/s] if it may turn, of an entry of 1:
        (w,) with w of 3 or 6; (0,) if actions do not move the wrist.
    table
        The controller's table, of the calibration that it knows.
    """

    mode: ActionMode
    wrist_rates: Vector
    table: AngleTable
    space: spaces.Space[Any] = field(init=False)
    _size: int = field(init=False)

    def __post_init__(self) -> None:
        fingers = 2 * len(ELEMENTS) if self.mode is ActionMode.VALVE else len(ELEMENTS)
        size = fingers + len(self.wrist_rates)
        object.__setattr__(self, "_size", size)
        # single precision: what learning libraries compute actions in
        box: spaces.Space[Any] = spaces.Box(-1.0, 1.0, (size,), dtype=np.float32)
        if self.mode is ActionMode.VALVE and not len(self.wrist_rates):
            box = spaces.MultiBinary(size)
        object.__setattr__(self, "space", box)

    @classmethod
    def of(
        cls, calibration: FingerCalibration, mode: ActionMode, *, wrist_axes: int, speed_m_per_s: float, rate: float
    ) -> "ActionSpec":
        """Return the layout for a controller that knows a finger's calibration; ``rate`` is in rad/s."""
        rates = np.repeat([speed_m_per_s, rate], 3)[:wrist_axes]
        return cls(mode=mode, wrist_rates=rates, table=AngleTable.of(calibration))

    def decode(self, action: npt.ArrayLike) -> Command:
        """Return what an action means.

        Raises
        ------
        BadActionError
            If its shape is wrong, or a value is no number of the space; names index and value.
        """
        values = self._checked(action)
        if self.mode is ActionMode.VALVE:
            opened = values[:6] > (0.0 if len(self.wrist_rates) else 0.5)
            # a code an element: 1 for an open inlet, 2 for an open outlet (`envs.valves`)
            fingers = opened[0::2] + 2.0 * opened[1::2]
        elif self.mode is ActionMode.ANGLE:
            share = 0.5 * (values[:3] + 1.0)
            low, high = self.table.angle_deg[0], self.table.angle_deg[-1]
            fingers = np.interp(low + share * (high - low), self.table.angle_deg, self.table.pressure_pa_gauge)
        else:
            fingers = 0.5 * (values[:3] + 1.0) * self.table.pressure_pa_gauge[-1]
        axes = len(self.wrist_rates)
        return Command(fingers, values[-axes:] * self.wrist_rates if axes else None)

    def _checked(self, action: npt.ArrayLike) -> Vector:
        try:
            values = np.asarray(action, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise BadActionError(f"action: {action!r} must be {self._size} numbers ({error})") from None
        if values.shape != (self._size,):
            raise BadActionError(f"action: shape {values.shape} must be ({self._size},)")
        if isinstance(self.space, spaces.MultiBinary):
            wrong, allowed = (values != 0.0) & (values != 1.0), "0 or 1"
        else:
            wrong, allowed = ~(np.abs(values) <= 1.0), "a number in [-1, 1]"
        if any(wrong.tolist()):
            k = int(np.flatnonzero(wrong)[0])
            raise BadActionError(f"action[{k}]: {values[k]} must be {allowed}")
        return values


def encode_pressures(spec: ActionSpec, set_pa_gauge: Sequence[float] | Vector) -> Vector:
    """Return the action entries, (3,), that ask for set pressures [Pa gauge], (3,), in a mode with a controller.

    Raises
    ------
    ValueError
        In the mode of bare valves, which has no set pressures.
    """
    if spec.mode is ActionMode.VALVE:
        raise ValueError("mode = 'valve': has no set pressures")
    table, wanted = spec.table, np.asarray(set_pa_gauge, dtype=np.float64)
    if spec.mode is ActionMode.PRESSURE:
        return 2.0 * wanted / table.pressure_pa_gauge[-1] - 1.0
    angles = np.interp(wanted, table.pressure_pa_gauge, table.angle_deg)
    low, high = table.angle_deg[0], table.angle_deg[-1]
    return np.asarray(2.0 * (angles - low) / (high - low) - 1.0)
