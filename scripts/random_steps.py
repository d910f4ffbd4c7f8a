"""Random actions by the million: nothing may become NaN or leave its space, and memory must stay flat.

The steps are shared out over both environments and all their action and observation modes, with all randomisations and
all effects in turn, and over vector environments of two objects or two fingers. Engine warnings, and how
the guards see each episode at its end, are counted by name; memory is the process's own, resident. With ``--json`` the
figures so far are written after every case, and say whether the run is complete.
"""

import itertools
import os
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from tqdm import tqdm

import envs
from assets import asset_path
from scripts import _cli

EXAMPLES = """examples:
  random_steps.py --steps 1000000 --json out/random.json
  random_steps.py --steps 3600 --objects apple
  random_steps.py --steps 1000000 --period 0.02 --json out/random.json      # single ticks of the controller
"""
OBJECTS = "apple,lemon,mug,soup_can,banana"
EPISODE_STEPS, WORLDS = 250, 4
SHORT_EPISODE_STEPS = 25
"""Choice: of vectors, whose idle worlds gather with every reset until there are as many as can be wanted at once."""
LEAK_BYTES = 64 << 20
"""Choice: growth from the first half's end that is called a leak; allocators keep some megabytes back."""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--steps", type=_cli.positive_int, default=1_000_000, help="in all (default %(default)s)")
    p.add_argument("--objects", default=OBJECTS, help="catalogue names of the grasps (default %(default)s)")
    text = "time of a step in s, a multiple of 0.02 (default %(default)s)"
    p.add_argument("--period", type=_cli.positive_float, default=0.04, metavar="S", help=text)
    p.add_common(seed="seed of episodes and actions", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    cases = list(_cases(tuple(args.objects.split(","))))
    share = -(-args.steps // (2 * len(cases)))
    made: dict[int, Any] = {}
    counts: Counter[str] = Counter()
    memory: list[int] = []
    # every case twice: what is still growing in the second half is a leak
    with tqdm(total=2 * len(cases) * share, desc="steps", unit="step", disable=None) as bar:
        for half, (k, (env_id, given)) in itertools.product(range(2), enumerate(cases)):
            if k not in made:
                many, period = "num_envs" in given, {"control_period_s": args.period}
                make, length = (gymnasium.make_vec, SHORT_EPISODE_STEPS) if many else (gymnasium.make, EPISODE_STEPS)
                made[k] = make(env_id, max_episode_steps=length, **given, **period)
            run = _run_vector if "num_envs" in given else _run
            run(made[k], share, args.seed + 2 * k + half, counts)
            memory.append(_resident_bytes())
            bar.update(share)
            if args.json is not None:
                _cli.write_json(args.json, _figures(counts, memory, len(cases), args.period))
    data = _figures(counts, memory, len(cases), args.period)
    grown = data["grown_bytes"]
    print(f"{data['steps']} steps in {len(cases)} cases: {data['counts']}")
    print(f"memory: {memory[len(cases) - 1] >> 20} MiB after the first half, {memory[-1] >> 20} MiB at the end")
    bad = counts["not finite or outside the space"] > 0 or grown > LEAK_BYTES
    return _cli.INCOMPLETE if bad else 0


def _figures(counts: Counter[str], memory: list[int], cases: int, period_s: float) -> dict[str, Any]:
    """Return the figures so far, JSON-ready."""
    return {
        "complete": len(memory) == 2 * cases,
        "steps": counts["steps"],
        "step_s": period_s,
        "processor_s": time.process_time(),
        "cases": cases,
        "cases_run_twice": max(0, len(memory) - cases),
        "counts": {name: int(n) for name, n in counts.items() if name != "steps"},
        "grown_bytes": memory[-1] - memory[cases - 1] if len(memory) > cases else 0,
        "resident_bytes_after_each_case": memory,
    }


def _cases(objects: tuple[str, ...]) -> list[tuple[str, dict[str, Any]]]:
    modes = itertools.product(("pressure", "angle", "valve"), (True, False), ("hardware", "state", "goal"))
    cases = []
    for k, (action, wrist, seen) in enumerate(modes):
        given = {"action_mode": action, "wrist": wrist, "observation_mode": seen, "randomization": "domain"}
        effects = ("bench", "full")[k % 2]
        cases.append((envs.GRASP_ENV_ID, {**given, "effects": effects, "objects": objects[k % len(objects)]}))
        cases.append((envs.REORIENT_ENV_ID, {**given, "effects": effects}))
    # two kinds of worlds a vector: all that are wanted at once are made in the first half, what grows then is a leak
    fingers = [None, str(asset_path("calibration/ensemble/actuator-wall-minus.json"))]
    shared = {"num_envs": WORLDS, "threads": 2, "randomization": "domain"}
    cases += [
        (envs.GRASP_ENV_ID, {**shared, "action_mode": "pressure", "effects": "full", "objects": objects[:2]}),
        (envs.GRASP_ENV_ID, {**shared, "action_mode": "valve", "objects": objects[-1], "calibrations": fingers}),
        (envs.REORIENT_ENV_ID, {**shared, "action_mode": "pressure", "effects": "full", "calibrations": fingers}),
        (envs.REORIENT_ENV_ID, {**shared, "action_mode": "valve", "effects": "bench"}),
    ]
    return cases


def _run(env: Any, steps: int, seed: int, counts: Counter[str]) -> None:
    env.action_space.seed(seed)
    env.reset(seed=seed)
    for _ in range(steps):
        seen, reward, terminated, truncated, info = env.step(env.action_space.sample())
        counts["steps"] += 1
        if not (np.isfinite(reward) and env.observation_space.contains(seen)):
            counts["not finite or outside the space"] += 1
        if terminated or truncated:
            counts["episodes"] += 1
            counts[info["outcome"] or "NO ALARM"] += 1
            counts.update(info["engine_warnings"])
            env.reset()


def _run_vector(env: Any, steps: int, seed: int, counts: Counter[str]) -> None:
    """Take steps of all worlds together, at least so many."""
    env.action_space.seed(seed)
    env.reset(seed=seed)
    for _ in range(-(-steps // env.num_envs)):
        seen, rewards, terminated, truncated, infos = env.step(env.action_space.sample())
        counts["steps"] += env.num_envs
        if not (np.isfinite(rewards).all() and env.observation_space.contains(seen)):
            counts["not finite or outside the space"] += 1
        for k in np.flatnonzero(terminated | truncated):
            counts["episodes"] += 1
            counts[infos["outcome"][k] or "NO ALARM"] += 1
            counts.update({name: int(n[k]) for name, n in infos["engine_warnings"].items() if name[0] != "_"})


def _resident_bytes() -> int:
    """Return the memory that the process holds at present; 0 where the system does not tell."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if statm.exists() else 0


if __name__ == "__main__":
    raise SystemExit(main())
