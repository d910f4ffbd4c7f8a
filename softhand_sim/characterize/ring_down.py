"""Bench test: a load on the tip is let go, and the finger swings out."""

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from softhand_sim.calibration import FingerCalibration, FingerEvidence
from softhand_sim.characterize.bench import Bench
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source

Vector = npt.NDArray[np.float64]
LOAD_N, LONG_S = 0.01, 3.0
PRESSURES_PA_GAUGE = (0.0, 45e3)
LIMIT_PERCENT = 10.0
"""Choice: of decay rate and frequency from those of the linear finger; the swing is of some degrees."""


def ring_down(calibration: FingerCalibration, _evidence: FingerEvidence | None = None) -> Report:
    """Let a tip load go at rest and under pressure; hold the swing at rest against the finger's first mode."""
    rows = []
    for pressure in PRESSURES_PA_GAUGE:
        bench = Bench(calibration)
        still = bench.go_to(pressure).tip_angle_deg
        bent = bench.go_to(pressure, LOAD_N).tip_angle_deg
        time, angle = swing(bench, pressure)
        share = (angle - angle[-1]) / (bent - still)
        rows.append(
            {
                "pressure_pa_gauge": pressure,
                "released_deg": still - bent,
                "left_deg": float(angle[-1]) - still,
                "decay_time_s": _last_beyond(time, share, np.exp(-1.0)),
                "settling_time_s": _last_beyond(time, share, 0.05),
                "time_s": time,
                "share": share,
            }
        )
    rate, frequency = first_mode(calibration)
    swung = rows[0]
    shown = swung["time_s"] <= 1.5 * swung["settling_time_s"]
    found = _fit(swung["time_s"], swung["share"], rate, frequency)
    checks = tuple(
        Check(name=f"{name} of the swing, from the first mode", value=100.0 * off, limit=LIMIT_PERCENT, unit="%")
        for name, off in (("decay rate", abs(found[0] / rate - 1.0)), ("frequency", abs(found[1] / frequency - 1.0)))
    )
    figures = [{key: value for key, value in row.items() if key not in ("time_s", "share")} for row in rows]
    return Report(
        name="ring-down",
        figures={
            "load_n": LOAD_N,
            "swings": figures,
            "first_mode_decay_rate_per_s": rate,
            "first_mode_frequency_rad_per_s": frequency,
            "first_mode_damping_ratio": rate / float(np.hypot(rate, frequency)),
            "decay_rate_per_s": found[0],
            "frequency_rad_per_s": found[1],
        },
        checks=checks,
        panels=(
            Panel(
                title=f"{1e3 * LOAD_N:g} mN on the tip let go",
                x_label="time / s",
                y_label="tip angle, share of what was let go",
                curves=(
                    Curve(
                        source=Source.SURROGATE,
                        x=swung["time_s"][shown].tolist(),
                        y=swung["share"][shown].tolist(),
                        label="0 kPa",
                    ),
                ),
            ),
        ),
    )


def swing(bench: Bench, pressure_pa_gauge: float) -> tuple[Vector, Vector]:
    """Let the load go and return time [s] and tip angle [deg], (n,)."""
    start = bench.data.time
    rows = []
    while bench.data.time < start + LONG_S:
        bench.step(pressure_pa_gauge)
        rows.append((bench.data.time - start, float(np.degrees(bench.data.qpos[bench.qpos].sum()))))
    time, angle = np.array(rows).T
    return time, angle


def first_mode(calibration: FingerCalibration) -> tuple[float, float]:
    """Return decay rate [1/s] and frequency [rad/s] of the first mode of the straight finger without pressure.

    Eigenvalues of M q'' + C q' + K q = 0: the engine's inertia, the calibration's dashpots and springs.
    """
    bench, joints = Bench(calibration), calibration.joints
    inertia = np.empty((len(joints), len(joints)))
    for k, unit in enumerate(np.eye(len(joints))):
        column = np.empty(len(joints))
        mujoco.mj_mulM(bench.model, bench.data, column, unit)
        inertia[:, k] = column
    arm = np.array([joint.offset_m for joint in joints])
    springs = np.diag([joint.stiffness_n_m_per_rad for joint in joints])
    stiffness = springs + calibration.tendon.stiffness_n_per_m * np.outer(arm, arm)
    damping = np.diag([joint.damping_n_m_s_per_rad for joint in joints])
    inverse = np.linalg.inv(inertia)
    zero, one = np.zeros_like(inertia), np.eye(len(joints))
    values = np.linalg.eigvals(np.block([[zero, one], [-inverse @ stiffness, -inverse @ damping]]))
    slowest = values[np.abs(values).argmin()]
    return -float(slowest.real), float(abs(slowest.imag))


def _fit(time_s: Vector, share: Vector, rate: float, frequency: float) -> tuple[float, float]:
    """Return decay rate [1/s] and frequency [rad/s] of the swing once the faster modes are gone; least squares."""
    start = 4.0 / frequency
    late = (time_s >= start) & (time_s <= start + 3.0 / rate)
    t, y = time_s[late] - start, share[late]

    def error(x: Vector) -> Vector:
        return np.asarray(np.exp(-x[0] * t) * (x[1] * np.cos(x[3] * t) + x[2] * np.sin(x[3] * t)) - y)

    found = least_squares(error, [rate, float(y[0]), 0.0, frequency], x_scale=[rate, abs(y[0]), abs(y[0]), frequency])
    return float(found.x[0]), float(abs(found.x[3]))


def _last_beyond(time_s: Vector, share: Vector, bound: float) -> float:
    beyond = np.flatnonzero(np.abs(share) > bound)
    return float(time_s[beyond[-1]]) if len(beyond) else 0.0
