"""Gas balance of one element against closed forms and a stiff reference, and its invariants."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.pneumatics.chamber import Chamber
from softhand_sim.pneumatics.element import Element, tube_volume_m3
from softhand_sim.pneumatics.orifice import Orifice

V0, AREA = 2.5e-6, 6.4e-5
RT = Chamber().rt_j_per_kg


def iso_flow(upstream, downstream, c=5e-11, b=0.3):
    """ISO 6358 written a second time, without the linear part near equilibrium."""
    if upstream < downstream:
        return -iso_flow(downstream, upstream, c, b)
    s = max(downstream / upstream - b, 0.0) / (1.0 - b)
    return c * 1.185 * upstream * math.sqrt(1.0 - s * s)


def march(element, pressure, volume_at, dt, duration, valves_at):
    """Pressures at the end of every step, the volume being given at each step's end."""
    mass = element.mass_kg(pressure, volume_at(0.0))
    out = []
    for k in range(round(duration / dt)):
        inlet, outlet = valves_at((k + 0.5) * dt)
        end = (k + 1) * dt
        mass = element.step(mass, volume_at(end), inlet, outlet, dt)
        out.append(element.pressure_pa_abs(mass, volume_at(end)))
    return np.array(out)


def test_choked_fill_of_a_fixed_volume_is_a_ramp():
    supply = 900e3  # choked up to 0.3 x 900 = 270 kPa
    element = Element(supply_pa_abs=supply)
    ramp = 5e-11 * 1.185 * supply * RT / (V0 + element.dead_volume_m3)
    for dt in (1e-4, 2e-3):
        n = round(0.02 / dt)
        pressures = march(element, AMBIENT_PA_ABS, lambda _t: V0, dt, 0.02, lambda _t: (True, False))
        closed = AMBIENT_PA_ABS + ramp * dt * np.arange(1, n + 1)
        assert closed[-1] < 0.3 * supply
        np.testing.assert_allclose(pressures, closed, rtol=1e-10)


def test_choked_vent_converges_to_the_exponential_at_first_order():
    element = Element(supply_pa_abs=900e3)
    tau = (V0 + element.dead_volume_m3) / (5e-11 * 1.185 * RT)
    errors = []
    for dt in (8e-3, 4e-3, 2e-3):
        pressures = march(element, 850e3, lambda _t: V0, dt, 0.64, lambda _t: (False, True))
        exact = 850e3 * math.exp(-0.64 / tau)
        assert exact > AMBIENT_PA_ABS / 0.3
        errors.append(abs(pressures[-1] / exact - 1.0))
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(("dt", "tolerance"), [(2e-3, 0.005), (2e-2, 0.02)])
@pytest.mark.parametrize("fingers", [1, 3])
@pytest.mark.parametrize("opening", [1e-10, 3e-10])
def test_follows_a_stiff_reference(dt, tolerance, fingers, opening):
    """Fill, hold, vent, hold, while the fingers' volume breathes."""
    valve = Orifice(sonic_conductance_m3_per_s_pa=opening)
    element = Element(inlet=valve, outlet=valve, dead_volume_m3=tube_volume_m3(fingers))
    phases = [(0.8, (True, False)), (0.9, (False, False)), (1.7, (False, True)), (1.8, (False, False))]

    def volume_at(t):
        return fingers * (V0 + 0.5 * AREA * 0.011 * (1.0 - math.cos(2.0 * math.pi * t / 0.8)))

    def valves_at(t):
        return next(valves for end, valves in phases if t < end)

    mass = element.mass_kg(AMBIENT_PA_ABS, volume_at(0.0))
    times, reference, start = [], [], 0.0
    for end, (inlet, outlet) in phases:

        def rate(t, m, inlet=inlet, outlet=outlet):
            p = m[0] * RT / (volume_at(t) + element.dead_volume_m3)
            inflow = inlet * iso_flow(element.supply_pa_abs, p, opening)
            return [inflow - outlet * iso_flow(p, element.ambient_pa_abs, opening)]

        at = np.linspace(start, end, round((end - start) / dt) + 1)[1:]
        solution = solve_ivp(rate, (start, end), [mass], "Radau", at, rtol=1e-9, atol=1e-16, max_step=0.01)
        assert solution.success
        times += at.tolist()
        reference += solution.y[0].tolist()
        mass, start = solution.y[0, -1], end
    volumes = np.array([volume_at(t) for t in times]) + element.dead_volume_m3
    expected = np.array(reference) * RT / volumes
    assert expected.max() > AMBIENT_PA_ABS + 40e3  # the comparison covers the working range
    pressures = march(element, AMBIENT_PA_ABS, volume_at, dt, 1.8, valves_at)
    assert np.max(np.abs(pressures / expected - 1.0)) < tolerance


