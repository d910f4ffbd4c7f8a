"""What a step of an environment costs beside the engine's steps within it, and how fast simulated time goes by.

For each scene, every action is timed in the environment, and then the bare engine takes the same number of steps from
the same state, with nothing around it; one after the other within one run. Times are those of the processor, so that
other work on the machine disturbs them less. Then a vector environment takes turns with one environment and with a bare
batch of the engine from the same states with the same commands, by the clock. Last, free-running environments of each
scene, single and vector, take turns under random actions, the first also at a trial's 2 ms, and, where
gymnasium-robotics is installed, its hand with a ball on a table.
"""

import os
import time
from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import mujoco
import mujoco.batch
import numpy as np
import numpy.typing as npt
from tqdm import tqdm

import envs
from scripts import _cli
from scripts._env_rates import SCENES, free_running, tell

EXAMPLES = """examples:
  benchmark_env.py --json out/env.json
  benchmark_env.py --steps 1000 --effects full
  benchmark_env.py --steps 100 --seconds 2
  benchmark_env.py --steps 100 --worlds 0 --seconds 10      # single environments alone
"""
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
Vector = npt.NDArray[Any]


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--steps", type=_cli.positive_int, default=500, help="actions a scene (default %(default)s)")
    p.add_argument("--effects", choices=["ideal", "bench", "full"], default="bench", help="(default %(default)s)")
    p.add_argument("--mode", choices=["hardware", "state", "goal"], default="state", help="observed (%(default)s)")
    text = "time by the clock for each free-running environment, in five turns; 0 for none (default %(default)s)"
    p.add_argument("--worlds", type=_cli.non_negative_int, default=16, help="of the vector; 0 for none (%(default)s)")
    p.add_argument("--threads", type=_cli.positive_int, default=2, help="of the vector (default %(default)s)")
    p.add_argument("--turns", type=_cli.positive_int, default=100, help="of the vector, an action each (%(default)s)")
    p.add_argument("--seconds", type=_cli.non_negative_float, default=10.0, help=text)
    p.add_common(seed="seed of episodes", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    made = {
        name: gymnasium.make(env_id, effects=args.effects, observation_mode=args.mode, **given)
        for name, (env_id, given) in SCENES.items()
    }
    rows = [
        _beside_engine(name, env, args.steps, args.seed)
        for name, env in tqdm(made.items(), desc="scenes", unit="scene", disable=None)
    ]
    print(f"{'scene':<14}{'action us':>11}{'engine us':>11}{'ratio':>8}   per step of the engine")
    for row in rows:
        us = 1e6 / row["engine_steps"]
        times = f"{us * row['env_processor_s']:>11.1f}{us * row['engine_processor_s']:>11.1f}"
        print(f"{row['scene']:<14}{times}{row['ratio']:>8.2f}")
    data: dict[str, Any] = {"effects": args.effects, "mode": args.mode, "steps": args.steps, "cpus": os.cpu_count()}
    data["scenes"] = rows
    if args.worlds > 0:
        data["vector"] = row = _vector(args)
        print(
            f"{row['worlds']} worlds, {row['threads']} threads: {row['vector']:.0f} actions a second, "
            f"{row['over_single']:.2f} of one environment's {row['single']:.0f}, {row['over_batch']:.2f} of the bare "
            f"batch's {row['batch']:.0f} ({row['over_batch_by_processor']:.2f} by processor time)"
        )
    if args.seconds > 0.0:
        data["free_running"] = free_running(
            {"effects": args.effects, "observation_mode": args.mode},
            worlds=args.worlds, threads=args.threads, seconds=args.seconds, seed=args.seed,
        )  # fmt: skip
        tell(data["free_running"])
    for env in made.values():
        env.close()
    if args.json is not None:
        _cli.write_json(args.json, data)
    return 0


def _beside_engine(name: str, env: Any, steps: int, seed: int) -> dict[str, Any]:
    """Time actions, and the engine from the same states."""
    raw = env.unwrapped
    spent, done, engine_steps = {"env": 0.0, "engine": 0.0}, True, 0
    actions = _actions(raw, steps, seed)
    # the first step compiles
    env.reset(seed=seed)
    env.step(actions[0])
    for k in range(steps):
        if done:
            env.reset(seed=seed + k)
            simulation = raw.episode.here.simulation
            state = np.empty(mujoco.mj_stateSize(simulation.model, _STATE))
            bare = mujoco.MjData(simulation.model)
        mujoco.mj_getState(simulation.model, simulation.data, state, _STATE)
        began = time.process_time()
        *_, terminated, truncated, _ = env.step(actions[k])
        spent["env"] += time.process_time() - began
        done = terminated or truncated
        count = raw.episode.substeps
        mujoco.mj_setState(simulation.model, bare, state, _STATE)
        bare.ctrl[:] = simulation.data.ctrl
        began = time.process_time()
        mujoco.mj_step(simulation.model, bare, count)
        spent["engine"] += time.process_time() - began
        engine_steps += count
    return {
        "scene": name,
        "engine_steps": engine_steps,
        "env_processor_s": spent["env"],
        "engine_processor_s": spent["engine"],
        "ratio": spent["env"] / spent["engine"],
    }


def _actions(env: Any, steps: int, seed: int) -> npt.NDArray[np.float32]:
    """Return set pressures that go up and down within episodes, (steps, a), so that hand and object touch."""
    rng = np.random.default_rng(seed)
    actions = np.zeros((steps, *env.action_space.shape), dtype=np.float32)
    # new set pressures every second, towards closing; the grasping wrist goes down for half a second of ten
    held = rng.uniform(0.2, 1.0, size=(steps // 25 + 1, 3))
    actions[:, :3] = np.repeat(held, 25, axis=0)[:steps]
    if actions.shape[1] > 3:
        actions[np.arange(steps) % 250 < 13, :3] = -1.0
        actions[np.arange(steps) % 250 < 13, 5] = -1.0
    return actions


def _vector(args: Any) -> dict[str, float]:
    """Return actions per second by the clock of a vector environment, of one environment, and of a batch alone."""
    given = {"effects": args.effects, "observation_mode": args.mode}
    vector: Any = gymnasium.make_vec(envs.GRASP_ENV_ID, num_envs=args.worlds, threads=args.threads, **given)
    single = gymnasium.make(envs.GRASP_ENV_ID, **given)
    n, inside = args.worlds, vector.unwrapped
    actions = _actions(single, args.turns + 1, args.seed)
    vector.reset(seed=args.seed)
    single.reset(seed=args.seed)
    episode = single.unwrapped.episode  # type: ignore[attr-defined]
    batch = mujoco.batch.Batch(episode.here.model, n, nthread=args.threads)
    ctrl = batch.bind("ctrl")
    ways: dict[str, Callable[[Vector], None]] = {
        "vector": lambda action: vector.step(np.tile(action, (n, 1))),
        "batch": lambda _: _step_batch(batch, episode.substeps),
        "single": lambda action: _step_single(single, action),
    }
    for way in ways.values():
        # the first step compiles
        way(actions[0])
    wall, processor = dict.fromkeys(ways, 0.0), dict.fromkeys(ways, 0.0)
    for action in tqdm(actions[1:], desc="vector", unit="turn", disable=None):
        before = inside.engine_state()
        for name, way in ways.items():
            if name == "batch":
                # the engine's work depends on contacts and commands: from where the vector was, with what it had
                batch.state[:] = before
                ctrl[:] = [each.here.simulation.data.ctrl for each in inside.episodes]
            began, began_processor = time.perf_counter(), time.process_time()
            way(action)
            wall[name] += time.perf_counter() - began
            processor[name] += time.process_time() - began_processor
    vector.close()
    rates = {name: (1 if name == "single" else n) * args.turns / wall[name] for name in ways}
    ratios = {f"over_{name}": rates["vector"] / rates[name] for name in ("single", "batch")}
    ratios["over_batch_by_processor"] = processor["batch"] / processor["vector"]
    return {"worlds": n, "threads": args.threads, **rates, **ratios}


def _step_batch(batch: mujoco.batch.Batch, steps: int) -> None:
    for _ in range(steps):
        batch.step()


def _step_single(env: Any, action: Vector) -> None:
    *_, terminated, truncated, _ = env.step(action)
    if terminated or truncated:
        env.reset()


if __name__ == "__main__":
    raise SystemExit(main())
