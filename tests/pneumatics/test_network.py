"""Tubes, leaks, heat and finite supply together: stiff reference, conservation, bounds, closed forms."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.control.protocol import ValveCommand
from softhand_sim.elements import ELEMENT_OF_FINGER, FINGERS_OF_ELEMENT
from softhand_sim.pneumatics.delay import ValveDelay
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.fast import CompiledFlow
from softhand_sim.pneumatics.flow import NetworkFlow
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.supply import Supply
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.pneumatics.tube import Tubing

V0, SWEEP, BULGING = 2.5e-6, 7e-7, 2e-12
RT = 287.05 * 293.15
SUPPLY = 250e3


class Script:
    """Valves by the tick's number: a list of (inlet, outlet) that repeats."""

    def __init__(self, *pattern):
        self.pattern = pattern

    def reset(self):
        return (0.0,)

    def command(self, _readings, _sets, state):
        return (ValveCommand(*self.pattern[int(state[0]) % len(self.pattern)]),) * 3, (state[0] + 1.0,)


class Chatter(Script):
    """Every valve at random, both together too."""

    def __init__(self, seed):
        self.seed = seed

    def command(self, _readings, _sets, state):
        draw = np.random.default_rng((self.seed, int(state[0]))).random(6) < 0.5
        pairs = draw.reshape(3, 2).tolist()
        return tuple(ValveCommand(*pair) for pair in pairs), (state[0] + 1.0,)


def make(controller, *, tubing=None, thermal=None, **features):
    """System with bulging chambers whose dead volume is that of tubes 0.5 + n 0.5 m long."""
    tubes = tubing or Tubing()
    elements = tuple(
        Element(
            dead_volume_m3=tubes.volume_m3(len(members)),
            compliance_m3_per_pa=len(members) * BULGING,
            tubing=tubing,
            thermal=thermal,
        )
        for members in FINGERS_OF_ELEMENT
    )
    return PneumaticSystem(elements=elements, controller=controller, sensor=None, **features)


def breathing(t):
    """Chamber volumes (5,) of fingers that move, each at its own pace."""
    return [V0 + SWEEP * (1.0 - math.cos((3.0 + 0.4 * i) * t)) for i in range(5)]


def march(system, dt, steps, start_gauge=0.0):
    state = system.reset(breathing(0.0), np.random.default_rng(0), start_gauge)
    out = [state]
    for k in range(1, steps + 1):
        state = system.step(state, breathing(k * dt), [0.0] * 3, dt)
        out.append(state)
    return out


def rested(system, dt=5e-3, steps=2000):
    """State after a long time with fingers that don't move."""
    state = system.reset([V0] * 5, np.random.default_rng(0))
    for _ in range(steps):
        state = system.step(state, [V0] * 5, [0.0] * 3, dt)
    return state


def chambers(state):
    return state.chamber_pa_abs or tuple(state.pressure_pa_abs[k] for k in ELEMENT_OF_FINGER)


