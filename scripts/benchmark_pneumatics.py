"""What pneumatics and control add to the step of one hand, and of many hands together, that grasp an object.

The same stretches of grasps are run in turn from the same state: with the gas and its controllers, and with the
recorded pressures instead, all else alike (engine, wrists, the fingers' losses). Both come to the same state, which is
checked. Every hand has its object at another place. Times are those of the processor on one thread, so that other work
on the machine disturbs them less.
"""

import time
from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt
from tqdm import tqdm

from scripts import _cli
from softhand_sim.batch import HandBatch
from softhand_sim.calibration import load_calibration
from softhand_sim.effects import PRESETS
from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.trial import TrialSetup, prepare
from softhand_sim.objects.catalogue import make_object
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]

EXAMPLES = """examples:
  benchmark_pneumatics.py --json out/pneumatics_cost.json
  benchmark_pneumatics.py --effects bench --object mug --hands 1 --repeats 5
"""
STRETCH_STEPS, STEPS_AT_ONCE = 100, 10
# approach, closing, hold: without the lift, which is the hold moved
APPROACH_S, CLOSE_S, HOLD_S = 0.8, 2.5, 2.0


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--object", default="apple", help="catalogue name (default apple)")
    p.add_argument("--effects", nargs="+", choices=[k for k in PRESETS if k != "ideal"], default=["bench", "full"])
    p.add_argument("--hands", nargs="+", type=_cli.positive_int, default=[1, 64], help="hands together (default 1 64)")
    p.add_argument(
        "--repeats", type=_cli.positive_int, default=3, help="grasps per preset and number of hands (default 3)"
    )
    p.add_common(seed="of the sensors' noise", json="write the figures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    model, calibration = make_object(args.object), load_calibration()
    setups = {name: prepare(model, calibration, effects=PRESETS[name]) for name in args.effects}
    cases = [(name, hands) for name in setups for hands in args.hands]
    pairs: dict[tuple[str, int], list[tuple[float, float]]] = {case: [] for case in cases}
    with tqdm(total=args.repeats * sum(hands for _, hands in cases), disable=None, unit="grasp") as bar:
        for repeat in range(args.repeats):
            for name, hands in cases:
                pairs[name, hands] += _grasps(setups[name], hands, args.seed + repeat)
                bar.update(hands)
    print(f"{'effects':<8}{'hands':>6}{'step us':>11}{'with gas us':>13}{'added':>8}{'quartiles of the stretches':>30}")
    rows = [_row(name, hands, np.array(times)) for (name, hands), times in pairs.items()]
    if args.json is not None:
        _cli.write_json(args.json, {"object": args.object, "seed": args.seed, "cases": rows})
    return 0


def _row(name: str, hands: int, times: npt.NDArray[np.float64]) -> dict[str, object]:
    """Print and return the figures of one case from the times [s] of its stretches, (k, 2); a step is one hand's."""
    alone, both = times.T / (STRETCH_STEPS * hands)
    added = float(both.sum() / alone.sum() - 1.0)
    quartiles = np.percentile(both / alone - 1.0, [25, 75])
    print(
        f"{name:<8}{hands:>6}{1e6 * alone.mean():>11.1f}{1e6 * both.mean():>13.1f}{added:>8.1%}"
        f"{quartiles[0]:>20.1%} to {quartiles[1]:.1%}"
    )
    return {
        "effects": name,
        "hands": hands,
        "step_s_without_pneumatics": float(alone.mean()),
        "step_s": float(both.mean()),
        "added_share": added,
        "added_share_quartiles": quartiles.tolist(),
        "stretches": len(times),
    }


def _grasps(setup: TrialSetup, hands: int, seed: int) -> list[tuple[float, float]]:
    """Return the times [s] of every stretch of the grasps: engine alone, and with pneumatics."""
    world = _Single(setup, seed) if hands == 1 else _Many(setup, hands, seed)
    sets = np.array([setup.calibration.closing_pressure(angle) for angle in setup.plan.set_angle_deg])
    times: list[tuple[float, float]] = []
    for k in range(round((APPROACH_S + CLOSE_S + HOLD_S) / (STRETCH_STEPS * setup.scene.model.opt.timestep))):
        if k * STRETCH_STEPS * setup.scene.model.opt.timestep >= APPROACH_S:
            world.close(sets)
        times.append(_stretch(world, engine_first=bool(k % 2)))
    return times


def _stretch(world: "_Single | _Many", *, engine_first: bool) -> tuple[float, float]:
    """Return the times [s] of the next stretch, and leave the hands at its end."""
    world.keep()
    world.back()
    pressures = []
    for _ in range(STRETCH_STEPS):
        world.hands.step()
        pressures.append(world.pressures())
    end, times = world.qpos().copy(), {}
    for alone in (engine_first, not engine_first):
        world.back()
        world.play(pressures if alone else None)
        began = time.thread_time()
        world.run(STRETCH_STEPS)
        times[alone] = time.thread_time() - began
        world.play(None)
        if not np.array_equal(world.qpos(), end):
            raise RuntimeError("the two ways of running a stretch came to different states")
    world.back()
    world.run(STRETCH_STEPS)
    return times[True], times[False]


class _Single:
    """One `HandSimulation` that goes back to where it was."""

    def __init__(self, setup: TrialSetup, seed: int) -> None:
        self.hands = HandSimulation(
            model=setup.scene.model, calibration=setup.calibration, pneumatics=setup.pneumatics, losses=setup.losses
        )
        self.hands.reset(np.random.default_rng(seed), setup.plan.standoff(setup.protocol.approach_m))
        place_object(self.hands, setup.model.rest_height_m, (0.0, 0.0, 0.0))
        self.hands.wrist_target = setup.plan.standoff(0.0)
        self._start = mujoco.MjData(setup.scene.model)

    def close(self, set_pa_gauge: Vector) -> None:
        self.hands.set_pressure_pa_gauge = set_pa_gauge

    def keep(self) -> None:
        hands = self.hands
        mujoco.mj_copyData(self._start, hands.model, hands.data)
        self._kept = hands.gas, hands.loss_state, hands.wrist_reference

    def back(self) -> None:
        hands = self.hands
        mujoco.mj_copyData(hands.data, hands.model, self._start)
        hands.gas, hands.loss_state, hands.wrist_reference = self._kept

    def run(self, steps: int) -> None:
        # as trials do, which ask something every 20 ms
        for _ in range(steps // STEPS_AT_ONCE):
            self.hands.advance(STEPS_AT_ONCE)

    def pressures(self) -> Vector:
        return np.asarray(self.hands.data.ctrl[self.hands.index.pressure_ctrl])

    def play(self, pressures: Sequence[Vector] | None) -> None:
        self.hands.play_pressures(None if pressures is None else iter(pressures))

    def qpos(self) -> Vector:
        return np.asarray(self.hands.data.qpos)


class _Many:
    """A `HandBatch` that goes back to where it was."""

    def __init__(self, setup: TrialSetup, hands: int, seed: int) -> None:
        self.hands = HandBatch(
            model=setup.scene.model, calibration=setup.calibration, pneumatics=setup.pneumatics, losses=setup.losses,
            worlds=hands, threads=1,
        )  # fmt: skip
        self._ids = np.arange(hands)
        rngs = [np.random.default_rng([seed, k]) for k in range(hands)]
        self.hands.reset(self._ids, rngs, setup.plan.standoff(setup.protocol.approach_m))
        address = setup.scene.model.joint("object_joint").qposadr[0]
        for pose, rng in zip(self.hands.engine.bind("qpos"), rngs, strict=True):
            x, y, yaw = setup.protocol.draw_offset(rng)
            turn = (np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw))
            pose[address : address + 7] = (x, y, setup.model.rest_height_m, *turn)
        self.hands.wrist_target[:] = setup.plan.standoff(0.0)

    def close(self, set_pa_gauge: Vector) -> None:
        self.hands.set_pressure_pa_gauge[:] = set_pa_gauge

    def keep(self) -> None:
        act = self.hands.actuation
        states = [(act.gas(w), act.losses(w)) for w in self._ids.tolist()]
        self._kept = self.hands.engine.state.copy(), self.hands.wrist_reference.copy(), states

    def back(self) -> None:
        self.hands.engine.state[:], self.hands.wrist_reference[:], states = self._kept
        for w, (gas, losses) in enumerate(states):
            self.hands.actuation.set_gas(w, gas)
            self.hands.actuation.set_losses(w, losses)
        self.hands.forward(self._ids)

    def run(self, steps: int) -> None:
        for _ in range(steps):
            self.hands.step()

    def pressures(self) -> Vector:
        return np.asarray(self.hands.engine.bind("ctrl")[:, self.hands.index.pressure_ctrl])

    def play(self, pressures: Sequence[Vector] | None) -> None:
        self.hands.play_pressures(None if pressures is None else iter(pressures))

    def qpos(self) -> Vector:
        return np.asarray(self.hands.engine.bind("qpos"))


if __name__ == "__main__":
    raise SystemExit(main())
