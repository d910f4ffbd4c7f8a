"""Flow of gas through a round tube: laminar or turbulent, in either direction."""

import math
from dataclasses import dataclass, field

from softhand_sim.air import R_SPECIFIC_J_PER_KG_K, ROOM_TEMPERATURE_K, VISCOSITY_PA_S
from softhand_sim.checks import require_finite

TUBE_BORE_M = 3e-3
"""Bore of the air tubes [m] (the paper's "air tubes with 3 mm diameter", read as the inner one)."""

SHARED_TUBE_M = 0.5
"""Length of the tube from an element's valves to its manifold [m]. Choice: control board beside the wrist."""

FINGER_TUBE_M = 0.5
"""Length of each finger's own tube from the manifold [m]. Choice: forearm to palm."""

# Blasius' friction factor 0.316 Re^-1/4 meets the laminar 64 / Re here
_CROSSING_RE = (64.0 / 0.316) ** (4.0 / 3.0)


@dataclass(frozen=True, kw_only=True)
class Tube:
    """Isothermal friction flow of an ideal gas in a smooth round tube.

    With ``D = p1 |p1| - p2 |p2|`` and a Darcy friction factor f the momentum balance, without the gas's own
    acceleration (a few percent of the drop only above Mach 0.1), integrates to
    ``D = 16 f L R T q^2 / (pi^2 d^5)`` (for instance White, *Fluid Mechanics*, isothermal flow in long pipes):

    - laminar, f = 64 / Re (Hagen-Poiseuille): ``q = pi d^4 D / (256 mu L R T)``;
    - turbulent, f = 0.316 / Re^(1/4) (Blasius): ``q`` as ``D^(4/7)``.

    The larger of both factors is taken. They meet at Re = 1190, so that the flow has no jump; a real tube may
    stay laminar up to Re = 2300, with the default valve Re stays under 700.

    Attributes
    ----------
    length_m, bore_m
        Length and inner diameter [m].
    temperature_k
        Temperature of the gas [K].

    Raises
    ------
    ValueError
        If a parameter is not positive.
    """

    length_m: float
    bore_m: float = TUBE_BORE_M
    temperature_k: float = ROOM_TEMPERATURE_K
    laminar_kg_per_s_pa2: float = field(init=False, repr=False, compare=False)
    crossing_kg_per_s: float = field(init=False, repr=False, compare=False)
    crossing_pa2: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("length_m", "bore_m", "temperature_k"):
            require_finite(name, getattr(self, name), above=0.0)
        rt = R_SPECIFIC_J_PER_KG_K * self.temperature_k
        laminar = math.pi * self.bore_m**4 / (256.0 * VISCOSITY_PA_S * self.length_m * rt)
        crossing = _CROSSING_RE * math.pi * self.bore_m * VISCOSITY_PA_S / 4.0
        object.__setattr__(self, "laminar_kg_per_s_pa2", laminar)
        object.__setattr__(self, "crossing_kg_per_s", crossing)
        object.__setattr__(self, "crossing_pa2", crossing / laminar)

    @property
    def volume_m3(self) -> float:
        """Volume of the bore [m3]."""
        return math.pi / 4.0 * self.bore_m**2 * self.length_m

    def mass_flow_kg_per_s(self, from_pa_abs: float, to_pa_abs: float) -> float:
        """Return the flow [kg/s] from one end to the other; negative when it runs back."""
        return self.inflow_and_slope(from_pa_abs, to_pa_abs)[0]

    def inflow_and_slope(self, reservoir_pa_abs: float, chamber_pa_abs: float) -> tuple[float, float]:
        """Return the flow into a chamber [kg/s] and its derivative by the chamber's pressure [kg/(s Pa)]."""
        flow, slope = self.flow_and_slope(reservoir_pa_abs**2 - chamber_pa_abs**2)
        return flow, -2.0 * chamber_pa_abs * slope

    def flow_and_slope(self, difference_pa2: float) -> tuple[float, float]:
        """Return the flow [kg/s] for a difference of squared pressures [Pa2], and its derivative by it."""
        size = abs(difference_pa2)
        if size <= self.crossing_pa2:
            return self.laminar_kg_per_s_pa2 * difference_pa2, self.laminar_kg_per_s_pa2
        flow = self.crossing_kg_per_s * (size / self.crossing_pa2) ** (4.0 / 7.0)
        return math.copysign(flow, difference_pa2), 4.0 / 7.0 * flow / size


@dataclass(frozen=True, kw_only=True)
class Tubing:
    """Tubes of one element: one from the valves to the manifold, and one from there to each finger.

    Attributes
    ----------
    shared_length_m, finger_length_m
        Lengths [m].
    bore_m
        Inner diameter of all of them [m].

    Raises
    ------
    ValueError
        If the fingers' tubes have no length or no bore, or the shared one a negative length.
    """

    shared_length_m: float = SHARED_TUBE_M
    finger_length_m: float = FINGER_TUBE_M
    bore_m: float = TUBE_BORE_M

    def __post_init__(self) -> None:
        require_finite("shared_length_m", self.shared_length_m, at_least=0.0)
        require_finite("finger_length_m", self.finger_length_m, above=0.0)
        require_finite("bore_m", self.bore_m, above=0.0)

    def volume_m3(self, fingers: int) -> float:
        """Return the volume [m3] of all tubes of an element."""
        return math.pi / 4.0 * self.bore_m**2 * (self.shared_length_m + fingers * self.finger_length_m)

    def half_finger_m3(self) -> float:
        """Return half the volume [m3] of one finger's own tube: the part that is reckoned to its chamber."""
        return math.pi / 8.0 * self.bore_m**2 * self.finger_length_m

    def branch(self, fingers: int) -> Tube:
        """Return the tube that has the resistance from the valves to one of the element's fingers.

        The shared tube carries the flow of all fingers; to each of them it resists like a tube ``fingers`` times as
        long (exact in laminar flow shared equally), so that the network is a star.
        """
        return Tube(length_m=self.finger_length_m + fingers * self.shared_length_m, bore_m=self.bore_m)


def tube_volume_m3(fingers: int) -> float:
    """Return the gas volume [m3] of an element's default tubes."""
    return Tubing().volume_m3(fingers)