class Reference:
    """The same physics written a second time as an ODE, for `solve_ivp`.

    Unknowns: per element manifold, then its fingers' chambers: mass and p V / (R T0) of each, then the receiver.
    """

    def __init__(self, system, valves_at, leak=None, receiver=None):
        self.system, self.valves_at, self.leak, self.receiver = system, valves_at, leak, receiver
        self.tubed = system.elements[0].tubing is not None
        self.nodes = [(k, None) for k in range(3)]
        if self.tubed:
            self.nodes += [(ELEMENT_OF_FINGER[i], i) for i in range(5)]

    def volume(self, node, t, p):
        k, finger = node
        element, members = self.system.elements[k], FINGERS_OF_ELEMENT[k]
        volumes, pi = breathing(t), math.pi
        bulge = BULGING * (p - AMBIENT_PA_ABS)
        if not self.tubed:
            return sum(volumes[i] for i in members) + element.dead_volume_m3 + len(members) * bulge
        half = pi / 8.0 * 9e-6 * element.tubing.finger_length_m
        if finger is None:
            return element.dead_volume_m3 - len(members) * half
        return volumes[finger] + half + bulge

    def compliance(self, node):
        k, finger = node
        if not self.tubed:
            return len(FINGERS_OF_ELEMENT[k]) * BULGING
        return 0.0 if finger is None else BULGING

    def pressure(self, node, t, heat):
        """Root of p V(p) = R T0 heat."""
        c, stiff = self.compliance(node), self.volume(node, t, 0.0)
        return 2.0 * RT * heat / (stiff + math.sqrt(stiff**2 + 4.0 * c * RT * heat))

    def orifice(self, c, up, down, up_t, down_t):
        if up < down:
            return -self.orifice(c, down, up, down_t, up_t)
        s = max(down / up - 0.3, 0.0) / 0.7
        return c * 1.185 * up * math.sqrt(max(1.0 - s * s, 0.0)) / math.sqrt(up_t)

    def tube(self, k, one, other):
        tubing, n = self.system.elements[k].tubing, len(FINGERS_OF_ELEMENT[k])
        length = tubing.finger_length_m + n * tubing.shared_length_m
        laminar = math.pi * tubing.bore_m**4 / (256.0 * 1.813e-5 * length * RT) * (one**2 - other**2)
        re = 4.0 * abs(laminar) / (math.pi * tubing.bore_m * 1.813e-5)
        # laminar up to where Blasius' friction factor is the larger one
        return laminar if re <= 1188.3 else math.copysign(self.blasius(tubing, length, one, other), laminar)

    @staticmethod
    def blasius(tubing, length, one, other):
        """D = 16 f L R T q^2 / (pi^2 d^5), f = 0.316 Re^-1/4, solved for q."""
        d, mu = tubing.bore_m, 1.813e-5
        scale = 16.0 * 0.316 * (math.pi * d * mu / 4.0) ** 0.25 * length * RT / (math.pi**2 * d**5)
        return (abs(one**2 - other**2) / scale) ** (1.0 / 1.75)

    def rate(self, t, y):
        n = len(self.nodes)
        heat, mass = y[:n], y[n : 2 * n]
        thermal = self.system.elements[0].thermal
        gamma = 1.0 if thermal is None else thermal.exponent
        p = [self.pressure(node, t, h) for node, h in zip(self.nodes, heat, strict=True)]
        warm = [1.0] * n if thermal is None else (heat / mass).tolist()
        dm, dh = np.zeros(n), np.zeros(n)
        dr = 0.0
        supply = SUPPLY if self.receiver is None else y[-1] * RT / self.receiver.volume_m3

        def exchange(i, flow, outside):
            dm[i] += flow
            dh[i] += gamma * flow * (outside if flow > 0.0 else warm[i])

        inlet, outlet = self.valves_at(t)
        for k in range(3):
            if inlet:
                flow = self.orifice(5e-11, supply, p[k], 1.0, warm[k])
                exchange(k, flow, 1.0)
                dr -= flow
            if outlet:
                exchange(k, self.orifice(5e-11, AMBIENT_PA_ABS, p[k], 1.0, warm[k]), 1.0)
        if self.leak is not None:
            finger = self.leak
            i = 3 + finger if self.tubed else ELEMENT_OF_FINGER[finger]
            exchange(i, self.orifice(3e-11, AMBIENT_PA_ABS, p[i], 1.0, warm[i]), 1.0)
        for i in range(3, n):
            k = self.nodes[i][0]
            flow = self.tube(k, p[k], p[i])
            exchange(i, flow, warm[k])
            exchange(k, -flow, warm[i])
        if thermal is not None:
            for i, node in enumerate(self.nodes):
                h = 1e-6
                swept = (self.volume(node, t + h, p[i]) - self.volume(node, t - h, p[i])) / (2.0 * h)
                dh[i] -= (heat[i] - mass[i]) / thermal.wall_time_constant_s
                # d(pV) + (n - 1) p dV, with dV = swept dt + C dp: solve for d(pV)
                c, volume = self.compliance(node), self.volume(node, t, p[i])
                # d(pV) = V dp + p (swept dt + C dp)
                dp = (RT * dh[i] - gamma * p[i] * swept) / (volume + gamma * c * p[i])
                dh[i] = (volume * dp + p[i] * (swept + c * dp)) / RT
        if self.receiver is not None:
            opening = min(max((SUPPLY - supply) / self.receiver.droop_pa, 0.0), 1.0)
            dr += self.receiver.largest_flow_kg_per_s * opening
        return np.concatenate([dh, dm, [dr]])

    def solve(self, state, times):
        masses = np.array([*state.mass_kg, *state.chamber_mass_kg])
        y0 = np.concatenate([masses, masses, state.supply_mass_kg or [0.0]])
        done, out = 0.0, []
        edges = np.arange(0.02, times[-1] + 1e-9, 0.02)  # valves switch at ticks
        for edge in edges:
            at = [t for t in times if done + 1e-9 < t <= edge + 1e-9]
            mid = 0.5 * (done + edge)
            valves = self.valves_at
            self.valves_at = lambda _t, mid=mid, valves=valves: valves(mid)
            ivp = solve_ivp(self.rate, (done, edge), y0, "BDF", rtol=1e-7, atol=1e-14, t_eval=np.minimum(at, edge))
            assert ivp.success
            self.valves_at = valves
            out += ivp.y.T.tolist()
            y0, done = ivp.y[:, -1], edge
        n = len(self.nodes)
        return np.array(
            [[self.pressure(node, t, h) for node, h in zip(self.nodes, y[:n], strict=True)]
             for t, y in zip(times, out, strict=True)]
        )  # fmt: skip


