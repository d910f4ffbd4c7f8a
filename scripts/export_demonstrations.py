"""Demonstrations of the scripted grasp as a Minari data set, for imitation and offline learning (extra `minari`).

Each episode is one of ``SoftHandGrasp-v0``: the observations of the mode asked for, the script's actions, and the
rewards; those that end held have a last reward above 4. The set is written whole or not at all; Minari reads it where
MINARI_DATASETS_PATH names the folder.
"""

import importlib.util
import os
import shutil
import tempfile
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from tqdm import tqdm

import envs
from envs.randomization import Randomization
from envs.script import ScriptedGrasp
from scripts import _cli
from scripts._objects import catalogue_names
from softhand_sim.benchmark.report import wilson_interval

EXAMPLES = """examples:
  export_demonstrations.py --objects apple,mug --episodes 100 --out out/minari
  export_demonstrations.py --mode state --offset 0.03 --id softhand/displaced-v0 --out out/minari
  MINARI_DATASETS_PATH=out/minari python -c "import minari; print(minari.load_dataset('softhand/grasp-scripted-v0'))"
"""
MISSING = "export_demonstrations.py needs the extra 'minari': pip install 'softhand-sim[minari]'"


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--objects", default="apple,mug,lemon", help="catalogue names, or 'all' (default %(default)s)")
    p.add_argument("--episodes", type=_cli.positive_int, default=50, help="in all (default %(default)s)")
    p.add_argument("--mode", choices=["hardware", "state"], default="hardware", help="observed (default %(default)s)")
    text = "largest displacement of the object along x and along y in metres (default %(default)s)"
    p.add_argument("--offset", type=_cli.non_negative_float, default=0.010, metavar="M", help=text)
    p.add_argument("--id", default="softhand/grasp-scripted-v0", help="of the data set (default %(default)s)")
    p.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of data sets, made if missing")
    p.add_common(seed="of the first episode", json="write the number of episodes and successes to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    objects = catalogue_names(args.objects)
    ranges = Randomization(position_m=args.offset)
    target = args.out / args.id
    if target.exists():
        raise ValueError(f"--out {target}: exists already")
    if any(importlib.util.find_spec(name) is None for name in ("minari", "pyarrow", "jax")):
        raise ValueError(MISSING)
    made = gymnasium.make(envs.GRASP_ENV_ID, objects=objects, observation_mode=args.mode, randomization=ranges)
    args.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".partial-", dir=args.out) as partial:
        os.environ["MINARI_DATASETS_PATH"] = partial
        held = _write(made, args, f"{', '.join(objects)}; displaced by up to {1e3 * args.offset:g} mm; {args.mode}")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(Path(partial) / args.id, target)
    low, high = wilson_interval(held, args.episodes)
    print(f"{held} of {args.episodes} episodes held ({low:.2f} - {high:.2f}), written to {target}")
    if args.json is not None:
        _cli.write_json(args.json, {"episodes": args.episodes, "held": held, "seed": args.seed})
    return 0


def _write(made: Any, args: Any, description: str) -> int:
    """Collect the episodes and write the data set; return how many end held."""
    # in a function of its own: the collector removes its scratch folder when it goes
    import minari  # noqa: PLC0415 - an extra

    collector = minari.DataCollector(made, data_format="arrow")
    held = _collect(collector, args)
    with warnings.catch_warnings():
        # it asks for an author's address and for another environment to evaluate in
        warnings.filterwarnings("ignore", category=UserWarning, module="minari")
        collector.create_dataset(
            dataset_id=args.id,
            algorithm_name="scripted grasp of softhand-sim",
            description=description,
            requirements=["softhand-sim"],
        )
    collector.close()
    return held


def _collect(collector: Any, args: Any) -> int:
    """Run the episodes; return how many end held."""
    held = 0
    for k in tqdm(range(args.episodes), desc="episodes", unit="episode", disable=None):
        collector.reset(seed=args.seed + k)
        script, done, info = ScriptedGrasp(collector.unwrapped.episode), False, {"is_success": False}
        while not done:
            *_, terminated, truncated, info = collector.step(script.act().astype(np.float32))
            done = terminated or truncated
        held += info["is_success"]
    return held


if __name__ == "__main__":
    raise SystemExit(main())
