"""Bench test: pressure up and down again; the loop of pressure and angle."""

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration, FingerEvidence
from softhand_sim.characterize.bench import Bench
from softhand_sim.characterize.report import Check, Curve, Panel, Report, Source

Vector = npt.NDArray[np.float64]
STATED = (
    "the angle at a given pressure differs between closing and opening: elastic hysteresis, and uneven slip of the "
    "actuator near the proximal joint while opening (Alves et al.); no width is stated",
)
AREA_LIMIT_PERCENT, CLOSED_LIMIT_DEG = 20.0, 0.1


def loop_area(pressure_pa_gauge: Vector, angle: Vector) -> float:
    """Return the area that a cycle encloses, positive where the way back has the larger angles (trapezoidal rule)."""
    return float(-np.trapezoid(angle, pressure_pa_gauge))


def hysteresis(calibration: FingerCalibration, evidence: FingerEvidence) -> Report:
    """Hold the loop of a pressure cycle against the finite elements' at the same pressures.

    Raises
    ------
    ValueError
        If the evidence is of another finger.
    """
    evidence.require_same_finger(calibration)
    seen = _seen(calibration, evidence)
    cycle, bench = evidence.cycle, Bench(calibration)
    readings = [bench.go_to(pressure) for pressure in cycle.pressure_pa_gauge]
    tip, pressure = np.array([reading.tip_angle_deg for reading in readings]), cycle.pressure_pa_gauge
    own, expected = loop_area(pressure, np.radians(tip)), loop_area(pressure, np.radians(cycle.tip_angle_deg))
    unseen = [loop_area(pressure[~seen], angle[~seen]) for angle in (tip, cycle.tip_angle_deg)]
    up = cycle.loading
    top = int(up.sum()) - 1
    # rows of equal pressure on both ways, from the top's neighbour down to zero
    back = np.arange(top - 1, -1, -1)
    width, fea_width = tip[top + 1 :] - tip[back], cycle.tip_angle_deg[top + 1 :] - cycle.tip_angle_deg[back]
    return Report(
        name="hysteresis",
        figures={
            "branch": list(cycle.branch),
            "pressure_pa_gauge": pressure.tolist(),
            "tip_angle_deg": tip.tolist(),
            "fea_tip_angle_deg": cycle.tip_angle_deg.tolist(),
            "loop_area_pa_rad": own,
            "fea_loop_area_pa_rad": expected,
            "largest_width_deg": float(width.max()),
            "fea_largest_width_deg": float(fea_width.max()),
        },
        checks=(
            Check(name="area of the loop", value=100.0 * abs(own / expected - 1.0), limit=AREA_LIMIT_PERCENT, unit="%"),
            Check(
                name="area of the loop, states that the fit did not see",
                value=100.0 * abs(unseen[0] / unseen[1] - 1.0),
                limit=AREA_LIMIT_PERCENT,
                unit="%",
            ),
            Check(
                name="angle left at zero pressure", value=abs(float(tip[-1])), limit=CLOSED_LIMIT_DEG, unit="degrees"
            ),
        ),
        panels=(
            _angles(pressure, cycle.tip_angle_deg, tip, seen, top),
            Panel(
                title="Width of the loop",
                x_label="pressure / kPa gauge",
                y_label="unloading minus loading / degrees",
                curves=(
                    *_dots(pressure[back], fea_width, seen[back] | seen[top + 1 :]),
                    Curve(source=Source.SURROGATE, x=(pressure[back] / 1e3).tolist(), y=width.tolist()),
                ),
            ),
        ),
        stated=STATED,
    )


def _seen(calibration: FingerCalibration, evidence: FingerEvidence) -> npt.NDArray[np.bool_]:
    """Return which rows of the evidence's cycle the identification saw in its own run, (n,)."""
    own = calibration.analysis
    rows = zip(own.branch, own.pressure_pa_gauge.tolist(), own.fitted or (), strict=False)
    fitted = {(branch, pressure) for branch, pressure, used in rows if used}
    cycle = evidence.cycle
    return np.array([row in fitted for row in zip(cycle.branch, cycle.pressure_pa_gauge.tolist(), strict=True)])


def _dots(pressure: Vector, value: Vector, seen: npt.NDArray[np.bool_]) -> tuple[Curve, ...]:
    groups = ((Source.FEA_FITTED, seen), (Source.FEA, ~seen))
    return tuple(Curve(source=s, x=(pressure[k] / 1e3).tolist(), y=value[k].tolist()) for s, k in groups if k.any())


def _angles(pressure: Vector, expected: Vector, tip: Vector, seen: npt.NDArray[np.bool_], top: int) -> Panel:
    ways = (slice(0, top + 1), slice(top, None))
    return Panel(
        title="Pressure cycle",
        x_label="pressure / kPa gauge",
        y_label="tip angle / degrees",
        curves=(
            *_dots(pressure, expected, seen),
            *(Curve(source=Source.SURROGATE, x=(pressure[w] / 1e3).tolist(), y=tip[w].tolist()) for w in ways),
        ),
    )