FILL, SHUT, VENT = (True, False), (False, False), (False, True)
CASES = {
    "tubes": {"tubing": Tubing(finger_length_m=1.5)},
    "tubes, leak": {"tubing": Tubing(), "leaks": (Leak(finger="ring"),)},
    "leak": {"leaks": (Leak(finger="index"),)},
    "heat": {"thermal": Polytropic()},
    "heat, tubes, leak": {"tubing": Tubing(), "thermal": Polytropic(), "leaks": (Leak(finger="thumb"),)},
    "supply": {"supply": Supply(volume_m3=2e-5, largest_flow_kg_per_s=3e-5)},
    "everything": {
        "tubing": Tubing(),
        "thermal": Polytropic(exponent=1.2, wall_time_constant_s=0.1),
        "leaks": (Leak(finger="middle"),),
        "supply": Supply(),
    },
}


@pytest.mark.parametrize("case", CASES)
def test_follows_a_stiff_reference(case):
    """0.5 % at 2 ms and 2 % at 20 ms: fill 0.5 s, hold 0.1 s, vent 0.5 s, hold, in moving fingers."""
    pattern = [FILL] * 25 + [SHUT] * 5 + [VENT] * 25 + [SHUT] * 5
    features = CASES[case]
    times = np.arange(0.02, 1.2 + 1e-9, 0.02)
    system = make(Script(*pattern), **features)
    leaks = features.get("leaks", ())
    fingers = ["thumb", "index", "middle", "ring", "little"]
    reference = Reference(
        system,
        lambda t: pattern[int(t / 0.02)],
        leak=fingers.index(leaks[0].finger) if leaks else None,
        receiver=features.get("supply"),
    )
    expected = reference.solve(march(system, 0.02, 0)[0], times)
    assert expected.max() > AMBIENT_PA_ABS + 30e3  # the comparison covers the working range
    for dt, every, tolerance in ((2e-3, 10, 0.005), (20e-3, 1, 0.02)):
        states = march(system, dt, 60 * every)[every::every]
        got = np.array([[*s.pressure_pa_abs, *s.chamber_pa_abs] for s in states])
        assert np.abs(got / expected - 1.0).max() < tolerance


