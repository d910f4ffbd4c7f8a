"""The hand's parts, the engine's arrays of any number of worlds, and what an actuation offers."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.hand.index import HandIndex
from softhand_sim.losses import Losses, LossState
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.system import PneumaticSystem

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class HandParts:
    """What all worlds share: addresses in the model, the finger, its losses, and pneumatics (None: set pressures)."""

    index: HandIndex
    calibration: FingerCalibration
    pneumatics: PneumaticSystem | None
    losses: Losses


@dataclass(frozen=True, kw_only=True, eq=False)
class EngineArrays:
    """Live views of the engine's memory, one row a world: tendon lengths (n, t), qpos (n, q), ctrl (n, u)."""

    ten_length: Vector
    qpos: Vector
    ctrl: Vector


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """What goes along with the steps of one world, beside its actuation; the arrays are written to.

    Attributes
    ----------
    wrist: the wrist's reference, which moves, and its target, (2, 1, 6).
    limits: the longest move [m] and turn [rad] of the wrist in a step, (2,).
    extremes: of a `RangeWatch`.
    clock: the world's time, that of the next look at the extremes, and the time between looks [s], (3,).
    given: recorded pressures for every step [Pa gauge], (steps, 5), that the fingers get while the gas stands still; or
        none, (0, 5).
    """

    wrist: Vector
    limits: Vector
    extremes: Vector
    clock: Vector
    given: Vector


class Runner(Protocol):
    """Takes whole steps of one world."""

    def __call__(self, course: Course, dt: float, steps: int) -> None:
        """Take steps of ``dt`` [s]: move the wrist's reference, advance the actuation, step the engine, look.

        Raises
        ------
        ValueError
            As `Actuation.step`.
        mujoco.FatalError
            If the engine fails.
        """
        ...


class Actuation(Protocol):
    """The pressures and losses of n hands.

    Attributes
    ----------
    set_pa_gauge: wanted pressures (Pa), shape (n, 3); read at control ticks.
    pressure_pa_gauge: pressures in the fingers in the last step (Pa), shape (n, 5).
    """

    set_pa_gauge: Vector
    pressure_pa_gauge: Vector

    def reset(self, world: int, rng: np.random.Generator) -> None:
        """Empty the fingers of a world, at the elongations that the engine's arrays show."""
        ...

    def step(self, dt: float) -> None:
        """Advance by ``dt`` [s] and write pressures and losses to the engine's ``ctrl``.

        Raises
        ------
        ValueError
            As `PneumaticSystem.step`.
        """
        ...

    def play(self, pressures_pa_gauge: Vector) -> None:
        """Let the gas stand still in the steps that follow and give the fingers these pressures [Pa], (n, 5)."""
        ...

    def stop_playing(self) -> None:
        """Let the gas go on."""
        ...

    def pressure_pa_abs(self) -> Vector:
        """Return the pressure [Pa abs] where each element's sensor sits, (n, 3); there has to be gas."""
        ...

    def reading_pa_abs(self) -> Vector:
        """Return the last readings of the sensors [Pa abs], (n, 3); there has to be gas."""
        ...

    def valves_open(self) -> Vector:
        """Return which valves are open, inlet and outlet of each element, 1 or 0, (n, 6); there has to be gas."""
        ...

    def gas(self, world: int) -> PneumaticState | None:
        """Return a world's gas, valves and control, None without pneumatics; `set_gas` takes it back bit for bit."""
        ...

    def set_gas(self, world: int, state: PneumaticState | None) -> None:
        """Put gas, valves and control of a world into a state."""
        ...

    def losses(self, world: int) -> LossState:
        """Return slip, relaxation and relief of a world's fingers; `set_losses` takes them back bit for bit."""
        ...

    def set_losses(self, world: int, state: LossState) -> None:
        """Put slip, relaxation and relief of a world's fingers into a state."""
        ...
