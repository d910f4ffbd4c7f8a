"""Gas at its limits: no volume, no air, no end of flow, and a hole larger than the valve."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.outcome import ControlOutcome, control_outcome
from softhand_sim.control.protocol import ValveCommand
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.stability.case import Finding, HardCase, judged
from softhand_sim.stability.gas_runs import Script, march, outside_pa, still, system_of

SUPPLY_PA_ABS, SET_PA = 250e3, 50e3
HOLE = Orifice(sonic_conductance_m3_per_s_pa=3e-10)


def leak_larger_than_supply(timestep_s: float) -> Finding:
    """Run: a hole of six times the valve: settles where inflow is outflow, and the controller's judge says so."""
    system = system_of(
        leaks=(Leak(finger="index", orifice=HOLE),), controller=OnOffController(), sensor=PressureSensor()
    )
    states = march(system, timestep_s, 8.0, sets=[SET_PA] * 3)
    inlet = system.elements[1].inlet

    def net(p: float) -> float:
        return inlet.mass_flow_kg_per_s(SUPPLY_PA_ABS, p) - HOLE.mass_flow_kg_per_s(p, AMBIENT_PA_ABS)

    balance = float(brentq(net, AMBIENT_PA_ABS, SUPPLY_PA_ABS))
    late = states[len(states) // 2 :]
    every = max(1, round(0.02 / timestep_s))
    told = control_outcome(
        np.array([s.readings_pa_abs[1] - AMBIENT_PA_ABS for s in late[::every]]),
        SET_PA,
        [s.valves[1] for s in late[::every]],
        2e3,
    )
    off = abs(states[-1].pressure_pa_abs[1] - balance)
    typed = "SATURATED" if told is ControlOutcome.SATURATED and off < 50.0 else ""
    return judged("distance from where inflow is outflow [Pa], <= 50, and told as saturated", off, -1.0, typed=typed)


def _volumeless(volume_m3: float, timestep_s: float) -> Finding:
    system = system_of(element={"dead_volume_m3": 0.0}, controller=Script(pattern=((True, False), (False, True))))
    states = march(system, timestep_s, 1.0, volumes=lambda _t: [volume_m3] * 5)
    out = outside_pa(states, AMBIENT_PA_ABS - 1.0, SUPPLY_PA_ABS + 1.0)
    return judged("pressure beyond ambient and supply [Pa], <= 0", out, 0.0)


def chamber_without_volume(timestep_s: float) -> Finding:
    """Run: a chamber of a thousandth of a cubic millimetre, filled and emptied: an infinitely stiff equation."""
    return _volumeless(1e-12, timestep_s)


def chamber_of_no_volume(timestep_s: float) -> Finding:
    """Run: a volume of zero is no chamber: refused by name."""
    try:
        return _volumeless(0.0, timestep_s)
    except ValueError as error:
        return judged("refused", 0.0, -1.0, typed=f"REFUSED: {error}")


def vacuum(timestep_s: float) -> Finding:
    """Vented into 1 Pa: pressure falls by five decades and may not go below zero."""
    element = {"ambient_pa_abs": 1.0, "supply_pa_abs": 1e5, "compliance_m3_per_pa": 0.0}
    pattern = ((True, False),) * 25 + ((False, True),) * 200
    states = march(system_of(element=element, controller=Script(pattern=pattern)), timestep_s, 4.4)
    out = outside_pa(states, 1.0 - 1e-9, 1e5)
    valve = system_of(element=element).elements[0]
    # choked venting: m falls as exp(-k R T / V t) as long as p > p_ambient / b
    rate = valve.outlet.choked_coefficient_kg_per_s_pa * valve.gas.rt_j_per_kg / (still(0.0)[0] + valve.dead_volume_m3)
    after = math.ceil(0.52 / timestep_s)
    first, last = states[after].pressure_pa_abs[0], states[-1].pressure_pa_abs[0]
    expected = max(1.0, first * math.exp(-rate * (len(states) - 1 - after) * timestep_s))
    # backward Euler lags an exponential by half a step's decay a step
    off = abs(math.log(last / expected)) / max(1.0, math.log(first / expected))
    return judged("exponent of the decay, relative to the closed form, <= 0.02 and nothing below 1 Pa", off + out, 0.02)


def huge_valve(timestep_s: float) -> Finding:
    """Run: a valve of 20,000 times the flow: a step would overshoot by orders of magnitude if it were explicit."""
    big = Orifice(sonic_conductance_m3_per_s_pa=1e-6)
    pattern = ((True, False), (False, True), (False, False))
    states = march(
        system_of(element={"inlet": big, "outlet": big}, controller=Script(pattern=pattern)), timestep_s, 1.0
    )
    out = outside_pa(states, AMBIENT_PA_ABS - 1.0, SUPPLY_PA_ABS + 1.0)
    return judged("pressure beyond ambient and supply [Pa], <= 0", out, 0.0)


def stretchy_walls(timestep_s: float) -> Finding:
    """Walls that bulge by their whole volume at 20 kPa: p V(p) is a parabola, and mass must still be kept."""
    system = system_of(
        element={"compliance_m3_per_pa": 2e-10}, controller=Script(pattern=((True, False),) * 30 + ((False, False),))
    )
    states = march(system, timestep_s, 1.2)
    element, drift = system.elements[0], 0.0
    for state in states:
        again = element.mass_kg(state.pressure_pa_abs[0], still(0.0)[0])
        drift = max(drift, abs(again / state.mass_kg[0] - 1.0))
    out = outside_pa(states, AMBIENT_PA_ABS - 1.0, SUPPLY_PA_ABS + 1.0)
    return judged("mass off p V(p) / RT, relative, <= 1e-9", drift + out, 1e-9)


def sensor_saturated(timestep_s: float) -> Finding:
    """Run: a supply beyond the sensor's range, and a set value that the sensor cannot see."""
    system = system_of(element={"supply_pa_abs": 400e3}, sensor=PressureSensor(), controller=OnOffController())
    try:
        march(system, timestep_s, 0.1, sets=[200e3] * 3)
    except ValueError as error:
        return judged("refused", 0.0, -1.0, typed=f"REFUSED: {error}")
    return judged("refused", 1.0, 0.0, detail="a set value beyond the sensor was taken")


def sensor_at_its_end(timestep_s: float) -> Finding:
    """Run: the set value at the sensor's very end, the supply beyond it: readings clip there."""
    system = system_of(element={"supply_pa_abs": 400e3}, sensor=PressureSensor(), controller=OnOffController())
    highest = system.highest_set_pa_gauge[0]
    states = march(system, timestep_s, 6.0, sets=[highest] * 3)
    over = max(p for s in states for p in s.pressure_pa_abs) - 250e3
    return judged("pressure beyond the sensor's end [Pa], <= 5000", max(0.0, over), 5e3)


def stuck_inlet(timestep_s: float) -> Finding:
    """Run: an inlet that never shuts: the element ends at the supply's pressure, not beyond it."""
    system = replace(system_of(), controller=Script(pattern=((True, False),)))
    states = march(system, timestep_s, 12.0)
    assert states[-1].valves[0] == ValveCommand(True, False)
    off = max(abs(p - SUPPLY_PA_ABS) for p in states[-1].pressure_pa_abs)
    return judged(
        "distance from the supply [Pa], <= 5, and never above", off + outside_pa(states, 0.0, SUPPLY_PA_ABS + 1e-6), 5.0
    )


def _case(name: str, hard: str, correctness: str, run: Callable[[float], Finding]) -> HardCase:
    return HardCase(
        name=name, hard=hard, stability="every pressure finite and positive", correctness=correctness, run=run
    )


KINDS = {
    case.name: case
    for case in (
        _case(
            "leak larger than supply",
            "hole of six times the valve",
            "pressure where inflow is outflow, told as SATURATED",
            leak_larger_than_supply,
        ),
        _case(
            "chamber volume near zero",
            "1e-12 m3 and no tubes: infinitely stiff",
            "pressure within ambient and supply",
            chamber_without_volume,
        ),
        _case("chamber volume zero", "no volume at all", "refused by name", chamber_of_no_volume),
        _case("vacuum", "vented into 1 Pa, five decades down", "exponential decay of choked flow", vacuum),
        _case(
            "valve 20,000 times too large",
            "fills in a hundredth of a step",
            "pressure within ambient and supply",
            huge_valve,
        ),
        _case("walls that bulge by their volume", "p V(p) is a parabola", "mass is p V(p) / RT", stretchy_walls),
        _case(
            "set pressure beyond the sensor",
            "the sensor saturates below the set value",
            "refused by name",
            sensor_saturated,
        ),
        _case(
            "set pressure at the sensor's end",
            "readings clip at the set value, the supply is far above",
            "pressure stays within 5 kPa of the range",
            sensor_at_its_end,
        ),
        _case("inlet stuck open", "the controller has no say", "the supply's pressure, never more", stuck_inlet),
    )
}