def total_kg(state):
    return math.fsum([*state.mass_kg, *state.chamber_mass_kg, *state.supply_mass_kg])


def lowest(state):
    return min([*state.mass_kg, *state.chamber_mass_kg, *state.pressure_pa_abs, *state.chamber_pa_abs])


@pytest.mark.parametrize("case", ["tubes, leak", "supply", "plain"])
def test_mass_is_kept_over_a_minute_of_chatter(case):
    """Gas in hand and receiver, plus what left, minus what came in: constant within 1e-9.

    The flows to and from the outside are reckoned a second time, at each step's end, from the orifices alone.
    """
    dt = 5e-3
    system = make(Chatter(7), **CASES.get(case, {}))
    state = system.reset(breathing(0.0), np.random.default_rng(0), 20e3)
    fingers = ["thumb", "index", "middle", "ring", "little"]
    gained, vented, start = 0.0, 0.0, total_kg(state)
    for k in range(1, round(60.0 / dt) + 1):
        state = system.step(state, breathing(k * dt), [0.0] * 3, dt)
        if system.supply is not None:
            supply = state.supply_mass_kg[0] * RT / system.supply.volume_m3
            gained += dt * system.supply.refill_kg_per_s(SUPPLY, supply)
        for element, p, valves in zip(system.elements, state.pressure_pa_abs, state.valves, strict=True):
            if valves.inlet_open and system.supply is None:
                gained += dt * element.inlet.mass_flow_kg_per_s(SUPPLY, p)
            if valves.outlet_open:
                vented += dt * element.outlet.mass_flow_kg_per_s(p, AMBIENT_PA_ABS)
        for leak in system.leaks:
            p = chambers(state)[fingers.index(leak.finger)]
            vented += dt * leak.orifice.mass_flow_kg_per_s(p, AMBIENT_PA_ABS)
        assert lowest(state) > 0.0
    assert vented > 5.0 * start  # all the gas was exchanged many times
    assert abs(total_kg(state) - gained + vented - start) < 1e-9 * start


def test_mass_is_kept_with_heat_of_compression():
    """Warm gas flows as it likes between the vessels and the receiver; only the regulator adds to the total."""
    supply = Supply(volume_m3=3e-5, largest_flow_kg_per_s=1e-7)
    system = make(Script(FILL, SHUT, FILL, FILL, SHUT), tubing=Tubing(), thermal=Polytropic(), supply=supply)
    dt, gained, moved = 1e-2, 0.0, 0.0
    state = system.reset(breathing(0.0), np.random.default_rng(0))
    start = total_kg(state)
    for k in range(1, round(60.0 / dt) + 1):
        before, state = state, system.step(state, breathing(k * dt), [0.0] * 3, dt)
        gained += dt * supply.refill_kg_per_s(SUPPLY, state.supply_mass_kg[0] * RT / supply.volume_m3)
        moved += sum(abs(a - b) for a, b in zip(before.mass_kg, state.mass_kg, strict=True))
        assert lowest(state) > 0.0
    assert moved > start
    assert abs(total_kg(state) - gained - start) < 1e-9 * start


