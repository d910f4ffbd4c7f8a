"""The controller's table and constants as a C header for the microcontroller."""

from collections.abc import Iterable

from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.table import AngleTable
from softhand_sim.pneumatics.sensor import PressureSensor

_LOOK_UP = """\
/* Pressure [Pa gauge] for a bending angle [deg], linear between the rows; -1 outside the table. */
static inline float softhand_pressure_pa_gauge(float angle_deg)
{
    int k = 1;
    if (!(angle_deg >= SOFTHAND_ANGLE_DEG[0] && angle_deg <= SOFTHAND_ANGLE_DEG[SOFTHAND_TABLE_ROWS - 1]))
        return -1.0f;
    while (k < SOFTHAND_TABLE_ROWS - 1 && angle_deg > SOFTHAND_ANGLE_DEG[k])
        ++k;
    return SOFTHAND_PRESSURE_PA_GAUGE[k - 1]
        + (angle_deg - SOFTHAND_ANGLE_DEG[k - 1]) / (SOFTHAND_ANGLE_DEG[k] - SOFTHAND_ANGLE_DEG[k - 1])
        * (SOFTHAND_PRESSURE_PA_GAUGE[k] - SOFTHAND_PRESSURE_PA_GAUGE[k - 1]);
}
"""


def c_header(table: AngleTable, controller: OnOffController, sensor: PressureSensor, tick_s: float) -> str:
    """Return a self-contained C99 header; the same arguments give the same text.

    It holds the table in degrees and pascals, and each row's pressure in counts of the sensor's converter at the
    controller's ambient pressure, which is what the firmware compares its readings with.

    Raises
    ------
    ValueError
        If a row's pressure lies outside the sensor's range, or the tick is no whole number of milliseconds.
    """
    highest = controller.ambient_pa_abs + table.pressure_pa_gauge[-1]
    if not controller.ambient_pa_abs >= sensor.low_pa_abs or not highest <= sensor.high_pa_abs:
        raise ValueError(
            f"pressure_pa_gauge = {table.pressure_pa_gauge[-1]!r}: ambient and table must lie within the sensor's "
            f"{sensor.low_pa_abs:g} to {sensor.high_pa_abs:g} Pa absolute"
        )
    tick_ms = round(1e3 * tick_s)
    if tick_ms < 1 or abs(tick_ms - 1e3 * tick_s) > 1e-6:
        raise ValueError(f"tick_s = {tick_s!r}: must be a whole number of milliseconds, 1 or above")
    counts = [sensor.counts(sensor.voltage_v(controller.ambient_pa_abs + p)) for p in table.pressure_pa_gauge]
    constants = {
        "SOFTHAND_TABLE_ROWS": len(table.angle_deg),
        "SOFTHAND_TICK_MS": tick_ms,
        "SOFTHAND_MINIMUM_PULSE_TICKS": controller.minimum_pulse_ticks,
        "SOFTHAND_AMBIENT_COUNTS": sensor.counts(sensor.voltage_v(controller.ambient_pa_abs)),
        "SOFTHAND_DEAD_BAND_COUNTS": round(controller.dead_band_pa / sensor.resolution_pa),
    }
    lines = ["/* Written by scripts/export_controller.py; do not edit. */", "#ifndef SOFTHAND_CONTROLLER_H"]
    lines += ["#define SOFTHAND_CONTROLLER_H", "", "#include <stdint.h>", ""]
    lines += [f"#define {name} {value}" for name, value in constants.items()]
    floats = {"SOFTHAND_ANGLE_DEG": table.angle_deg, "SOFTHAND_PRESSURE_PA_GAUGE": table.pressure_pa_gauge}
    for name, values in floats.items():
        lines += _array("float", name, [f"{_rounded(value)}f" for value in values])
    lines += _array("uint16_t" if sensor.converter_bits <= 16 else "uint32_t", "SOFTHAND_SET_COUNTS", map(str, counts))
    return "\n".join([*lines, "", _LOOK_UP, "#endif"]) + "\n"


def _array(kind: str, name: str, values: Iterable[str]) -> list[str]:
    return ["", f"static const {kind} {name}[SOFTHAND_TABLE_ROWS] = {{", *(f"    {v}," for v in values), "};"]


def _rounded(value: float) -> str:
    """Return a number as C reads it, to the nine digits that fix a float."""
    text = f"{value:.9g}"
    return text if "." in text or "e" in text else f"{text}.0"
