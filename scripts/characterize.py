"""Bench tests of the simulated finger: held against finite elements and against what the paper states."""

import argparse
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tqdm import tqdm

from scripts import _cli
from softhand_sim.calibration import FingerCalibration, FingerEvidence, load_calibration, load_evidence
from softhand_sim.characterize import STUDIES, Report
from softhand_sim.characterize.pictures import draw
from softhand_sim.characterize.pressure_reports import PRESSURE_STUDIES
from softhand_sim.characterize.pressure_sweep import PRESSURES_PA_GAUGE, pressure_angle_report
from softhand_sim.effects import PRESETS

EXAMPLES = """examples:
  characterize.py all --json out/fidelity.json --pictures out/fidelity
  characterize.py pressure-angle --pressures 10,37,75
  characterize.py steps --effects bench --repeats 3 --json out/steps.json --pictures out
  characterize.py tip-load --calibration my_finger.json --evidence my_evidence.json
Exit status 1 if a check does not hold.
"""
CHECK_FAILED = 1


def _pressures(text: str) -> list[float]:
    return [1e3 * float(value) for value in text.split(",")]


def _repeats(text: str) -> int:
    value = int(text)
    if value < 2:
        raise argparse.ArgumentTypeError(f"{text} must be 2 or more, for a band")
    return value


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    choices = [*STUDIES, *PRESSURE_STUDIES, "all"]
    p.add_argument("test", choices=choices, help=f"which bench test to run (all: {', '.join(STUDIES)})")
    p.add_argument("--repeats", type=_repeats, default=5, help="steps, hold, leak: repeats over seeds, 2 or more (5)")
    p.add_argument("--effects", choices=["bench", "full"], default="full", help="steps, hold, leak: preset (full)")
    default = ",".join(f"{1e-3 * p:g}" for p in PRESSURES_PA_GAUGE)
    p.add_argument("--pressures", type=_pressures, help=f"pressure-angle: kPa gauge of its table (default {default})")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_argument("--evidence", type=Path, help="what the finite elements show (default: the shipped file)")
    p.add_argument("--pictures", type=Path, metavar="FOLDER", help="draw one PNG a test into this folder")
    p.add_common(seed="steps, hold, leak: first seed of the sensors' noise", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    names = list(STUDIES) if args.test == "all" else [args.test]
    if args.pressures is not None and args.test != "pressure-angle":
        raise ValueError(f"--pressures: not an option of {args.test}")
    _cli.check_writable(args.json)
    if args.pictures is not None:
        _cli.check_writable(args.pictures / f"{names[0]}.png", "--pictures")
        if find_spec("matplotlib") is None:
            raise ValueError("--pictures: matplotlib is missing (pip install 'softhand-sim[plots]')")
    calibration, evidence = load_calibration(args.calibration), load_evidence(args.evidence)
    reports = [_run(name, calibration, evidence, args) for name in tqdm(names, unit="test", disable=None)]
    for report in reports:
        _print(report)
        if args.pictures is not None and report.panels:
            draw(report, args.pictures / f"{report.name}.png")
    if args.json is not None:
        data = {report.name: report.as_dict() for report in reports}
        _cli.write_json(args.json, data if args.test == "all" else data[args.test])
    return 0 if all(report.holds for report in reports) else CHECK_FAILED


def _run(name: str, calibration: FingerCalibration, evidence: FingerEvidence, args: argparse.Namespace) -> Report:
    if name in PRESSURE_STUDIES:
        seeds = range(args.seed, args.seed + args.repeats)
        return PRESSURE_STUDIES[name](calibration, PRESETS[args.effects], seeds)
    if args.pressures is not None:
        return pressure_angle_report(calibration, pressures_pa_gauge=args.pressures)
    return STUDIES[name](calibration, evidence)


def _print(report: Report) -> None:
    print(report.name)
    if report.name == "pressure-angle":
        _print_angles(report.figures)
    for check in report.checks:
        print(f"  {check}")
    for line in report.stated:
        print(f"  stated: {line}")


def _print_angles(figures: dict[str, Any]) -> None:
    print(f"{'kPa gauge':>10}{'tip deg':>9}{'calibration':>13}   proximal  middle  distal")
    keys = ("pressure_pa_gauge", "tip_angle_deg", "calibration_tip_angle_deg", "joint_angle_deg")
    for pressure, angle, curve, each in zip(*(figures[key] for key in keys), strict=True):
        print(f"{pressure / 1e3:>10.1f}{angle:>9.2f}{curve:>13.2f}   " + "  ".join(f"{x:>6.2f}" for x in each))
    for name, angles in figures["tip_angle_deg_at_75_kpa_with_gravity"].items():
        print(f"  75 kPa, {name}: " + ", ".join(f"{angle:.2f}" for angle in angles))


if __name__ == "__main__":
    raise SystemExit(main())
