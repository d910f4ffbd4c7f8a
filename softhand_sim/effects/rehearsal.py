"""A closing in free air without the engine: gas and control alone, fingers at rest at their pressure."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects.build import TICK_S, build_pneumatics
from softhand_sim.effects.effects import Effects
from softhand_sim.elements import FINGERS, FINGERS_OF_ELEMENT

_SEED = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class Rehearsal:
    """Gauge pressure in the chambers of each element at the control ticks, shape (n, 3), and the largest pulse.

    ``pulse_pa`` is the largest change in one tick of an element that is above half its set pressure.
    """

    pressure_pa_gauge: npt.NDArray[np.float64]
    pulse_pa: float


def rehearse(
    effects: Effects, calibration: FingerCalibration, set_pa_gauge: npt.NDArray[np.float64], duration_s: float
) -> Rehearsal | None:
    """Return the closing to the set pressures [Pa gauge], (3,), that the effects give; None without gas."""
    system = build_pneumatics(effects, calibration)
    if system is None:
        return None
    curve = calibration.curve
    elongation = [calibration.elongation_m(tuple(np.radians(row).tolist())) for row in curve.joint_angle_deg]
    volume = [calibration.chamber.volume_m3_at(d) for d in elongation]
    state = system.reset([volume[0]] * len(FINGERS), np.random.default_rng(_SEED))
    rows = []
    for _ in range(round(duration_s / TICK_S)):
        pressures = system.finger_pressures_pa_gauge(state)
        volumes = np.interp(pressures, curve.pressure_pa_gauge, volume)
        for _ in range(4):  # 5 ms: half a pulse's error would be as large as what is looked for
            state = system.step(state, volumes, set_pa_gauge, TICK_S / 4.0)
        after = system.finger_pressures_pa_gauge(state)
        rows.append([after[members[0]] for members in FINGERS_OF_ELEMENT])
    pressure = np.array(rows)
    change = np.abs(np.diff(pressure, axis=0, prepend=0.0))
    return Rehearsal(pressure_pa_gauge=pressure, pulse_pa=float(change[pressure > 0.5 * set_pa_gauge].max(initial=0.0)))


def without(effects: Effects, name: str) -> Effects:
    """Return the effects without one of them."""
    return replace(effects, **{name: None})
