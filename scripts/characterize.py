"""Bench tests of the simulated finger: joint and tip angles at rest against the calibration's own curve."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from scripts import _cli
from softhand_sim.calibration import load_calibration
from softhand_sim.characterize import pressure_angle
from softhand_sim.elements import FINGERS

EXAMPLES = """examples:
  characterize.py pressure-angle --json out/pressure_angle.json
  characterize.py pressure-angle --pressures 10,37,75
"""
DEFAULT_KPA = "0,10,20,30,40,50,60,70,75,80"
# all fingers are identical; the index stands for them
SHOWN = FINGERS.index("index")


def _pressures(text: str) -> list[float]:
    return [1e3 * float(value) for value in text.split(",")]


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("test", choices=["pressure-angle"], help="which bench test to run")
    p.add_argument("--pressures", type=_pressures, default=DEFAULT_KPA, help=f"kPa gauge (default {DEFAULT_KPA})")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    calibration = load_calibration(args.calibration)
    measured = pressure_angle(calibration, args.pressures)
    tip, joints = measured.tip_angle_deg[:, SHOWN], measured.joint_angle_deg[:, SHOWN]
    own = np.array([calibration.angle_for_pressure(p) for p in args.pressures])
    print(f"{'kPa gauge':>10}{'tip deg':>9}{'calibration':>13}   proximal  middle  distal")
    for pressure, angle, curve, each in zip(args.pressures, tip, own, joints, strict=True):
        print(f"{pressure / 1e3:>10.1f}{angle:>9.2f}{curve:>13.2f}   " + "  ".join(f"{x:>6.2f}" for x in each))
    if args.json is not None:
        data = {
            "pressure_pa_gauge": measured.pressure_pa_gauge.tolist(),
            "tip_angle_deg": tip.tolist(),
            "joint_angle_deg": joints.tolist(),
            "calibration_tip_angle_deg": own.tolist(),
            "tip_angle_spread_between_fingers_deg": float(np.ptp(measured.tip_angle_deg, axis=1).max()),
        }
        _cli.write_json(args.json, data)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