def test_shut_valves_keep_the_mass_and_p_times_v():
    element = Element()
    mass = start = element.mass_kg(150e3, V0)
    for volume in np.random.default_rng(1).uniform(0.5 * V0, 2.0 * V0, 500).tolist():
        mass = element.step(mass, volume, False, False, 2e-3)
        pv = element.pressure_pa_abs(mass, volume) * (volume + element.dead_volume_m3)
        assert pv == pytest.approx(150e3 * (V0 + element.dead_volume_m3), rel=1e-12)
    assert mass == pytest.approx(start, rel=1e-12)


@pytest.mark.parametrize("dead_volume_m3", [0.0, tube_volume_m3(1)])
def test_chatter_stays_between_ambient_and_supply(dead_volume_m3):
    """Also with both valves open, and in a volume so small that one step crosses the whole range."""
    rng = np.random.default_rng(2)
    element = Element(dead_volume_m3=dead_volume_m3)
    for volume in (V0, 0.01 * V0):
        mass = element.mass_kg(AMBIENT_PA_ABS, volume)
        for _ in range(3000):
            dt = float(10.0 ** rng.uniform(-4.0, math.log10(0.02)))
            inlet, outlet = rng.random(2) < 0.5
            before = element.pressure_pa_abs(mass, volume)
            mass = element.step(mass, volume, bool(inlet), bool(outlet), dt)
            pressure = element.pressure_pa_abs(mass, volume)
            assert AMBIENT_PA_ABS * (1.0 - 1e-12) <= pressure <= element.supply_pa_abs * (1.0 + 1e-12)
            if inlet and not outlet:
                assert pressure >= before * (1.0 - 1e-12)
            if outlet and not inlet:
                assert pressure <= before * (1.0 + 1e-12)


def test_step_gains_exactly_what_flows():
    """Each step's mass change is the flow at its end pressure times dt: nothing is lost in the root find."""
    rng = np.random.default_rng(3)
    element = Element()
    for pressure, dt in zip(rng.uniform(9e4, 2.6e5, 300).tolist(), rng.uniform(1e-4, 0.02, 300).tolist(), strict=True):
        mass = element.mass_kg(pressure, V0)
        after = element.step(mass, V0, True, True, dt)
        end = element.pressure_pa_abs(after, V0)
        flow = element.inlet.mass_flow_kg_per_s(element.supply_pa_abs, end)
        flow -= element.outlet.mass_flow_kg_per_s(end, element.ambient_pa_abs)
        assert after - mass == pytest.approx(dt * flow, rel=1e-6, abs=1e-11 * mass)


def test_tiny_chamber_reaches_its_equilibrium_in_one_long_step():
    """Stiff limit: 20 ms are a thousand time constants and more, from any start, for any valve and supply."""
    rng = np.random.default_rng(4)
    for _ in range(300):
        valve = Orifice(critical_pressure_ratio=float(rng.uniform(0.0, 0.6)))
        supply, pressure = float(rng.uniform(1.5e5, 9e5)), float(rng.uniform(5e4, 1e6))
        element = Element(inlet=valve, outlet=valve, dead_volume_m3=0.0, supply_pa_abs=supply)
        volume = 1e-12
        ends = {}
        for valves in ((True, False), (False, True), (True, True)):
            mass = element.step(element.mass_kg(pressure, volume), volume, *valves, 0.02)
            ends[valves] = element.pressure_pa_abs(mass, volume)
        assert ends[True, False] == pytest.approx(supply, rel=1e-3)
        assert ends[False, True] == pytest.approx(AMBIENT_PA_ABS, rel=1e-3)
        balance = valve.mass_flow_kg_per_s(supply, ends[True, True])
        assert balance == pytest.approx(valve.mass_flow_kg_per_s(ends[True, True], AMBIENT_PA_ABS), rel=1e-3)


