"""Which effects a scene calls for, why, and what leaving each out would change at most."""

import math
from collections.abc import Sequence

from scripts import _cli
from scripts._tolerance import tell_picked
from softhand_sim.calibration import load_calibration
from softhand_sim.effects import PRESETS
from softhand_sim.effects.auto import Answer, choose
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity
from softhand_sim.grasp.trial import facts_of
from softhand_sim.objects.catalogue import make_object

EXAMPLES = """examples:
  explain_scene.py --objects apple --json out/scene.json
  explain_scene.py --objects apple,mug --angle 12 --slip 20 --without gravity
  explain_scene.py --objects apple --angle 5 --slip 10 --effects-alone
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default="apple", help="catalogue names (default apple)")
    p.add_argument("--effects", choices=[k for k in PRESETS if k != "ideal"], default="full", help="what is asked")
    p.add_argument("--angle", type=_cli.non_negative_float, default=15.0, help="tolerance of tip angles [deg] (15)")
    p.add_argument("--slip", type=_cli.non_negative_float, default=25.0, help="tolerance of slip [mm] (25)")
    text = "all of the tolerance is for the effects, at a time step of one's own; else half of it is for the step"
    p.add_argument("--effects-alone", action="store_true", help=text)
    p.add_argument("--with", dest="stay", nargs="+", default=[], metavar="EFFECT", help="effects that are to stay")
    p.add_argument("--without", dest="go", nargs="+", default=[], metavar="EFFECT", help="effects that are to go")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the table to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    tolerance = Tolerance(angle_deg=args.angle, slip_m=1e-3 * args.slip)
    force = dict.fromkeys(args.stay, True) | dict.fromkeys(args.go, False)
    fidelity = Fidelity() if args.effects_alone else Fidelity.within(tolerance, effects_too=True)
    of_effects = fidelity.auto_effects or tolerance
    calibration, models = load_calibration(), [make_object(name) for name in args.objects.split(",")]
    scenes = []
    for model in models:
        _, answers = choose(facts_of(model, calibration, PRESETS[args.effects]), of_effects, force)
        of = f"{of_effects.angle_deg:g} degrees, {1e3 * of_effects.slip_m:g} mm for the effects"
        print(f"{model.name}: tolerance {args.angle:g} degrees, {args.slip:g} mm; {of}")
        print(f"  {'effect':<14}{'stays':<7}{'error deg':>10}{'error mm':>10}   reason")
        for a in answers:
            error = f"{a.omission_error_deg:>10.1f}{1e3 * a.omission_error_m:>10.1f}"
            print(f"  {a.name:<14}{'yes' if a.active else 'no':<7}{error}   {a.reason}")
        scenes.append({"object": model.name, "effects": [_row(a) for a in answers]})
    tell_picked(fidelity)
    if args.json is not None:
        data = {"tolerance_angle_deg": args.angle, "tolerance_slip_m": tolerance.slip_m, "scenes": scenes}
        data["fidelity"] = fidelity.data()
        _cli.write_json(args.json, data | ({"effects": scenes[0]["effects"]} if len(scenes) == 1 else {}))
    return 0


def _row(answer: Answer) -> dict[str, object]:
    """Return an answer for JSON; an error that cannot be told is null."""
    known = math.isfinite(answer.omission_error_deg)
    return {
        "name": answer.name,
        "active": answer.active,
        "reason": answer.reason,
        "omission_error": answer.omission_error_deg if known else None,
        "omission_error_deg": answer.omission_error_deg if known else None,
        "omission_error_m": answer.omission_error_m if known else None,
    }


if __name__ == "__main__":
    raise SystemExit(main())
