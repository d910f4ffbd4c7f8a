"""Gas of several chambers: both valves open, chatter, a supply that is cut, a blocked finger on a shared manifold."""

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise

from scipy.optimize import brentq

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.control.onoff import OnOffController
from softhand_sim.elements import FINGERS_OF_ELEMENT
from softhand_sim.pneumatics.delay import ValveDelay
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.pneumatics.supply import Supply
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.pneumatics.tube import Tubing
from softhand_sim.stability.case import Finding, HardCase, judged
from softhand_sim.stability.gas_runs import (
    GROWTH_M3,
    REST_M3,
    Chatter,
    Script,
    breathing,
    gauge_pa,
    march,
    outside_pa,
    system_of,
    total_kg,
)

SUPPLY_PA_ABS = 250e3


def both_valves_open(timestep_s: float) -> Finding:
    """Run: a short circuit from supply to ambient: settles where the two flows are equal."""
    system = system_of(controller=Script(pattern=((True, True),)))
    # three fingers on one manifold are slow: their time constant is 1.7 s
    states = march(system, timestep_s, 20.0)
    valve = system.elements[0].inlet

    def net(p: float) -> float:
        return valve.mass_flow_kg_per_s(SUPPLY_PA_ABS, p) - valve.mass_flow_kg_per_s(p, AMBIENT_PA_ABS)

    balance = float(brentq(net, AMBIENT_PA_ABS, SUPPLY_PA_ABS))
    off = max(abs(p - balance) for p in states[-1].pressure_pa_abs)
    return judged("distance from where inflow is outflow [Pa], <= 5", off, 5.0)


def chatter(timestep_s: float) -> Finding:
    """Six valves at random at 50 Hz, fingers that move, tubes, a receiver that nothing refills: no gas may appear."""
    # the regulator gives next to nothing, so that the receiver's gas is all there is
    supply = Supply(volume_m3=2e-4, largest_flow_kg_per_s=1e-30)
    system = system_of(element={"tubing": Tubing()}, supply=supply, controller=Chatter())
    states = march(system, timestep_s, 4.0, volumes=breathing)
    # below ambient an open outlet lets air in
    gained = max(
        total_kg(b) - total_kg(a)
        for a, b in pairwise(states)
        if min(*a.pressure_pa_abs, *a.chamber_pa_abs, *b.pressure_pa_abs) > AMBIENT_PA_ABS
    )
    # moving walls compress what is shut in: by less than the fingers' own change of volume
    out = outside_pa(states, 0.5 * AMBIENT_PA_ABS, 1.3 * SUPPLY_PA_ABS)
    return judged(
        "gas from nowhere in a step, share of all, <= 1e-12", max(0.0, gained) / total_kg(states[0]) + out, 1e-12
    )


def supply_cut(timestep_s: float) -> Finding:
    """Run: the compressor stops while three elements fill: the receiver empties into them, mass is kept."""
    supply = Supply(volume_m3=2e-5, largest_flow_kg_per_s=1e-30)
    system = system_of(supply=supply, controller=Script(pattern=((True, False),)))
    states = march(system, timestep_s, 6.0)
    drift = abs(total_kg(states[-1]) / total_kg(states[0]) - 1.0)
    receiver = states[-1].supply_mass_kg[0] * system.elements[0].gas.rt_j_per_kg / supply.volume_m3
    apart = max(abs(p - receiver) for p in states[-1].pressure_pa_abs)
    return judged("mass drift, relative, <= 1e-9; all at one pressure", drift + (0.0 if apart < 50.0 else apart), 1e-9)