@pytest.mark.parametrize("seed", range(12))
def test_any_step_of_any_system_stays_within_the_reservoirs(seed):
    """Random features, sizes and steps from 0.1 to 20 ms: pressures stay between lowest and highest that there is.

    With volumes at rest and isothermal gas the bound is exact: ambient and supply. Fingers that move, or gas that
    warms, may leave it, and are only to stay finite and positive.
    """
    rng = np.random.default_rng(seed)

    def some(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    tubing = Tubing(finger_length_m=some(0.01, 10.0), shared_length_m=some(0.01, 1.0), bore_m=some(5e-4, 5e-3))
    thermal = Polytropic(exponent=float(rng.uniform(1.05, 1.4)), wall_time_constant_s=some(1e-3, 1.0))
    moving = bool(rng.random() < 0.5)
    features = {
        "tubing": tubing if rng.random() < 0.7 else None,
        "thermal": thermal if moving and rng.random() < 0.7 else None,
        "leaks": (Leak(finger="ring", orifice=Orifice(sonic_conductance_m3_per_s_pa=some(1e-12, 1e-8))),)
        if rng.random() < 0.7
        else (),
        "supply": Supply(volume_m3=some(1e-6, 1e-3), largest_flow_kg_per_s=some(1e-6, 1e-3))
        if rng.random() < 0.7
        else None,
        "delay": ValveDelay(opening_s=some(1e-3, 0.05), closing_s=some(1e-3, 0.05)) if rng.random() < 0.5 else None,
    }
    system = make(Chatter(seed), **features)
    t, state = 0.0, system.reset(breathing(0.0), rng, float(rng.uniform(0.0, 100e3)))
    for _ in range(400):
        dt = some(1e-4, 2e-2)
        t += dt
        state = system.step(state, breathing(t if moving else 0.0), [0.0] * 3, dt)
        pressures = [*state.pressure_pa_abs, *state.chamber_pa_abs]
        assert lowest(state) > 0.0
        assert np.isfinite([*state.mass_kg, *state.supply_mass_kg, *state.invariant, *pressures]).all()
        if not moving:
            assert min(pressures) >= AMBIENT_PA_ABS * (1.0 - 1e-9)
            assert max(pressures) <= SUPPLY * (1.0 + 1e-9)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("case", CASES)
def test_compiled_and_plain_flow_agree(case, seed):
    """One step from a random state, with both, so that neither chatter nor history hides a difference."""
    system = make(Chatter(seed), **CASES[case])
    network = NetworkFlow(elements=system.elements, leaks=system.leaks, supply=system.supply)
    rng = np.random.default_rng(seed)
    state = system.reset(breathing(0.0), rng)
    for _ in range(10):
        dt, volumes = float(rng.uniform(1e-4, 2e-2)), breathing(float(rng.uniform(0.0, 5.0)))
        plain, fast = (flow.advance(state, volumes, dt) for flow in (network, CompiledFlow(network=network)))
        for name, one, other in zip(plain._fields, plain, fast, strict=True):
            np.testing.assert_allclose(other, one, rtol=1e-10, err_msg=name)
        open_ = rng.random((3, 2)) < 0.4
        state = state._replace(valves=tuple(ValveCommand(*row) for row in open_.tolist()), **plain._asdict())


def test_without_resistance_heat_or_leak_the_network_is_the_lumped_element():
    """A supply so large that it doesn't droop takes the network's path; a leak that never opens too."""
    pattern = [FILL] * 9 + [SHUT] * 3 + [VENT] * 5
    plain = march(make(Script(*pattern)), 3e-3, 300)
    endless = Supply(volume_m3=1e3, largest_flow_kg_per_s=1.0)
    for features in ({"supply": endless}, {"leaks": (Leak(finger="index", start_s=1e6),)}):
        other = march(make(Script(*pattern), **features), 3e-3, 300)
        got, expected = ([s.pressure_pa_abs for s in states] for states in (other, plain))
        np.testing.assert_allclose(got, expected, rtol=1e-8)


def test_short_wide_tubes_are_no_tubes():
    pattern = [FILL] * 9 + [SHUT] * 3 + [VENT] * 5
    wide = Tubing(finger_length_m=1e-3, shared_length_m=0.0, bore_m=5e-3)
    elements = make(Script()).elements
    dead = [Element(dead_volume_m3=e.dead_volume_m3, compliance_m3_per_pa=e.compliance_m3_per_pa) for e in elements]
    tubed = [
        Element(dead_volume_m3=e.dead_volume_m3, compliance_m3_per_pa=e.compliance_m3_per_pa, tubing=wide) for e in dead
    ]
    runs = [
        march(PneumaticSystem(elements=tuple(e), controller=Script(*pattern), sensor=None), 2e-3, 300)
        for e in (dead, tubed)
    ]
    plain, tubes = (np.array([chambers(s) for s in states]) for states in runs)
    np.testing.assert_allclose(tubes, plain, rtol=2e-4)


def test_shut_adiabatic_chamber_follows_p_v_to_the_n():
    """No wall: 1.4; and after many time constants of the wall the isothermal pressure."""
    for exponent, wall, expected in ((1.4, None, 1.4), (1.2, None, 1.2), (1.4, 0.05, 1.0)):
        system = make(Script(SHUT), thermal=Polytropic(exponent=exponent, wall_time_constant_s=wall))
        state = system.reset([V0] * 5, np.random.default_rng(0), 30e3)
        volumes = [0.7 * V0] * 5
        for _ in range(500):
            state = system.step(state, volumes, [0.0] * 3, 2e-3)
        for element, members, p in zip(system.elements, FINGERS_OF_ELEMENT, state.pressure_pa_abs, strict=True):
            bulge = len(members) * BULGING

            def volume(one, p, element=element, members=members, bulge=bulge):
                return len(members) * one + element.dead_volume_m3 + bulge * (p - AMBIENT_PA_ABS)

            start = AMBIENT_PA_ABS + 30e3
            kept = start * volume(V0, start) ** expected
            assert p * volume(0.7 * V0, p) ** expected == pytest.approx(kept, rel=1e-9)


def test_leak_opens_at_its_time_whatever_the_step():
    leak = Leak(finger="index", orifice=Orifice(sonic_conductance_m3_per_s_pa=1e-10), start_s=0.1234)
    ends = []
    for dt in (1e-3, 7e-3, 2e-2):
        system = make(Script(SHUT), leaks=(leak,))
        state = system.reset([V0] * 5, np.random.default_rng(0), 50e3)
        while state.time_s[0] < 0.12 - 1e-9:
            state = system.step(state, [V0] * 5, [0.0] * 3, min(dt, 0.12 - state.time_s[0]))
        assert min(state.pressure_pa_abs) == pytest.approx(AMBIENT_PA_ABS + 50e3, rel=1e-12)
        for _ in range(round(0.14 / dt)):
            state = system.step(state, [V0] * 5, [0.0] * 3, dt)
        assert state.pressure_pa_abs[0] == pytest.approx(AMBIENT_PA_ABS + 50e3, rel=1e-12)
        ends.append(state.pressure_pa_abs[1] - AMBIENT_PA_ABS)
    assert ends[0] < 45e3
    np.testing.assert_allclose(ends, ends[0], rtol=0.02)


def test_supply_droops_as_its_regulator_says():
    """All inlets into ambient: the receiver settles where the regulator gives what they take."""
    supply = Supply(volume_m3=1e-4, largest_flow_kg_per_s=2e-4, droop_pa=10e3)
    system = make(Script((True, True)), supply=supply)
    state = rested(system)
    p = state.supply_mass_kg[0] * RT / supply.volume_m3
    taken = sum(Orifice().mass_flow_kg_per_s(p, q) for q in state.pressure_pa_abs)
    assert supply.refill_kg_per_s(SUPPLY, p) == pytest.approx(taken, rel=1e-3)
    assert SUPPLY - p == pytest.approx(10e3 * taken / 2e-4, rel=1e-3)
    starved = Supply(volume_m3=1e-5, largest_flow_kg_per_s=2e-5)
    state = rested(make(Script((True, True)), supply=starved))
    taken = sum(Orifice().mass_flow_kg_per_s(state.supply_mass_kg[0] * RT / 1e-5, q) for q in state.pressure_pa_abs)
    assert taken == pytest.approx(2e-5, rel=1e-3)  # the compressor's limit


def test_state_of_every_feature_is_saved_bit_for_bit():
    system = make(Chatter(3), delay=ValveDelay(), **CASES["everything"])
    state = march(system, 1.3e-3, 300)[-1]
    copy = system.restore(state.to_array())
    assert copy == state
    for k in range(300):
        state, copy = (system.step(s, breathing(0.4 + 1.3e-3 * k), [0.0] * 3, 1.3e-3) for s in (state, copy))
    assert copy.to_array().tobytes() == state.to_array().tobytes()


def test_absent_features_leave_no_state():
    state = make(Script(SHUT)).reset([V0] * 5, np.random.default_rng(0))
    assert (state.chamber_mass_kg, state.invariant, state.waiting_s, state.supply_mass_kg, state.time_s) == ((),) * 5


def test_bad_features_are_named():
    elements = make(Script()).elements
    with pytest.raises(ValueError, match="tubing"):
        PneumaticSystem(elements=(make(Script(), tubing=Tubing()).elements[0], *elements[1:]))
    with pytest.raises(ValueError, match="dead_volume_m3"):
        Element(dead_volume_m3=1e-9, tubing=Tubing())
    with pytest.raises(ValueError, match="leaks"):
        make(Script(), leaks=(Leak(finger="ring"), Leak(finger="ring")))
    with pytest.raises(ValueError, match="supply_pa_abs"):
        PneumaticSystem(elements=(Element(supply_pa_abs=2e5), *elements[1:]), supply=Supply())
    with pytest.raises(ValueError, match="finger"):
        Leak(finger="pinky")
    with pytest.raises(ValueError, match="start_s"):
        Leak(finger="ring", start_s=-1.0)
    for name in ("volume_m3", "largest_flow_kg_per_s", "droop_pa"):
        with pytest.raises(ValueError, match=name):
            Supply(**{name: 0.0})
    for name, value in (("exponent", 1.0), ("exponent", 1.5), ("wall_time_constant_s", 0.0)):
        with pytest.raises(ValueError, match=name):
            Polytropic(**{name: value})


@pytest.mark.parametrize("compiled", [True, False])
def test_more_flow_through_an_element_than_can_be_followed_is_named(compiled, monkeypatch):
    """Both valves eight hundred times the usual size in a step of 18 ms: hypothesis found gas that was no number."""
    if not compiled:
        monkeypatch.setattr("softhand_sim.pneumatics.system._network_flow", lambda network: network.flow())
    valve = Orifice(sonic_conductance_m3_per_s_pa=4.14e-8, critical_pressure_ratio=0.0)
    element = Element(
        inlet=valve, outlet=valve, dead_volume_m3=0.0, supply_pa_abs=22e3, ambient_pa_abs=1.1e3,
        thermal=Polytropic(wall_time_constant_s=1.0),
    )  # fmt: skip
    system = PneumaticSystem(
        elements=(element,) * 3, sensor=None, controller=Script((False, True), (True, True)),
        supply=Supply(volume_m3=6.7e-3),
    )  # fmt: skip

    def least_mass_kg(dt):
        state, masses = system.reset([6.1e-6] * 5, np.random.default_rng(0)), []
        for _ in range(round(0.2 / dt)):
            state = system.step(state, [6.1e-6] * 5, [0.0] * 3, dt)
            masses += state.mass_kg
        return min(masses)

    with pytest.raises(ValueError, match=r"dt = 0\.0+18: many times an element's gas flows through it"):
        least_mass_kg(0.018)
    # steps that it can be followed in are no trouble
    assert least_mass_kg(5e-4) > 0.0


def test_chambers_that_bulge_by_more_than_their_volume_are_named():
    element = Element(compliance_m3_per_pa=1e-11, dead_volume_m3=0.0, thermal=Polytropic())
    system = PneumaticSystem(elements=(element,) * 3)
    with pytest.raises(ValueError, match="compliance_m3_per_pa = 1e-11: thumb must bulge by less"):
        system.reset([1e-6] * 5, np.random.default_rng(0))
    state = system.reset([2e-6] * 5, np.random.default_rng(0))
    with pytest.raises(ValueError, match="compliance_m3_per_pa"):
        system.step(state, [1e-6] * 5, [0.0] * 3, 2e-3)
