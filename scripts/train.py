"""Train a policy that reaches and closes from what the hand's sensors say (extra `learn`).

Writes the policy (weights and plain values alone), and the learning curve as JSON and as a picture. It runs by
``grasp_benchmark.py --policy FILE`` in every protocol, without any learning library; ``evaluate_policy.py`` compares it
with the scripted grasp.
"""

import importlib.util
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from scripts import _cli
from scripts._learning import LearningConfig, load_config
from softhand_sim.policy.policy_file import dump_policy

EXAMPLES = """examples:
  train.py --seed 0 --out out/reach-0.npz --json out/reach-0.json
  train.py --config mine.toml --episodes 5000 --out out/mine.npz
"""
MISSING = "train.py needs the extra 'learn': see docs/learning.md for the line that installs it"


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--config", type=Path, metavar="TOML", help="settings (default assets/policies/reach.toml)")
    p.add_argument("--out", type=Path, metavar="NPZ", required=True, help="the policy; its curve goes beside it as PNG")
    p.add_argument("--episodes", type=_cli.positive_int, help="in the place of the configuration's")
    p.add_argument("--workers", type=_cli.positive_int, help="in the place of the configuration's")
    p.add_common(seed="of networks, actions and episodes", json="write the learning curve to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    _cli.check_writable(args.out, "--out")
    given = {name: getattr(args, name) for name in ("episodes", "workers") if getattr(args, name) is not None}
    config = replace(load_config(args.config), **given)
    if any(importlib.util.find_spec(name) is None for name in ("stable_baselines3", "torch")):
        raise ValueError(MISSING)
    from scripts._ppo import train  # noqa: PLC0415 - an extra

    policy, curve = train(config, args.seed)
    _cli.write_bytes(args.out, dump_policy(policy))
    last = curve.rows[-1]
    print(
        f"{last['episodes']} episodes in {last['wall_s']:.0f} s; "
        f"{last['steady']:.2f} lifted steadily in the last update"
    )
    print(f"policy: {args.out}")
    if args.json is not None:
        _cli.write_json(args.json, {"seed": args.seed, "about": policy.about, "curve": curve.rows})
    _draw(args.out.with_suffix(".png"), curve.rows, config)
    return 0


def _draw(path: Path, rows: list[dict[str, Any]], config: LearningConfig) -> None:
    """Draw the curve, if matplotlib (extra `plots`) is there."""
    if importlib.util.find_spec("matplotlib") is None:
        print("no curve: needs the extra 'plots'")
        return
    from matplotlib.figure import Figure  # noqa: PLC0415 - an extra

    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    axes = figure.subplots()
    episodes = [row["episodes"] for row in rows]
    for name in config.objects:
        points = [(e, r["steady_by_object"][name]) for e, r in zip(episodes, rows, strict=True) if name in
                  r["steady_by_object"]]  # fmt: skip
        axes.plot(*zip(*points, strict=True), lw=0.8, alpha=0.6, label=name)
    axes.plot(episodes, [row["steady"] for row in rows], "k", lw=2.0, label="all")
    axes.set(xlabel="episodes", ylabel="share lifted steadily, with exploration", ylim=(0.0, 1.0))
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=120)
    print(f"curve: {path}")


if __name__ == "__main__":
    raise SystemExit(main())
