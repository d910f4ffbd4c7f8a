"""Bench test: the work that the gas gives, the finger takes and friction keeps, over closed cycles of pressure."""

from dataclasses import dataclass, replace

import numpy as np

from softhand_sim.calibration import FingerCalibration, FingerEvidence, SlidingCalibration
from softhand_sim.characterize.bench import LOAD_RATE_N_PER_S, PRESSURE_RATE_PA_PER_S, Bench
from softhand_sim.characterize.report import Check, Report

CYCLE = ((0.0, 0.0), (60e3, 0.0), (60e3, 0.06), (30e3, 0.06), (30e3, 0.0), (0.0, 0.0))
"""Choice: pressure [Pa gauge] and tip load [N]; a cycle that lifts a load at high and lets it down at low pressure."""


@dataclass(frozen=True, kw_only=True)
class Work:
    """Works over a path [J]; what friction keeps is also given as its least value in a step.

    ``gas_j`` is the integral of p dV with the calibration's volume, ``mechanical_j`` that of the engine's pressure
    force along the elongation and of what the wall's bulging stores, ``moved_j`` the sum of the absolute works.
    """

    gas_j: float
    mechanical_j: float
    moved_j: float
    friction_j: float
    least_friction_j: float


def work_over(bench: Bench, path: tuple[tuple[float, float], ...]) -> Work:
    """Take a bench slowly along pressures and loads and add up the works, each step by the trapezoidal rule."""
    chamber, law = bench.calibration.chamber, bench.calibration.sliding
    states = []
    pressure, load = path[0]
    for end_pressure, end_load in path[1:]:
        time = max(abs(end_pressure - pressure) / PRESSURE_RATE_PA_PER_S, abs(end_load - load) / LOAD_RATE_N_PER_S)
        steps = int(np.ceil(time / bench.model.opt.timestep)) + 200
        for k in range(1, steps + 1):
            share = min(1.0, k / (steps - 200))
            p = pressure + share * (end_pressure - pressure)
            bench.step(p, load + share * (end_load - load))
            states.append((p, bench.elongation_m, bench.pressure_force_n, bench.loss_force_n))
        pressure, load = end_pressure, end_load
    p, delta, force, sliding = np.array(states).T
    volume = np.array([chamber.volume_m3_at(d) for d in delta]) + chamber.bulging_m3_per_pa * p
    gas = 0.5 * (p[1:] + p[:-1]) * np.diff(volume)
    stored = 0.5 * chamber.bulging_m3_per_pa * np.diff(p**2)
    mechanical = 0.5 * (force[1:] + force[:-1]) * np.diff(delta) + stored
    taken = -0.5 * (sliding[1:] + sliding[:-1]) * np.diff(delta)
    if law.coefficient_per_rad > 0.0:
        taken -= np.diff(sliding**2) / (2.0 * law.stiffness_n_per_m)
    return Work(
        gas_j=float(gas.sum()),
        mechanical_j=float(mechanical.sum()),
        moved_j=float(np.abs(gas).sum()),
        friction_j=float(taken.sum()),
        least_friction_j=float(taken.min()),
    )


def energy(calibration: FingerCalibration, _evidence: FingerEvidence | None = None) -> Report:
    """Balance a closed cycle without friction and one with it."""
    free = replace(calibration, sliding=SlidingCalibration(coefficient_per_rad=0.0, stiffness_n_per_m=0.0))
    without, rubbing = work_over(Bench(free), CYCLE), work_over(Bench(calibration), CYCLE)
    off = abs(without.gas_j - without.mechanical_j) / without.moved_j
    return Report(
        name="energy",
        figures={
            "gas_work_j": without.gas_j,
            "mechanical_work_j": without.mechanical_j,
            "gas_work_moved_j": without.moved_j,
            "gas_work_with_friction_j": rubbing.gas_j,
            "friction_work_j": rubbing.friction_j,
            "least_friction_work_in_a_step_j": rubbing.least_friction_j,
        },
        checks=(
            Check(name="gas work less mechanical work, closed cycle", value=off, limit=1e-6, unit="of the work moved"),
            Check(
                name="energy that friction gives in any step",
                value=max(0.0, -rubbing.least_friction_j) / rubbing.moved_j,
                limit=1e-12,
                unit="of the work moved",
            ),
        ),
    )
