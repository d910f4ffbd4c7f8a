"""What leaving each effect out changes in grasps: tip angle, slip and verdict, measured by running both."""

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np
from tqdm import tqdm

from scripts import _cli
from softhand_sim.calibration import load_calibration
from softhand_sim.effects import PRESETS
from softhand_sim.effects.auto import choose
from softhand_sim.effects.omission import Omission, grasp, omission, without_each
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.objects.catalogue import make_object

EXAMPLES = """examples:
  effects_table.py --json out/effects.json
  effects_table.py --objects apple,mug --trials 10 --effects bench
  effects_table.py --objects banana,mug --seed 100 --auto --angle 12 --slip 20
"""
DEFAULT_OBJECTS = "apple,tennis_ball,mug"


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default=DEFAULT_OBJECTS, help=f"catalogue names (default {DEFAULT_OBJECTS})")
    p.add_argument("--trials", type=_cli.positive_int, default=3, help="trials an object (default 3)")
    p.add_argument("--effects", choices=[k for k in PRESETS if k != "ideal"], default="full", help="default full")
    p.add_argument("--auto", action="store_true", help="compare what each scene chooses instead of single omissions")
    p.add_argument("--angle", type=_cli.non_negative_float, default=12.0, help="tolerance of --auto [deg] (12)")
    p.add_argument("--slip", type=_cli.non_negative_float, default=20.0, help="tolerance of --auto [mm] (20)")
    p.add_common(seed="of the first trial", json="write every comparison to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    calibration, everything = load_calibration(), PRESETS[args.effects]
    models = [make_object(name) for name in args.objects.split(",")]
    scenes = [(model, args.seed + k) for model in models for k in range(args.trials)]
    rows: list[dict[str, object]] = []
    found: dict[str, list[Omission]] = {}
    with tqdm(total=len(scenes), disable=None, unit="scene") as bar:
        for model, seed in scenes:
            variants = without_each(everything)
            if args.auto:
                tolerance = Tolerance(angle_deg=args.angle, slip_m=1e-3 * args.slip)
                variants = {"auto": choose(SceneFacts.of(model, calibration, everything), tolerance)[0]}
            full = grasp(model, calibration, everything, seed)
            for name, effects in variants.items():
                change = omission(name, full, grasp(model, calibration, effects, seed))
                found.setdefault(name, []).append(change)
                kept = list(effects.present)
                rows.append({"object": model.name, "seed": seed, "effects_kept": kept, **asdict(change)})
            bar.update()
    print(f"{len(scenes)} grasps with {args.effects}: {', '.join(everything.present)}")
    head = (
        ("angle deg, median", 18),
        ("largest", 9),
        ("slip mm, median", 17),
        ("largest", 9),
        ("other verdict", 15),
        ("time", 7),
    )
    print(f"{'left out':<18}" + "".join(f"{text:>{width}}" for text, width in head))
    for name, changes in found.items():
        # where the verdict changes the object is lost, and the other figures mean nothing
        same = [c for c in changes if c.same_outcome]
        angle = np.array([c.angle_deg for c in same] or [np.nan])
        slip = 1e3 * np.array([c.slip_m for c in same] or [np.nan])
        print(
            f"{name:<18}{np.median(angle):>18.2f}{angle.max():>9.2f}{np.median(slip):>17.2f}{slip.max():>9.2f}"
            f"{len(changes) - len(same):>11} of {len(changes):<2}{np.median([c.time_ratio for c in changes]):>7.2f}"
        )
    if args.json is not None:
        data = {"preset": args.effects, "seed": args.seed, "trials": args.trials, "comparisons": rows}
        _cli.write_json(args.json, data)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
