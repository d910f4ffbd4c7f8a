"""What a policy sees: the real hand's sensors, or the simulation's state."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

Vector = npt.NDArray[np.float64]


class ObservationMode(StrEnum):
    """What is observed: the real hand's sensors, the simulation's state, or that with a goal for hindsight."""

    HARDWARE = "hardware"
    STATE = "state"
    GOAL = "goal"


@dataclass(frozen=True, kw_only=True)
class Field:
    """One block of an observation: name, length, and the range that its values are clipped to."""

    name: str
    size: int
    low: float
    high: float


HARDWARE = (
    Field(name="pressure_reading_kpa_gauge", size=3, low=-82.0, high=150.0),
    Field(name="valve_open", size=6, low=0.0, high=1.0),
    Field(name="wrist_position_m", size=3, low=-1.0, high=1.0),
    Field(name="wrist_angle_rad", size=3, low=-4.5, high=4.5),
)
"""What the real hand and its arm know."""

PRIVILEGED = (
    Field(name="set_pressure_kpa_gauge", size=3, low=0.0, high=150.0),
    Field(name="pressure_kpa_gauge", size=3, low=-101.0, high=150.0),
    Field(name="joint_angle_rad", size=15, low=-2.0, high=3.0),
    Field(name="joint_velocity_rad_per_s", size=15, low=-100.0, high=100.0),
    Field(name="object_position_in_palm_m", size=3, low=-3.0, high=3.0),
    Field(name="object_quaternion_in_palm", size=4, low=-1.0, high=1.0),
    Field(name="object_velocity_m_per_s", size=3, low=-10.0, high=10.0),
    Field(name="object_angular_velocity_rad_per_s", size=3, low=-100.0, high=100.0),
    Field(name="object_height_m", size=1, low=-3.0, high=3.0),
    Field(name="object_mass_kg", size=1, low=0.0, high=100.0),
    Field(name="object_friction", size=1, low=0.0, high=10.0),
)
"""What only the simulation knows."""


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Fields one behind the other.

    Attributes
    ----------
    fields
        In their order.
    low, high
        Bounds, (n,).
    where
        Slice of each field by name.
    """

    fields: tuple[Field, ...]
    low: Vector = field(init=False)
    high: Vector = field(init=False)
    where: dict[str, slice] = field(init=False)

    def __post_init__(self) -> None:
        ends = np.cumsum([0, *(f.size for f in self.fields)]).tolist()
        where = {f.name: slice(a, b) for f, a, b in zip(self.fields, ends[:-1], ends[1:], strict=True)}
        object.__setattr__(self, "where", where)
        for name in ("low", "high"):
            bounds = [np.full(f.size, getattr(f, name)) for f in self.fields]
            object.__setattr__(self, name, np.concatenate(bounds))

    @property
    def space(self) -> spaces.Box:
        """The space of an observation, (n,)."""
        return spaces.Box(self.low, self.high, dtype=np.float64)

    def pack(self, parts: list[npt.ArrayLike]) -> Vector:
        """Return the blocks, given in the order of `fields`, as one new array, (n,), clipped to the bounds."""
        packed = np.concatenate(parts)
        # a third of np.clip's time
        np.maximum(packed, self.low, out=packed)
        np.minimum(packed, self.high, out=packed)
        return packed


def layout_of(mode: ObservationMode, commanded: tuple[Field, ...]) -> Layout:
    """Return the layout of a mode's vector; ``commanded`` are fields of a task's target.

    With a goal the target stands in ``desired_goal`` alone, so that hindsight may exchange it.
    """
    if mode is ObservationMode.HARDWARE:
        return Layout(fields=(*HARDWARE, *commanded))
    if mode is ObservationMode.STATE:
        return Layout(fields=(*HARDWARE, *PRIVILEGED, *commanded))
    return Layout(fields=(*HARDWARE, *PRIVILEGED))
