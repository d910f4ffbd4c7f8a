"""What differs from episode to episode, drawn from the environment's seed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any

from softhand_sim.checks import require_in

Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Randomization:
    """Ranges of what is drawn at a reset; object and material pair are drawn evenly from those of the environment.

    Attributes
    ----------
    position_m, yaw_rad
        Largest displacement of the object along x and along y [m], and largest turn about the vertical [rad] (even).
    mass_ratio
        Range of the object's mass over its own [-] (even).
    friction
        Range of the object's friction coefficient [-] (even); None: its own.
    leak_probability
        Probability that one finger, any, leaks from the start [-].
    leak_m3_per_s_pa
        Range of the leak's sonic conductance [m3/(s Pa)] (its logarithm even).
    valve_flow_ratio
        Range of the valves' sonic conductance over their own [-], all valves alike (its logarithm even).
    sensor_offset_pa
        Largest constant error of the sensors [Pa], all sensors alike (even).

    Raises
    ------
    ValueError
        If a range is upside down or out of bounds; the message names the field.
    """

    position_m: float = 0.010
    yaw_rad: float = math.radians(10.0)
    mass_ratio: Range = (1.0, 1.0)
    friction: Range | None = None
    leak_probability: float = 0.0
    leak_m3_per_s_pa: Range = (3e-12, 3e-11)
    valve_flow_ratio: Range = (1.0, 1.0)
    sensor_offset_pa: float = 0.0

    def __post_init__(self) -> None:
        require_in("position_m", self.position_m, 0.0, 0.1)
        require_in("yaw_rad", self.yaw_rad, 0.0, math.pi)
        require_in("leak_probability", self.leak_probability, 0.0, 1.0)
        require_in("sensor_offset_pa", self.sensor_offset_pa, 0.0, 10e3)
        ranges = {"mass_ratio": (0.01, 100.0), "leak_m3_per_s_pa": (1e-14, 1e-9), "valve_flow_ratio": (0.01, 100.0)}
        for name, (low, high) in ranges.items():
            _check_range(name, getattr(self, name), low, high)
        if self.friction is not None:
            _check_range("friction", self.friction, 0.0, 10.0)

    @classmethod
    def from_fields(cls, values: Mapping[str, Any]) -> "Randomization":
        """Return ranges from some of the fields by name, pairs as lists or tuples, as an environment's JSON has them.

        Raises
        ------
        ValueError
            If a field is unknown, or a value out of range.
        """
        if strange := sorted(set(values) - {f.name for f in fields(cls)}):
            raise ValueError(f"randomization: {strange[0]!r} is unknown")
        given: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in values.items()}
        return cls(**given)

    @property
    def of_gas(self) -> bool:
        """Whether anything drawn means nothing without gas dynamics."""
        return self.leak_probability > 0.0 or self.valve_flow_ratio != (1.0, 1.0) or self.sensor_offset_pa > 0.0


def _check_range(name: str, values: Range, low: float, high: float) -> None:
    if len(values) != 2:
        raise ValueError(f"{name} = {values!r}: must be a pair (lowest, highest)")
    for value in values:
        require_in(name, value, low, high)
    if values[0] > values[1]:
        raise ValueError(f"{name} = {values!r}: the lowest must not be above the highest")


NONE = Randomization(position_m=0.0, yaw_rad=0.0)
"""Every episode alike, but for the sensors' noise."""

PLACE = Randomization()
"""The object's place and turn, as in the paper's protocol of this project."""

DOMAIN = Randomization(
    mass_ratio=(0.8, 1.25),
    friction=(0.5, 1.0),
    leak_probability=0.1,
    valve_flow_ratio=(0.5, 2.0),
    sensor_offset_pa=3.45e3,
)
"""All of it. Choices, but for the offset, which is what the sensor's data sheet allows (1.5 % of the span): the valves'
flow is not published, so it is varied by two either way; friction was measured for no pair; a leak is at most one that
the controller can make up for."""

PRESETS: Mapping[str, Randomization] = MappingProxyType({"none": NONE, "place": PLACE, "domain": DOMAIN})
"""Presets by name."""
