"""A bench run: fingers in free air, driven by a schedule of set pressures, recorded once a control period."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.control.protocol import ValveCommand
from softhand_sim.elements import ELEMENTS
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """A time [s] at one set pressure [Pa gauge], the same for all elements."""

    duration_s: float
    set_pa_gauge: float


@dataclass(frozen=True, kw_only=True, eq=False)
class PressureRecord:
    """One run, n samples, one at the end of each control period.

    Attributes
    ----------
    time_s: shape (n,).
    set_pa_gauge: shape (n,).
    pressure_pa_gauge: true pressures of the elements where the sensors sit, shape (n, 3).
    reading_pa_gauge: what the sensors said at the period's start, shape (n, 3).
    valves: positions at the period's end, n times (3,).
    tip_angle_deg: shape (n, 5).
    """

    time_s: Vector
    set_pa_gauge: Vector
    pressure_pa_gauge: Vector
    reading_pa_gauge: Vector
    valves: tuple[tuple[ValveCommand, ...], ...]
    tip_angle_deg: Vector

    def within(self, start_s: float, end_s: float) -> slice:
        """Return the samples after ``start_s`` up to ``end_s``."""
        low, high = np.searchsorted(self.time_s, [start_s + 1e-6, end_s + 1e-6])
        return slice(int(low), int(high))


def run_schedule(
    calibration: FingerCalibration,
    pneumatics: PneumaticSystem,
    schedule: Sequence[Stretch],
    seed: int,
    losses: Losses | None = None,
) -> PressureRecord:
    """Run a schedule from empty fingers at rest.

    Gravity and contacts are off: closed fingers would touch the thumb, and the paper tests fingers one by one.

    Parameters
    ----------
    calibration
        The finger.
    pneumatics
        Valves, tubes, sensors, control.
    schedule
        What is asked for, one stretch after the other; times are rounded to whole control periods.
    seed
        Of the sensors' noise.
    losses
        Friction and relaxation of the fingers; by default the calibration's friction alone.

    Raises
    ------
    ValueError
        If a set pressure is outside the calibration's curve (the finger has no angle there).
    """
    for stretch in schedule:
        calibration.angle_for_pressure(stretch.set_pa_gauge)
    model = compile_scene(build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))).model
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    simulation = HandSimulation(model=model, calibration=calibration, pneumatics=pneumatics, losses=losses)
    simulation.reset(np.random.default_rng(seed), np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]))
    steps = round(pneumatics.tick_s / simulation.dt)
    rows: list[tuple[float, float, Vector, Vector, Vector]] = []
    valves: list[tuple[ValveCommand, ...]] = []
    for stretch in schedule:
        simulation.set_pressure_pa_gauge = np.full(len(ELEMENTS), stretch.set_pa_gauge)
        for _ in range(round(stretch.duration_s / pneumatics.tick_s)):
            for _ in range(steps):
                simulation.step()
            pressure, reading = simulation.pressure_pa_gauge(), simulation.reading_pa_gauge()
            angle = np.degrees(simulation.tip_angles_rad())
            rows.append((float(simulation.data.time), stretch.set_pa_gauge, pressure, reading, angle))
            valves.append(simulation.gas.valves if simulation.gas is not None else ())
    time, sets, pressures, readings, angles = (np.array(column) for column in zip(*rows, strict=True))
    return PressureRecord(
        time_s=time,
        set_pa_gauge=sets,
        pressure_pa_gauge=pressures,
        reading_pa_gauge=readings,
        valves=tuple(valves),
        tip_angle_deg=angles,
    )
