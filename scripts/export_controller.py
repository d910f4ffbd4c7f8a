"""The controller's table from angle to pressure, and its constants, as a C header for the microcontroller."""

from collections.abc import Sequence
from pathlib import Path

from scripts import _cli
from softhand_sim.calibration import load_calibration
from softhand_sim.control.c_header import c_header
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.table import AngleTable
from softhand_sim.elements import ELEMENTS
from softhand_sim.pneumatics.sensor import PressureSensor

EXAMPLES = """examples:
  export_controller.py --out out/softhand_controller.h
  export_controller.py --out out/softhand_controller.h --rows 20 --angles 60,95,80 --json out/controller.json
"""
TICK_S = 0.02  # the paper samples at 50 Hz


def _angles(text: str) -> list[float]:
    return [float(value) for value in text.split(",")]


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--out", type=Path, default=Path("out/softhand_controller.h"), help="header (default %(default)s)")
    p.add_argument("--rows", type=int, help="angles at equal distances (default: the calibration's own points)")
    p.add_argument("--angles", type=_angles, help="set angles of thumb, index, middle-ring-little [deg] to look up")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the table and set pressures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    _cli.check_writable(args.out, "--out")
    table = AngleTable.of(load_calibration(args.calibration), args.rows)
    sets = None if args.angles is None else dict(zip(ELEMENTS, table.pressures(args.angles), strict=True))
    text = c_header(table, OnOffController(), PressureSensor(), TICK_S)
    _cli.write_text(args.out, text)
    print(f"{args.out}: {len(table.angle_deg)} rows, {table.angle_deg[0]:.2f} to {table.angle_deg[-1]:.2f} degrees")
    for name, pressure in (sets or {}).items():
        print(f"{name}: {pressure / 1e3:.2f} kPa gauge")
    if args.json is not None:
        data = {
            "angle_deg": list(table.angle_deg),
            "pressure_pa_gauge": list(table.pressure_pa_gauge),
            "set_pressure_pa_gauge": sets,
            "header": str(args.out),
        }
        _cli.write_json(args.json, data)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
