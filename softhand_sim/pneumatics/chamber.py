"""A given mass of ideal gas at constant temperature in a given volume."""

from dataclasses import dataclass

from softhand_sim.air import R_SPECIFIC_J_PER_KG_K, ROOM_TEMPERATURE_K
from softhand_sim.checks import require_finite


@dataclass(frozen=True, kw_only=True)
class Chamber:
    """Isothermal ideal gas, ``p V = m R T``; the volume is the caller's, the mass is the state.

    Choice: isothermal. In a bore of d = 3 to 8 mm the gas takes the wall's temperature within about
    ``d**2 / (23 a)`` = 0.02 to 0.13 s (slowest conduction mode of a cylinder, thermal diffusivity of air
    a = 2.1e-5 m2/s), which is shorter than a fill.

    Raises
    ------
    ValueError
        If a parameter is not positive.
    """

    temperature_k: float = ROOM_TEMPERATURE_K
    r_specific_j_per_kg_k: float = R_SPECIFIC_J_PER_KG_K

    def __post_init__(self) -> None:
        require_finite("temperature_k", self.temperature_k, above=0.0)
        require_finite("r_specific_j_per_kg_k", self.r_specific_j_per_kg_k, above=0.0)

    @property
    def rt_j_per_kg(self) -> float:
        """``R T`` [J/kg]."""
        return self.r_specific_j_per_kg_k * self.temperature_k

    def pressure_pa_abs(self, mass_kg: float, volume_m3: float) -> float:
        """Return the absolute pressure [Pa] of ``mass_kg`` in ``volume_m3``."""
        return mass_kg * self.rt_j_per_kg / volume_m3

    def mass_kg(self, pressure_pa_abs: float, volume_m3: float) -> float:
        """Return the mass [kg] that gives ``pressure_pa_abs`` in ``volume_m3``."""
        return pressure_pa_abs * volume_m3 / self.rt_j_per_kg
