"""What leaving effects out changes, measured by running both, against what was declared beforehand.

Scenes: grasps of catalogue objects, and bare hands that close to drawn angles and hold them. Each effect is left out by
itself; with --auto each scene leaves out what it does not call for, with --step it also has the longest time step of
the measured ones that is within the tolerance, against everything at the default one. Exit status 1 if a change is
larger than declared, or with --auto than the tolerance.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cache, partial
from typing import Any

import numpy as np
from tqdm import tqdm

from scripts import _cli
from scripts._effects_auto import Auto, Row, Variant, chosen, print_scenes
from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.effects import PRESETS, Effects
from softhand_sim.effects.auto import Answer, choose
from softhand_sim.effects.bare import BareHand
from softhand_sim.effects.omission import SCATTER, Omission, omission, run_bare, run_grasp, without_each
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.grasp.trial import TrialSetup, facts_of, prepare
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.model import ObjectModel

EXAMPLES = """examples:
  effects_table.py --json out/effects.json
  effects_table.py --objects apple,mug --trials 10 --bare 0 --effects bench
  effects_table.py --objects banana,mug --bare 10 --seed 100 --auto --angle 12 --slip 20
  effects_table.py --objects , --bare 10 --seed 300 --auto --effects-alone --angle 15 --slip 25
