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
        Size of the hole. Choice: 0.6 of the default valve; at 50 kPa the inlet lets in three times what it loses.
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
