"""State of the hand's pneumatics, and its flat form for saving and restoring."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softhand_sim.control.protocol import ControllerState, ValveCommand


class PneumaticState(NamedTuple):
    """Everything that the next step depends on; immutable, so that a reference is a copy.

    What belongs to a feature that the system doesn't have is an empty tuple.

    Attributes
    ----------
    time_to_tick_s
        Time until the next control tick [s].
    ticks
        Control ticks since the reset; numbers the sensor's noise.
    noise_seed
        Seed of the sensors' noise, below 2**53 so that a float holds it exactly.
    mass_kg, pressure_pa_abs
        Gas mass [kg] and pressure [Pa abs] per element (3,): of the whole element, or of its manifold where the tubes
        resist.
    readings_pa_abs
        Last sensor readings [Pa abs] per element (3,).
    valves
        Valve positions per element (3,).
    controller
        The controller's memory.
    chamber_mass_kg, chamber_pa_abs
        Gas mass [kg] and pressure [Pa abs] per finger (5,), where the tubes resist.
    invariant
        `Polytropic.invariant` of the elements (3,) and of the chambers (5,), with heat of compression.
    waiting_s
        Time until a valve moves [s], inlet and outlet of each element (6,), infinite if it stays; with delay.
    supply_mass_kg
        Gas in the supply's receiver [kg] (1,), with a finite supply.
    time_s
        Time since the reset [s] (1,), with leaks.
    """

    time_to_tick_s: float
    ticks: int
    noise_seed: int
    mass_kg: tuple[float, ...]
    pressure_pa_abs: tuple[float, ...]
    readings_pa_abs: tuple[float, ...]
    valves: tuple[ValveCommand, ...]
    controller: ControllerState
    chamber_mass_kg: tuple[float, ...] = ()
    chamber_pa_abs: tuple[float, ...] = ()
    invariant: tuple[float, ...] = ()
    waiting_s: tuple[float, ...] = ()
    supply_mass_kg: tuple[float, ...] = ()
    time_s: tuple[float, ...] = ()

    def to_array(self) -> npt.NDArray[np.float64]:
        """Return the state as a flat array, floats bit for bit, fields in their order.

        Shape (3 + 5 n + c + f,): n elements, c floats of controller memory, f of features.
        """
        parts: list[float] = []
        for value in self:
            parts += _flat(value)
        return np.array(parts, dtype=np.float64)

    def from_array(self, flat: npt.NDArray[np.float64]) -> "PneumaticState":
        """Return the state that `to_array` wrote, bit for bit; this one, of the same system, lends its form.

        Raises
        ------
        ValueError
            If the array has another length.
        """
        size = self.to_array().size
        if flat.shape != (size,):
            raise ValueError(f"pneumatic state has shape {flat.shape}: must be ({size},)")
        rest: list[float] = flat.tolist()
        values: dict[str, object] = {}
        for name, value in self._asdict().items():
            count = len(_flat(value))
            mine, rest = rest[:count], rest[count:]
            if name == "valves":
                values[name] = tuple(ValveCommand(*(bool(x) for x in mine[k : k + 2])) for k in range(0, count, 2))
            else:
                values[name] = tuple(mine) if isinstance(value, tuple) else type(value)(mine[0])
        return PneumaticState(**values)  # type: ignore[arg-type]


def _flat(value: object) -> list[float]:
    if isinstance(value, tuple):
        return [x for part in value for x in _flat(part)]
    return [float(value)]  # type: ignore[arg-type]
