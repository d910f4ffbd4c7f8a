"""State of the hand's pneumatics, and its flat form for saving and restoring."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softhand_sim.control.protocol import ControllerState, ValveCommand


class PneumaticState(NamedTuple):
    """Everything that the next step depends on; immutable, so that a reference is a copy.

    Attributes
    ----------
    time_to_tick_s
        Time until the next control tick [s].
    ticks
        Control ticks since the reset; numbers the sensor's noise.
    noise_seed
        Seed of the sensors' noise, below 2**53 so that a float holds it exactly.
    mass_kg, pressure_pa_abs
        Gas mass [kg] and pressure [Pa abs] per element (3,).
    readings_pa_abs
        Last sensor readings [Pa abs] per element (3,).
    valves
        Valve positions per element (3,).
    controller
        The controller's memory.
    """

    time_to_tick_s: float
    ticks: int
    noise_seed: int
    mass_kg: tuple[float, ...]
    pressure_pa_abs: tuple[float, ...]
    readings_pa_abs: tuple[float, ...]
    valves: tuple[ValveCommand, ...]
    controller: ControllerState

    def to_array(self) -> npt.NDArray[np.float64]:
        """Return the state as a flat array, (3 + 5 n + c,): n elements, c floats of controller memory."""
        positions = [float(valve_open) for command in self.valves for valve_open in command]
        return np.array(
            [
                self.time_to_tick_s,
                float(self.ticks),
                float(self.noise_seed),
                *self.mass_kg,
                *self.pressure_pa_abs,
                *self.readings_pa_abs,
                *positions,
                *self.controller,
            ],
            dtype=np.float64,
        )


def state_from_array(flat: npt.NDArray[np.float64], elements: int, memory: int) -> PneumaticState:
    """Return the state that ``PneumaticState.to_array`` wrote, bit for bit.

    Parameters
    ----------
    flat
        Flat state, (3 + 5 elements + memory,).
    elements
        Number of elements.
    memory
        Number of floats of the controller's memory.

    Raises
    ------
    ValueError
        If the array has another length.
    """
    size = 3 + 5 * elements + memory
    if flat.shape != (size,):
        raise ValueError(f"pneumatic state has shape {flat.shape}: must be ({size},)")
    values: list[float] = flat.tolist()
    n = elements
    positions = [value != 0.0 for value in values[3 + 3 * n : 3 + 5 * n]]
    return PneumaticState(
        time_to_tick_s=values[0],
        ticks=int(values[1]),
        noise_seed=int(values[2]),
        mass_kg=tuple(values[3 : 3 + n]),
        pressure_pa_abs=tuple(values[3 + n : 3 + 2 * n]),
        readings_pa_abs=tuple(values[3 + 2 * n : 3 + 3 * n]),
        valves=tuple(ValveCommand(positions[2 * k], positions[2 * k + 1]) for k in range(n)),
        controller=tuple(values[3 + 5 * n :]),
    )
