"""Compiled flow laws: `Orifice`, `Tube`, and the heat that goes with them (`Warmed`)."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import inner

F64 = npt.NDArray[np.float64]


@inner
def _orifice(o: F64, reservoir: float, chamber: float) -> tuple[float, float]:
    """`Orifice.inflow_and_slope`."""
    k, b, laminar = o[0], o[1], o[2]
    if chamber <= reservoir:
        ratio = chamber / reservoir
        if ratio <= b:
            return k * reservoir, 0.0
        if ratio < laminar:
            s = (ratio - b) / (1.0 - b)
            root = math.sqrt(1.0 - s * s)
            return k * reservoir * root, -k * s / ((1.0 - b) * root)
    else:
        ratio = reservoir / chamber
        if ratio <= b:
            return -k * chamber, -k
        if ratio < laminar:
            s = (ratio - b) / (1.0 - b)
            root = math.sqrt(1.0 - s * s)
            return -k * chamber * root, -k * (root + ratio * s / ((1.0 - b) * root))
    return o[3] * (reservoir - chamber), -o[3]


@inner
def heat_flow(o: F64, reservoir: float, chamber: float, warmth: float) -> tuple[float, float]:
    """Flow and slope of an orifice to a reservoir at room temperature, weighed by heat."""
    flow, slope = _orifice(o, reservoir, chamber)
    if warmth != 1.0 and flow <= 0.0:
        weight = math.sqrt(warmth)
        return weight * flow, weight * slope
    return flow, slope


@inner
def mass_flow(o: F64, reservoir: float, chamber: float, warmth: float) -> float:
    """Mass flow of an orifice from a reservoir at room temperature into a chamber."""
    flow, _ = _orifice(o, reservoir, chamber)
    return flow / math.sqrt(warmth) if warmth != 1.0 and flow <= 0.0 else flow


@inner
def tube_flow(e: Any, difference: float) -> tuple[float, float]:
    """`Tube.flow_and_slope` of an element's branch."""
    size = abs(difference)
    if size <= e.crossing:
        return e.laminar * difference, e.laminar
    flow = e.crossing_flow * (size / e.crossing) ** (4.0 / 7.0)
    return math.copysign(flow, difference), 4.0 / 7.0 * flow / size