def one_finger_blocked(timestep_s: float) -> Finding:
    """Three fingers on a manifold, one held straight while the others grow: one pressure, unequal shares of the gas."""
    system = system_of(
        element={"tubing": Tubing()}, controller=Script(pattern=((True, False),) * 40 + ((False, False),) * 200)
    )

    def volumes(t: float) -> list[float]:
        grown = REST_M3 + GROWTH_M3 * min(1.0, t)
        return [grown, grown, grown, REST_M3, grown]

    states = march(system, timestep_s, 3.0, volumes=volumes)
    end = states[-1]
    shared = [end.chamber_pa_abs[k] for k in FINGERS_OF_ELEMENT[2]]
    spread = (max(shared) - min(shared)) / min(shared)
    free, blocked = (end.chamber_mass_kg[k] for k in (2, 3))
    half = system.elements[2].tubing.half_finger_m3()  # type: ignore[union-attr]
    ratio = (REST_M3 + half) / (REST_M3 + GROWTH_M3 + half)
    return judged(
        "pressures and gas of the blocked finger, relative, <= 1e-6", spread + abs(blocked / free / ratio - 1.0), 1e-6
    )


def everything(timestep_s: float) -> Finding:
    """Tubes, heat, leak, delay, receiver and chatter together, with fingers that move."""
    system = system_of(
        element={"tubing": Tubing(), "thermal": Polytropic()},
        supply=Supply(),
        leaks=(Leak(finger="ring"),),
        delay=ValveDelay(),
        controller=Chatter(),
        sensor=PressureSensor(),
    )
    states = march(system, timestep_s, 3.0, volumes=breathing)
    return judged(
        "pressure beyond 0.5 ambient and 1.5 supplies [Pa], <= 0",
        outside_pa(states, 0.5 * AMBIENT_PA_ABS, 1.5 * SUPPLY_PA_ABS),
        0.0,
    )


def pumped_shut_finger(timestep_s: float) -> Finding:
    """Run: a shut finger whose volume swings by a quarter at 20 Hz: p V is constant, no gas comes or goes."""
    system = system_of(controller=Script(pattern=((False, False),)))

    def volumes(t: float) -> list[float]:
        return [REST_M3 * (1.0 + 0.25 * math.sin(2.0 * math.pi * 20.0 * t))] * 5

    states = march(system, timestep_s, 2.0, volumes=volumes, start_pa_gauge=50e3)
    element, worst = system.elements[0], 0.0
    start = states[0].pressure_pa_abs[0] * (REST_M3 + element.dead_volume_m3)
    for k, state in enumerate(states):
        product = state.pressure_pa_abs[0] * (volumes(k * timestep_s)[0] + element.dead_volume_m3)
        worst = max(worst, abs(product / start - 1.0))
    return judged("p V off its start, relative, <= 1e-12", worst, 1e-12)


def control_at(set_pa: float, timestep_s: float) -> Finding:
    """Run: the ON-OFF law holds a pressure that is of the order of one pulse: no chatter, no overshoot."""
    system = replace(system_of(sensor=PressureSensor(), controller=OnOffController()), tick_s=0.02)
    states = march(system, timestep_s, 4.0, sets=[set_pa] * 3)
    late = [gauge_pa(s) for s in states[len(states) // 2 :]]
    worst = max(abs(p - set_pa) for row in late for p in row)
    return judged("distance from the set pressure in the second half [Pa], <= 2500", worst, 2500.0)


KINDS = {
    name: HardCase(name=name, hard=hard, stability="every pressure finite and positive", correctness=right, run=run)
    for name, hard, right, run in (
        (
            "both valves open",
            "supply and ambient short-circuited",
            "pressure where inflow is outflow",
            both_valves_open,
        ),
        ("valve chatter", "six valves at random at 50 Hz on fingers that move", "no gas from nowhere", chatter),
        (
            "supply cut",
            "the compressor stops while three elements fill",
            "mass kept, one pressure at the end",
            supply_cut,
        ),
        (
            "one of three fingers blocked",
            "unequal chambers on one manifold behind tubes",
            "one pressure, gas as the volumes",
            one_finger_blocked,
        ),
        ("every gas effect at once", "tubes, heat, leak, delay, receiver, chatter", "pressures bounded", everything),
        (
            "shut finger pumped at 20 Hz",
            "volume swings by a quarter within some steps",
            "p V constant",
            pumped_shut_finger,
        ),
        ("set pressure of one pulse", "2 kPa, what one tick lets in", "held within a pulse", partial(control_at, 2e3)),
    )
}
