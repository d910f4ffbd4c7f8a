"""Learned policies beside the scripted grasp in the same scenes: training objects, unseen objects, intervals.

Every policy and the script run the same trials of a protocol, the same displacements of the objects included, whose
seeds no training has seen. Training and unseen objects are counted apart, with 95 % Wilson intervals.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tqdm import tqdm

from scripts import _cli
from scripts._learning import LearningConfig, load_config
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.report import summarise, wilson_interval
from softhand_sim.benchmark.runner import in_order, run_benchmark
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object
from softhand_sim.policy.policy_file import Policy, load_policy

EXAMPLES = """examples:
  evaluate_policy.py --policy out/reach-0.npz out/reach-1.npz --json out/evaluation.json
  evaluate_policy.py --policy mine.npz --protocol paper --trials 20
  evaluate_policy.py --policy mine.npz --deeper 30 50    # the script, pushed on by 30 and 50 mm, beside them
"""
SCRIPT = "script"


@dataclass(frozen=True, kw_only=True)
class Count:
    """Trials held of so many, and the 95 % Wilson interval of the rate."""

    held: int
    trials: int

    @classmethod
    def of(cls, results: Sequence[TrialResult]) -> "Count":
        """Count results."""
        return cls(held=sum(r.outcome is Outcome.HELD for r in results), trials=len(results))

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper end."""
        return wilson_interval(self.held, self.trials)

    def data(self) -> dict[str, float]:
        """Return it JSON-ready."""
        low, high = self.interval
        rate = self.held / self.trials
        return {"held": self.held, "trials": self.trials, "rate": rate, "wilson_low": low, "wilson_high": high}


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--policy", type=Path, nargs="+", default=[], metavar="NPZ", help="policies to evaluate")
    p.add_argument("--config", type=Path, metavar="TOML", help="objects and protocol (default: the shipped one)")
    p.add_argument("--protocol", help="in the place of the configuration's")
    p.add_argument("--trials", type=_cli.positive_int, help="an object, in the place of the configuration's")
    p.add_argument("--seen-only", action="store_true", help="leave the unseen objects out")
    text = "scripts that push on by so many millimetres along the approach, for comparison"
    p.add_argument("--deeper", type=_cli.positive_float, nargs="+", default=[], metavar="MM", help=text)
    p.add_argument("--workers", type=_cli.positive_int, default=1, help="processes side by side (default 1)")
    p.add_common(seed="added to that of the first trial", json="write counts and every object's rate to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    config = load_config(args.config)
    ways: dict[str, Policy | float | None] = {SCRIPT: None}
    ways |= {f"script {mm:g} mm deeper": 1e-3 * mm for mm in args.deeper}
    ways |= {str(path): load_policy(path) for path in args.policy}
    protocol = load_protocol(args.protocol or config.evaluation.protocol)
    names = config.objects if args.seen_only else (*config.objects, *config.unseen)
    data: dict[str, Any] = {"protocol": protocol.name, "ways": {}}
    for name, way in ways.items():
        plan = _plan(config, names, way, args)
        running = run_benchmark(plan, args.workers)
        total = len(names) * plan.trials
        results = in_order(plan, list(tqdm(running, total=total, desc=name, unit="trial", disable=None)))
        data["ways"][name] = _figures(config, results)
        _tell(name, data["ways"][name])
    if args.json is not None:
        _cli.write_json(args.json, data)
    return 0


def _plan(config: LearningConfig, names: Sequence[str], way: Policy | float | None, args: Any) -> BenchmarkPlan:
    objects = tuple(make_object(name) for name in names)
    plain = BenchmarkPlan(
        objects=objects,
        trials=args.trials or config.evaluation.trials,
        seed=config.evaluation.first_seed + args.seed,
        protocol=load_protocol(args.protocol or config.evaluation.protocol),
        policy=way if isinstance(way, Policy) else None,
    )
    if not isinstance(way, float):
        return plain
    return replace(plain, grasps={model.name: _deeper(plain.grasp(model), way) for model in objects})


def _deeper(grasp: GraspPlan, by_m: float) -> GraspPlan:
    """Return a grasp that goes on along its approach."""
    return replace(grasp, wrist_pose=tuple(float(v) for v in grasp.standoff(-by_m)))


def _figures(config: LearningConfig, results: Sequence[TrialResult]) -> dict[str, Any]:
    groups = {"training": config.objects, "unseen": config.unseen}
    counts = {g: Count.of(own) for g, n in groups.items() if (own := [r for r in results if r.object in n])}
    return {**{group: count.data() for group, count in counts.items()}, "objects": summarise(results)}


def _tell(name: str, figures: dict[str, Any]) -> None:
    for group in ("training", "unseen"):
        if group in figures:
            f = figures[group]
            interval = f"{f['wilson_low']:.2f} - {f['wilson_high']:.2f}"
            print(f"{name}: {group} objects {f['held']} of {f['trials']} held, {f['rate']:.2f} ({interval})")
    print("  " + ", ".join(f"{n} {row['success_rate']:.2f}" for n, row in figures["objects"].items()), flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
