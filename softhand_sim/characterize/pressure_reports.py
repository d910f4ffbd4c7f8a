"""The pressure tests by name, as reports: repeats over seeds of the sensors' noise, 95 % bands."""

from collections.abc import Callable, Sequence

import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.characterize import hold, leak, steps
from softhand_sim.characterize.bands import confidence_band
from softhand_sim.characterize.pressure_run import PressureRecord
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source
from softhand_sim.control.outcome import ControlOutcome
from softhand_sim.effects.build import build_losses, build_pneumatics
from softhand_sim.effects.effects import Effects
from softhand_sim.elements import ELEMENTS
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.system import PneumaticSystem

_INDEX = ELEMENTS.index("index")


def steps_report(calibration: FingerCalibration, effects: Effects, seeds: Sequence[int]) -> Report:
    """Run the step test and hold it against what the paper observed."""
    pneumatics, losses = _built(calibration, effects)
    study = steps.judge_steps(list(steps.run_steps(calibration, pneumatics, seeds, losses)), pneumatics)
    up, drift = study.upward, study.drift_pa.mean(axis=(0, 2))
    held = study.held_minus_set_pa[:, up]
    unseen = study.resolution_pa + 2.0 * study.noise_pa
    return Report(
        name="steps",
        figures=study.summary(),
        checks=(
            Check(name="held above the set value, way up", value=float(held.max()), limit=unseen, unit="Pa"),
            Check(
                name="held below it by more than a count and a pulse",
                value=float((-held - study.resolution_pa - study.pulse_pa[:, up]).max()),
                limit=0.0,
                unit="Pa",
            ),
            Check(name="drift after a step up (sag)", value=float(drift[up].max()), limit=0.0, unit="Pa"),
            Check(name="drift after a step down (creep), turned", value=-float(drift[3:5].min()), limit=0.0, unit="Pa"),
        ),
        panels=(_panel("Steps", study.records),),
        stated=steps.STATED,
    )


def hold_report(calibration: FingerCalibration, effects: Effects, seeds: Sequence[int]) -> Report:
    """Run the long hold."""
    pneumatics, losses = _built(calibration, effects)
    study = hold.judge_hold(list(hold.run_hold(calibration, pneumatics, seeds, losses)))
    return Report(
        name="hold",
        figures=study.summary(),
        checks=(
            Check(name="spread in a minute", value=float(study.spread_pa.max()), limit=hold.LIMIT_PA, unit="Pa"),
            Check(
                name="distance from the set value", value=float(study.largest_error_pa.max()), limit=hold.LIMIT_PA,
                unit="Pa",
            ),
        ),
        panels=(_panel("Long hold", study.records),),
        stated=hold.STATED,
    )  # fmt: skip


def leak_report(calibration: FingerCalibration, effects: Effects, seeds: Sequence[int]) -> Report:
    """Run the three cases of the leak test."""
    pneumatics, losses = _built(calibration, effects)
    studies = {
        case: leak.judge_leak(list(leak.run_leak(calibration, pneumatics, case, seeds, losses)), case)
        for case in leak.LeakCase
    }
    without, controlled, lost = studies.values()
    silent = sum(outcome is not ControlOutcome.SATURATED for outcome in lost.outcomes)
    return Report(
        name="leak",
        figures={str(case): study.summary() for case, study in studies.items()},
        checks=(
            Check(
                name="without control, pressure at the end", value=float(without.final_pa_gauge.max()),
                limit=leak.EMPTY_PA, unit="Pa",
            ),
            Check(
                name="with control, distance from 50 kPa", value=float(controlled.largest_error_pa.max()),
                limit=leak.BAND_PA, unit="Pa",
            ),
            Check(
                name="larger than the inlet, repeats that do not say they are saturated", value=float(silent),
                limit=0.0, unit="repeats",
            ),
        ),
        panels=tuple(_panel(f"Leak, {case.replace('_', ' ')}", study.records) for case, study in studies.items()),
        stated=leak.STATED,
    )  # fmt: skip


PRESSURE_STUDIES: dict[str, Callable[[FingerCalibration, Effects, Sequence[int]], Report]] = {
    "steps": steps_report,
    "hold": hold_report,
    "leak": leak_report,
}
"""The pressure tests by name; they need two seeds or more, and gas among the effects."""


def _built(calibration: FingerCalibration, effects: Effects) -> tuple[PneumaticSystem, Losses]:
    pneumatics = build_pneumatics(effects, calibration)
    if pneumatics is None:
        raise ValueError("effects: gas is None; a pressure test needs gas dynamics")
    return pneumatics, build_losses(effects, calibration)


def _panel(title: str, records: Sequence[PressureRecord]) -> Panel:
    """Return mean and set pressure of the index finger over time, with its 95 % band."""
    first = records[0]
    band = confidence_band(np.stack([record.pressure_pa_gauge[:, _INDEX] for record in records]) / 1e3)
    time = first.time_s.tolist()
    return Panel(
        title=title,
        x_label="time / s",
        y_label="pressure of the index / kPa gauge",
        curves=(
            Curve(source=Source.SURROGATE, x=time, y=band.mean.tolist(), half_width=band.half_width.tolist()),
            Curve(source=Source.COMMAND, x=time, y=(first.set_pa_gauge / 1e3).tolist()),
        ),
    )
