"""How the gas lies in arrays: an element's parameters, and the columns and rows of nodes.

Nodes: manifolds of the elements first, 0 to 2, then, where the tubes resist, the chambers of the fingers, 3 to 7.
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import sources_field
from softhand_sim.elements import ELEMENTS, FINGERS, FINGERS_OF_ELEMENT
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.supply import Supply

F64 = npt.NDArray[np.float64]

MANIFOLDS, NODES = len(ELEMENTS), len(ELEMENTS) + len(FINGERS)
RECEIVER = NODES
"""Column of the receiver's mass in the gas."""
GAS_SHAPE = (3, NODES + 1)
GAS_MASS, GAS_INVARIANT, GAS_PRESSURE = range(3)
"""Rows of the gas: mass [kg], invariant of `Polytropic`, pressure [Pa abs]."""

SCRATCH_SHAPE = (NODES, 9)
STIFF, SOFT, CAPACITY, GROWTH, CONTENT, PRESSURE, WARMTH, MASS, GUESS = range(9)
"""Columns of a node's scratch, as in `Vessel`, and the pressure from which the next search starts."""

ELEMENT = np.dtype(
    [
        ("inlet", "f8", 4),
        ("outlet", "f8", 4),
        *((name, "f8") for name in ("dead", "bulging", "supply", "ambient", "rt", "half", "laminar")),
        *((name, "f8") for name in ("crossing_flow", "crossing", "exponent", "wall")),
        ("first", "i8"),
        ("fingers", "i8"),
        sources_field(Path(__file__).parent, Path(__file__).parents[2] / "actuation"),
    ]
)
"""Parameters of an element. Orifices: choked coefficient, b, laminar ratio and coefficient. ``half`` is the volume of
half a finger's tube, 0 where tubes don't resist; ``exponent`` is 1 for isothermal gas."""


def orifice_row(orifice: Orifice) -> tuple[float, float, float, float]:
    """Return an orifice's parameters in the order of `ELEMENT`."""
    return (
        orifice.choked_coefficient_kg_per_s_pa,
        orifice.critical_pressure_ratio,
        orifice.laminar_pressure_ratio,
        orifice.laminar_coefficient_kg_per_s_pa,
    )


def element_records(elements: Sequence[Element]) -> npt.NDArray[np.void]:
    """Return the parameters of the elements, shape (3,); their fingers follow one another in ``FINGERS``."""
    records = np.zeros(len(elements), ELEMENT)
    for record, e, members in zip(records, elements, FINGERS_OF_ELEMENT, strict=True):
        record["inlet"], record["outlet"] = orifice_row(e.inlet), orifice_row(e.outlet)
        record["dead"], record["bulging"] = e.dead_volume_m3, e.compliance_m3_per_pa
        record["supply"], record["ambient"], record["rt"] = e.supply_pa_abs, e.ambient_pa_abs, e.gas.rt_j_per_kg
        record["first"], record["fingers"] = members[0], len(members)
        record["exponent"], record["wall"] = 1.0, math.inf
        if e.tubing is not None:
            tube = e.tubing.branch(len(members))
            record["half"], record["laminar"] = e.tubing.half_finger_m3(), tube.laminar_kg_per_s_pa2
            record["crossing_flow"], record["crossing"] = tube.crossing_kg_per_s, tube.crossing_pa2
        if e.thermal is not None:
            wall = e.thermal.wall_time_constant_s
            record["exponent"], record["wall"] = e.thermal.exponent, math.inf if wall is None else wall
    return records


def receiver_row(supply: Supply | None) -> F64:
    """Return volume [m3], largest flow [kg/s] and droop [Pa] of a finite supply, shape (3,); (0,) without one."""
    if supply is None:
        return np.zeros(0)
    return np.array([supply.volume_m3, supply.largest_flow_kg_per_s, supply.droop_pa])
