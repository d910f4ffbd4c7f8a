"""A leak: a hole in a finger's actuator that opens at a given time."""

from dataclasses import dataclass, field

from softhand_sim.checks import require_finite
from softhand_sim.elements import FINGERS
from softhand_sim.pneumatics.orifice import Orifice


@dataclass(frozen=True, kw_only=True)
class Leak:
    """An orifice from a finger's chamber to ambient.

    Attributes
    ----------
    finger
        Name of the finger.
    orifice
        Size of the hole. Choice: a third of the default valve, which a controlled element can make up for.
    start_s
        Time since the reset at which it opens [s].

    Raises
    ------
    ValueError
        If there is no such finger, or the time is negative.
    """

    finger: str
    orifice: Orifice = field(default_factory=lambda: Orifice(sonic_conductance_m3_per_s_pa=3e-11))
    start_s: float = 0.0

    def __post_init__(self) -> None:
        if self.finger not in FINGERS:
            raise ValueError(f"finger = {self.finger!r}: must be one of {', '.join(FINGERS)}")
        require_finite("start_s", self.start_s, at_least=0.0)
