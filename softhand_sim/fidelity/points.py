"""The rungs of the scene's ladder by name: one thing changed at a time, and what is worth combining."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from softhand_sim.effects import BENCH, FULL, IDEAL, Effects
from softhand_sim.fidelity.fidelity import FINEST, Fidelity
from softhand_sim.fidelity.shapes import Shapes

FINEST_NAME, DEFAULT_NAME = "0.25 ms, noslip 10", "2 ms"

_D = Fidelity()

NUMERICS: Mapping[str, Fidelity] = MappingProxyType(
    {
        FINEST_NAME: FINEST,
        "0.5 ms, noslip 10": Fidelity(timestep_s=0.5e-3, noslip_iterations=10),
        "1 ms, noslip 10": Fidelity(timestep_s=1e-3, noslip_iterations=10),
        "1 ms": Fidelity(timestep_s=1e-3),
        "2 ms, noslip 10": replace(_D, noslip_iterations=10),
        DEFAULT_NAME: _D,
        "2 ms, noslip 0": replace(_D, noslip_iterations=0),
        "4 ms": replace(_D, timestep_s=4e-3),
        "4 ms, noslip 10": replace(_D, timestep_s=4e-3, noslip_iterations=10),
        "5 ms": replace(_D, timestep_s=5e-3),
        "8 ms": replace(_D, timestep_s=8e-3),
        "2 ms, Euler": replace(_D, integrator="Euler"),
        "2 ms, implicit": replace(_D, integrator="implicit"),
        "2 ms, RK4": replace(_D, integrator="RK4"),
        "2 ms, pyramidal": replace(_D, cone="pyramidal"),
        "2 ms, pyramidal, impratio 100": replace(_D, cone="pyramidal", impratio=100.0),
        "2 ms, impratio 1": replace(_D, impratio=1.0),
        "2 ms, impratio 100": replace(_D, impratio=100.0),
    }
)
"""Time step, integrator, cone, impratio and noslip."""

CANDIDATES = (
    FINEST_NAME,
    "0.5 ms, noslip 10",
    "1 ms, noslip 10",
    "2 ms, noslip 10",
    DEFAULT_NAME,
    "4 ms",
    "4 ms, noslip 10",
    "5 ms",
    "8 ms",
    "2 ms, impratio 100",
)
"""What `Fidelity.for_tolerance` chooses among. Choice: those that on 24 scenes no other one beat in cost and in angle
or slip, the default, and ten noslip iterations at 2 and 4 ms; the others need no more scenes."""

SHAPES: Mapping[str, Fidelity] = MappingProxyType(
    {
        "2 ms, hull": replace(_D, shapes=Shapes.HULL),
        "2 ms, fine shapes": replace(_D, shapes=Shapes.FINE),
        "2 ms, 6 links": replace(_D, links=6),
        "2 ms, 12 links": replace(_D, links=12),
        "2 ms, 24 links": replace(_D, links=24),
    }
)
"""Shapes and links: another model of the object or the finger, so no choice by tolerance."""

_EXACT = replace(BENCH, tube=FULL.tube, heat=FULL.heat, supply=FULL.supply, valve_delay=FULL.valve_delay)
EFFECTS: Mapping[str, Effects] = MappingProxyType(
    {
        "full effects": FULL,
        "pneumatics exact": _EXACT,
        "pneumatics lagged": BENCH,
        "pneumatics ideal": replace(BENCH, gas=None, sensor=None),
        "ideal effects": IDEAL,
        "full without tube": replace(FULL, tube=None),
        "full without heat": replace(FULL, heat=None),
        "full without supply": replace(FULL, supply=None),
        "full without valve delay": replace(FULL, valve_delay=None),
        "full without sensor": replace(FULL, sensor=None),
        "full without sliding": replace(FULL, sliding=None),
        "full without relaxation": replace(FULL, relaxation=None),
        "full without interference": replace(FULL, interference=None),
        "full without gravity": replace(FULL, gravity=None),
    }
)
"""Effects at the default setting, against ``full effects``; exact pneumatics have tubes, heat, supply, valve delay."""
FULL_NAME = "full effects"
