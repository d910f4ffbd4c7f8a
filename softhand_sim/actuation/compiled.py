"""The actuation by compiled kernels over all worlds; Python is left with the ticks of the controllers."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.actuation.kernel import AT_TICK, NO_VOLUME, TIME_TOLERANCE_S, advance_hands
from softhand_sim.actuation.layout import GAS, GIVEN, SET, hand_record, world_dtype
from softhand_sim.actuation.native import EngineGuard
from softhand_sim.actuation.parts import Course, EngineArrays, HandParts
from softhand_sim.actuation.run import FAILED, run_world
from softhand_sim.actuation.switching import command_onoff, read_sensors, switch_valves
from softhand_sim.calibration.limits import EXTREMES
from softhand_sim.compiling import loaded
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.protocol import ValveCommand, checked_answer
from softhand_sim.elements import FINGERS
from softhand_sim.losses import LossState
from softhand_sim.pneumatics.compiled.layout import GAS_PRESSURE, MANIFOLDS, element_records, receiver_row
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.fast import gas_array, gas_state
from softhand_sim.pneumatics.noise import NumberedNoise
from softhand_sim.pneumatics.state import PneumaticState
from softhand_sim.pneumatics.system import PneumaticSystem

Vector = npt.NDArray[np.float64]


class CompiledActuation:
    """`Actuation` of n hands in arrays of records (`layout`)."""

    def __init__(self, hand: HandParts, engine: EngineArrays) -> None:
        self._hand, self._engine = hand, engine
        system = hand.pneumatics
        self._memory = 0 if system is None else len(system.controller.reset())
        self._hands = hand_record(hand)
        self._elements = element_records(tuple(Element() for _ in range(3)) if system is None else system.elements)
        self._receiver = receiver_row(None if system is None else system.supply)
        self._branches = int(self._hands["branches"][0])
        self._worlds = np.zeros(len(engine.ctrl), world_dtype(self._branches, self._memory))
        self._worlds["source"] = SET if system is None else GAS
        self._worlds["waiting"] = math.inf
        self._noise = NumberedNoise()
        self._codes: dict[Any, Callable[..., Any]] = {}
        self._pressure: Vector = self._worlds["gas"][:, GAS_PRESSURE, :MANIFOLDS]
        self._reading: Vector = self._worlds["reading"]
        self._open: npt.NDArray[np.uint8] = self._worlds["open"]
        self.set_pa_gauge: Vector = self._worlds["set"]
        self.pressure_pa_gauge: Vector = self._worlds["pressure"]

    def _call(self, kernel: Any, *arguments: Any) -> Any:
        """Call an entry, whose arguments have the same types every time."""
        if kernel not in self._codes:
            self._codes[kernel] = loaded(kernel, *arguments)
        return self._codes[kernel](*arguments)

    def _arguments(self, dt: float, *, begins: bool) -> tuple[Any, ...]:
        e = self._engine
        state = (self._elements, self._hands, self._worlds, self._receiver)
        return (*state, e.ten_length, e.qpos, e.ctrl, dt, begins)

    def reset(self, world: int, rng: np.random.Generator) -> None:
        """Empty the fingers of a world."""
        elongation = self._hand.index.elongations_m(self._engine.ten_length[world])
        self.set_losses(world, self._hand.losses.rest(elongation))
        if self._hand.pneumatics is not None:
            volumes = self._hand.calibration.chamber.volumes_m3(elongation)
            self.set_gas(world, self._hand.pneumatics.reset(volumes, rng))

    def step(self, dt: float) -> None:
        """Advance every world: one call of the kernel, and one more for each control tick."""
        begins = True
        while True:
            waiting = self._call(advance_hands, *self._arguments(dt, begins=begins))
            if waiting == 0:
                return
            if waiting < 0:
                self._refuse(-1 - waiting)
            if self._hand.pneumatics is not None:
                self._tick(self._hand.pneumatics)
            begins = False

    def run(self, guard: EngineGuard, course: Course, dt: float, steps: int) -> None:
        """Take steps of the only world, with as little Python as may be: a `Runner` of the guard's world."""
        if len(course.given):
            self.play(course.given[:1])
        begins = True
        while steps > 0:
            noise = self._noise_ahead(dt * steps)
            arguments = self._run_arguments(guard, course, noise, dt, steps, begins=begins)
            done, why = self._call(run_world, *arguments)
            steps -= done
            if why == FAILED:
                guard.raise_error()
            if why == NO_VOLUME:
                self._refuse(0)
            if why == AT_TICK and self._hand.pneumatics is not None:
                self._tick(self._hand.pneumatics)
            begins = False

    def load_run(self, guard: EngineGuard) -> None:
        """Compile `run`, or load its code, which takes up to seconds, before the first step."""
        course = Course(
            wrist=np.zeros((2, 1, 6)), limits=np.zeros(2), extremes=np.zeros(EXTREMES), clock=np.zeros(3),
            given=np.zeros((0, len(FINGERS))),
        )  # fmt: skip
        self._call(run_world, *self._run_arguments(guard, course, np.zeros((0, 3)), 0.0, 0, begins=True))

    def _run_arguments(
        self, guard: EngineGuard, course: Course, noise: Vector, dt: float, steps: int, *, begins: bool
    ) -> tuple[Any, ...]:
        e = self._engine
        state = (guard.words, self._elements, self._hands, self._worlds, self._receiver)
        beside = (course.wrist, course.limits, course.extremes, course.clock, course.given)
        return (*state, e.ten_length, e.qpos, e.ctrl, *beside, noise, dt, steps, begins)

    def _noise_ahead(self, duration_s: float) -> Vector:
        """Return the draws for the ON-OFF law's ticks in a time to come, (m, 3); none for other laws."""
        system, world = self._hand.pneumatics, self._worlds[0]
        if system is None or type(system.controller) is not OnOffController:
            return np.zeros((0, 3))
        count = max(0, math.ceil((duration_s - float(world["to_tick"])) / system.tick_s - 1e-6))
        noise, seed, first = np.zeros((count, 3)), int(world["noise_seed"]), int(world["ticks"])
        if system.sensor is not None:
            for m in range(count):
                noise[m] = self._noise.draw(seed, first + m, 3)
        return noise

    def _refuse(self, world: int) -> None:
        volumes = self._worlds["volume"][world].tolist()
        raise ValueError(f"volumes_m3 = {volumes}: must be {len(volumes)} finite numbers > 0")

    def play(self, pressures_pa_gauge: Vector) -> None:
        """Give the fingers these pressures instead of the gas's."""
        self._worlds["source"] = GIVEN
        self._worlds["pressure"] = pressures_pa_gauge

    def stop_playing(self) -> None:
        """Let the gas go on."""
        self._worlds["source"] = SET if self._hand.pneumatics is None else GAS

    def pressure_pa_abs(self) -> Vector:
        """Return the pressure where each element's sensor sits."""
        return np.array(self._pressure)

    def reading_pa_abs(self) -> Vector:
        """Return the last readings."""
        return np.array(self._reading)

    def valves_open(self) -> Vector:
        """Return which valves are open."""
        return np.array(self._open, dtype=np.float64)

    def gas(self, world: int) -> PneumaticState | None:
        """Return a world's gas, valves and control."""
        system, w = self._hand.pneumatics, self._worlds[world]
        if system is None:
            return None
        warm, supply = system.elements[0].thermal is not None, system.supply is not None
        gas = gas_state(w["gas"], chambers=bool(self._hands["tubes"][0]), warm=warm, supply=supply)
        return PneumaticState(
            time_to_tick_s=float(w["to_tick"]),
            ticks=int(w["ticks"]),
            noise_seed=int(w["noise_seed"]),
            readings_pa_abs=tuple(w["reading"].tolist()),
            valves=tuple(ValveCommand(*pair) for pair in w["open"].astype(bool).reshape(3, 2).tolist()),
            controller=tuple(w["memory"][: self._memory].tolist()),
            waiting_s=tuple(w["waiting"].tolist()) if system.delay is not None else (),
            time_s=(float(w["time"]),) if system.leaks else (),
            **gas._asdict(),
        )

    def set_gas(self, world: int, state: PneumaticState | None) -> None:
        """Put gas, valves and control of a world into a state."""
        if state is None:
            return
        w = self._worlds[world]
        w["gas"] = gas_array(state)
        w["to_tick"], w["ticks"], w["noise_seed"] = state.time_to_tick_s, state.ticks, state.noise_seed
        w["reading"], w["open"] = state.readings_pa_abs, np.array(state.valves, dtype=np.uint8).ravel()
        w["memory"][: self._memory] = state.controller
        w["waiting"] = state.waiting_s or math.inf
        w["time"] = state.time_s[0] if state.time_s else 0.0

    def losses(self, world: int) -> LossState:
        """Return slip, relaxation and relief of a world's fingers."""
        w = self._worlds[world]
        return LossState(slip_m=w["slip"].copy(), flow_m=w["flow"][: self._branches].copy(), bulge_m=w["bulge"].copy())

    def set_losses(self, world: int, state: LossState) -> None:
        """Put slip, relaxation and relief of a world's fingers into a state."""
        w = self._worlds[world]
        w["slip"], w["flow"][: self._branches], w["bulge"] = state.slip_m, state.flow_m, state.bulge_m

    def _tick(self, system: PneumaticSystem) -> None:
        """Let the controllers of all worlds whose tick is due switch their valves."""
        worlds = self._worlds
        due = np.flatnonzero((worlds["to_tick"] <= TIME_TOLERANCE_S) & (worlds["left"] > 0.0))
        noise = np.zeros((len(due), 3))
        if system.sensor is not None:
            for m, (seed, number) in enumerate(zip(worlds["noise_seed"][due], worlds["ticks"][due], strict=True)):
                noise[m] = self._noise.draw(int(seed), int(number), 3)
        wrong = self._call(read_sensors, self._elements, self._hands, worlds, due, noise)
        if wrong >= 0:
            system.check_sets(worlds["set"][wrong].tolist())
        if type(system.controller) is OnOffController:
            self._call(command_onoff, self._hands, worlds, due)
        else:
            for w in due:
                self._ask(system, worlds[w])
        self._call(switch_valves, self._hands, worlds, due)

    def _ask(self, system: PneumaticSystem, w: Any) -> None:
        """Ask a controller of one's own."""
        readings, sets, memory = (tuple(w[name].tolist()) for name in ("reading", "set", "memory"))
        answer = system.controller.command(readings, sets, memory[: self._memory])
        valves, after = checked_answer(type(system.controller).__name__, answer, self._memory)
        w["wanted"] = np.array(valves, dtype=np.uint8).ravel()
        w["memory"][: self._memory] = after