"""
DEFAULT_OBJECTS = "apple,tennis_ball,mug"
NOT_BOUNDED = 1
# wide enough for every estimate to count, and for the question whether a grasp bears a disturbance to be asked
_ANYTHING = Tolerance(angle_deg=1e3, slip_m=1e3)


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default=DEFAULT_OBJECTS, help=f"catalogue names (default {DEFAULT_OBJECTS})")
    p.add_argument("--trials", type=_cli.positive_int, default=3, help="trials an object (default 3)")
    p.add_argument("--bare", type=_cli.non_negative_int, default=3, help="scenes of a bare hand (default 3)")
    p.add_argument("--effects", choices=[k for k in PRESETS if k != "ideal"], default="full", help="default full")
    text = "compare what a tolerance chooses, half of it for the step, half for effects, instead of single omissions"
    p.add_argument("--auto", action="store_true", help=text)
    text = "with --auto, all of the tolerance is for the effects, at the default time step"
    p.add_argument("--effects-alone", action="store_true", help=text)
    p.add_argument("--angle", type=_cli.non_negative_float, default=12.0, help="tolerance of --auto [deg] (12)")
    p.add_argument("--slip", type=_cli.non_negative_float, default=20.0, help="tolerance of --auto [mm] (20)")
    p.add_common(seed="of the first trial, and of the bare hands' angles", json="write every comparison to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    everything = PRESETS[args.effects]
    auto = chosen(args)
    names = [name for name in args.objects.split(",") if name]
    calibration, rows = load_calibration(), []
    seeds = range(args.seed, args.seed + args.trials)
    rng = np.random.default_rng(args.seed)
    bare = [BareHand.draw(rng) for _ in range(args.bare)]
    models = [make_object(name) for name in names]
    warm = cache(partial(_warm_up, calibration))
    warm(everything)
    with tqdm(total=len(names) * args.trials + args.bare, disable=None, unit="scene") as bar:
        for model in models:
            setup = cache(partial(_setup, model, calibration))
            for seed in seeds:
                base = run_grasp(setup(everything, None), seed)
                # the scene is this very offset of the object
                variants = _variants(facts_of(model, calibration, everything, seeds=(seed,)), auto)
                for name, variant in variants.items():
                    warm(variant[0])
                    change = omission(
                        name, base, run_grasp(setup(variant[0], None if auto is None else auto.fidelity.engine), seed)
                    )
                    rows.append(_row(model.name, seed, variant, change))
                bar.update()
        for k, scene in enumerate(bare):
            rows += _bare_rows(scene, calibration, everything, auto, args.seed + k, warm)
            bar.update()
    if auto is None:
        _print(rows)
    else:
        print_scenes(rows, auto)
    if args.json is not None:
        listed = [_listed(row) for row in rows]
        data = {"preset": args.effects, "seed": args.seed, "trials": args.trials, "comparisons": listed}
        _cli.write_json(args.json, data | ({} if auto is None else {"fidelity": auto.fidelity.data()}))
    if auto is not None:
        return 0 if all(auto.kept(row) for row in rows) else NOT_BOUNDED
    return 0 if all(row.bounded for row in rows if row.change.effect != SCATTER) else NOT_BOUNDED


def _warm_up(calibration: FingerCalibration, effects: Effects) -> None:
    """Compile what a run with these effects needs, or load it, which is no part of its time."""
    run_bare(BareHand(set_angle_deg=(40.0, 40.0, 40.0), close_s=0.1, hold_s=0.1), calibration, effects, 0)


def _setup(
    model: ObjectModel, calibration: FingerCalibration, effects: Effects, engine: EngineSettings | None
) -> TrialSetup:
    return prepare(model, calibration, effects=effects, engine=engine)


def _variants(facts: SceneFacts, auto: Auto | None) -> Mapping[str, Variant]:
    if auto is not None:
        return {"auto": auto.variant(facts)}
    answers: dict[str, Answer] = {answer.name: answer for answer in choose(facts, _ANYTHING)[1]}
    declared = {name: (a.omission_error_deg, a.omission_error_m) for name, a in answers.items()}
    return {
        name: (effects, *declared.get(name, (np.inf, np.inf))) for name, effects in without_each(facts.offered).items()
    }


def _bare_rows(
    scene: BareHand, calibration: FingerCalibration, everything: Effects, auto: Auto | None, seed: int,
    warm: Callable[[Effects], None],
) -> Iterator[Row]:  # fmt: skip
    base, engine = run_bare(scene, calibration, everything, seed), None if auto is None else auto.fidelity.engine
    for name, variant in _variants(SceneFacts.bare(scene, calibration, everything), auto).items():
        warm(variant[0])
        change = omission(name, base, run_bare(scene, calibration, variant[0], seed, engine))
        yield _row("bare hand", seed, variant, change)


def _row(scene: str, seed: int, variant: Variant, change: Omission) -> Row:
    kept, angle, slip = variant
    return Row(scene=scene, seed=seed, effects_kept=kept.present, declared_deg=angle, declared_m=slip, change=change)


def _listed(row: Row) -> dict[str, object]:
    """Return a comparison for JSON; what is not declared is null."""
    out: dict[str, Any] = asdict(row)
    known = {name: out[name] if np.isfinite(out[name]) else None for name in ("declared_deg", "declared_m")}
    change: dict[str, Any] = out.pop("change")
    return {**out, **change, **known, "bounded": row.bounded}


def _print(rows: Sequence[Row]) -> None:
    """Print a line for each effect that was left out."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.change.effect, []).append(row)
    print(
        f"{'left out':<18}{'angle, median':>15}{'largest':>9}{'declared':>10}{'slip mm, largest':>18}{'declared':>10}"
        f"{'other verdict':>15}{'beyond':>8}{'time':>7}"
    )
    for name, group in groups.items():
        angle = np.array([row.change.angle_deg for row in group])
        slip = 1e3 * max(row.change.slip_m for row in group)
        errors = [(row.declared_deg, 1e3 * row.declared_m) for row in group]
        low, high = min(errors), max(errors)
        beyond = sum(not row.bounded for row in group)
        flips = sum(not row.change.same_outcome for row in group)
        ratio = np.median([row.change.time_ratio for row in group])
        print(
            f"{name:<18}{np.median(angle):>15.2f}{angle.max():>9.2f}{f'{low[0]:.0f}-{high[0]:.0f}':>10}{slip:>18.2f}"
            f"{f'{low[1]:.0f}-{high[1]:.0f}':>10}{flips:>9} of {len(group):<3}{beyond:>8}{ratio:>7.2f}"
        )


if __name__ == "__main__":
    raise SystemExit(main())
