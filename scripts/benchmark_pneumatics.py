"""What pneumatics and control add to the step of one hand that grasps an object.

The same stretches of a grasp are run twice in turn from the same state: with the gas and its controller, and with the
recorded pressures instead, all else alike (engine, wrist, the fingers' losses). Both come to the same state, which is
checked. Times are those of the processor, so that other work on the machine disturbs them less.
"""

import time
from collections.abc import Sequence

import mujoco
import numpy as np
from tqdm import tqdm

from scripts import _cli
from softhand_sim.calibration import load_calibration
from softhand_sim.effects import PRESETS
from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.trial import TrialSetup, prepare
from softhand_sim.objects.catalogue import make_object
from softhand_sim.simulation import HandSimulation

EXAMPLES = """examples:
  benchmark_pneumatics.py --json out/pneumatics_cost.json
  benchmark_pneumatics.py --effects bench --object mug --repeats 5
"""
STRETCH_STEPS = 100
# approach, closing, hold: without the lift, which is the hold moved
APPROACH_S, CLOSE_S, HOLD_S = 0.8, 2.5, 2.0


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--object", default="apple", help="catalogue name (default apple)")
    p.add_argument("--effects", nargs="+", choices=[k for k in PRESETS if k != "ideal"], default=["bench", "full"])
    p.add_argument("--repeats", type=_cli.positive_int, default=3, help="grasps per preset (default 3)")
    p.add_common(seed="of the sensors' noise", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    model, calibration = make_object(args.object), load_calibration()
    results: dict[str, object] = {}
    setups = {name: prepare(model, calibration, effects=PRESETS[name]) for name in args.effects}
    pairs: dict[str, list[tuple[float, float]]] = {name: [] for name in setups}
    total = args.repeats * len(setups)
    with tqdm(total=total, disable=None, unit="grasp") as bar:
        for repeat in range(args.repeats):
            for name, setup in setups.items():
                pairs[name] += _grasp(setup, args.seed + repeat)
                bar.update()
    print(f"{'effects':<8}{'step us':>11}{'with gas us':>13}{'added':>8}{'quartiles of the stretches':>30}")
    for name, times in pairs.items():
        alone, both = np.array(times).T
        added = float(both.sum() / alone.sum() - 1.0)
        quartiles = np.percentile(both / alone - 1.0, [25, 75])
        us = 1e6 / STRETCH_STEPS
        print(
            f"{name:<8}{alone.mean() * us:>11.1f}{both.mean() * us:>13.1f}{added:>8.1%}"
            f"{quartiles[0]:>20.1%} to {quartiles[1]:.1%}"
        )
        results[name] = {
            "step_s_without_pneumatics": float(alone.mean() / STRETCH_STEPS),
            "step_s": float(both.mean() / STRETCH_STEPS),
            "added_share": added,
            "added_share_quartiles": quartiles.tolist(),
            "stretches": len(times),
        }
    if args.json is not None:
        _cli.write_json(args.json, {"object": args.object, "seed": args.seed, "effects": results})
    return 0


def _grasp(setup: TrialSetup, seed: int) -> list[tuple[float, float]]:
    """Return the times [s] of every stretch of one grasp: engine alone, and with pneumatics."""
    simulation = HandSimulation(
        model=setup.scene.model, calibration=setup.calibration, pneumatics=setup.pneumatics, losses=setup.losses
    )
    simulation.reset(np.random.default_rng(seed), setup.plan.standoff(setup.protocol.approach_m))
    place_object(simulation, setup.model.rest_height_m, (0.0, 0.0, 0.0))
    simulation.wrist_target = setup.plan.standoff(0.0)
    sets = np.array([setup.calibration.closing_pressure(angle) for angle in setup.plan.set_angle_deg])
    times: list[tuple[float, float]] = []
    for k in range(round((APPROACH_S + CLOSE_S + HOLD_S) / (STRETCH_STEPS * simulation.dt))):
        if k * STRETCH_STEPS * simulation.dt >= APPROACH_S:
            simulation.set_pressure_pa_gauge = sets
        times.append(_stretch(simulation, engine_first=bool(k % 2)))
    return times


def _stretch(simulation: HandSimulation, *, engine_first: bool) -> tuple[float, float]:
    """Return the times [s] of the next stretch, and leave the simulation at its end."""
    model, data = simulation.model, simulation.data
    start, gas, wrist = mujoco.MjData(model), simulation.gas, simulation.wrist_reference
    losses = simulation.loss_state
    mujoco.mj_copyData(start, model, data)

    def back() -> None:
        mujoco.mj_copyData(data, model, start)
        simulation.gas, simulation.wrist_reference, simulation.loss_state = gas, wrist, losses

    def with_gas() -> float:
        back()
        began = time.thread_time()
        for _ in range(STRETCH_STEPS):
            simulation.step()
        return time.thread_time() - began

    def engine_alone() -> float:
        back()
        simulation.play_pressures(iter(pressures))
        began = time.thread_time()
        for _ in range(STRETCH_STEPS):
            simulation.step()
        took = time.thread_time() - began
        simulation.play_pressures(None)
        return took

    pressures = []
    for _ in range(STRETCH_STEPS):
        simulation.step()
        pressures.append(tuple(data.ctrl[simulation.index.pressure_ctrl].tolist()))
    end = data.qpos.copy()
    passes = [engine_alone, with_gas] if engine_first else [with_gas, engine_alone]
    times = {}
    for one in passes:
        times[one] = one()
        if not np.array_equal(data.qpos, end):
            raise RuntimeError("the two ways of running a stretch came to different states")
    back()
    for _ in range(STRETCH_STEPS):
        simulation.step()
    return times[engine_alone], times[with_gas]


if __name__ == "__main__":
    raise SystemExit(main())