def test_compressed_above_supply_gas_flows_back():
    element = Element()
    mass = element.mass_kg(300e3, V0)
    after = element.step(mass, V0, True, False, 2e-3)
    assert after < mass
    assert element.supply_pa_abs < element.pressure_pa_abs(after, V0) < 300e3


def test_default_flow_fills_a_finger_in_three_quarters_of_a_second():
    """The observable that the valve's conductance was chosen for."""
    element = Element()
    pressures = march(
        element,
        AMBIENT_PA_ABS,
        lambda t: V0 + AREA * 0.011 * min(t / 0.75, 1.0),
        1e-3,
        1.0,
        lambda _t: (True, False),
    )
    filled = 1e-3 * (1 + int(np.argmax(pressures >= AMBIENT_PA_ABS + 75e3)))
    assert filled == pytest.approx(0.75, abs=0.05)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("dead_volume_m3", -1e-9),
        ("supply_pa_abs", 90e3),
        ("ambient_pa_abs", 0.0),
        ("supply_pa_abs", math.inf),
    ],
)
def test_bad_parameters_are_named(field, value):
    with pytest.raises(ValueError, match=field):
        Element(**{field: value})


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan])
def test_bad_step_arguments_are_refused(bad):
    element = Element()
    good = {"mass_kg": 1e-5, "volume_m3": V0, "inlet_open": True, "outlet_open": False, "dt": 1e-3}
    for name in ("mass_kg", "volume_m3", "dt"):
        with pytest.raises(ValueError, match=name):
            element.step(**{**good, name: bad})


def test_bulging_walls_take_more_gas_and_give_it_back():
    """p (V0 + C (p - ambient)) = m R T, both ways, and with the same valves a slower fill."""
    soft, stiff = Element(compliance_m3_per_pa=5e-12), Element()
    for pressure in (20e3, AMBIENT_PA_ABS, 180e3, 250e3):
        mass = soft.mass_kg(pressure, V0)
        volume = V0 + soft.dead_volume_m3 + 5e-12 * (pressure - AMBIENT_PA_ABS)
        assert mass == pytest.approx(pressure * volume / RT, rel=1e-14)
        assert soft.pressure_pa_abs(mass, V0) == pytest.approx(pressure, rel=1e-14)
    for dt in (1e-4, 2e-3, 2e-2):
        fill, slow = (march(e, AMBIENT_PA_ABS, lambda _t: V0, dt, 0.1, lambda _t: (True, False)) for e in (stiff, soft))
        assert (slow < fill).all()
        assert (np.diff(slow) > 0.0).all()


def test_bulging_walls_follow_the_balance_of_mass_at_first_order():
    """Against a stiff reference of d(p V(p))/dt = R T q(p), with V(p) = V0 + C (p - ambient)."""
    element, c = Element(compliance_m3_per_pa=8e-12), 8e-12
    start, end = AMBIENT_PA_ABS, 0.5

    def rate(_t, p):
        slope = V0 + element.dead_volume_m3 + c * (2.0 * p[0] - AMBIENT_PA_ABS)
        return [RT * iso_flow(250e3, p[0]) / slope]

    exact = solve_ivp(rate, (0.0, end), [start], method="Radau", rtol=1e-10, atol=1e-3).y[0, -1]
    errors = [
        abs(march(element, start, lambda _t: V0, dt, end, lambda _t: (True, False))[-1] - exact)
        for dt in (4e-3, 2e-3, 1e-3)
    ]
    assert errors[-1] < 0.002 * exact
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)
