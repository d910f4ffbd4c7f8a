"""Constants of the working gas: dry air at room conditions."""

R_SPECIFIC_J_PER_KG_K = 287.05
"""Specific gas constant of dry air [J/(kg K)]: 8.31446 J/(mol K) over 28.965 g/mol
(U.S. Standard Atmosphere 1976 gives 287.05)."""

ROOM_TEMPERATURE_K = 293.15
"""Gas temperature [K]: 20 C, which is also the reference temperature T0 of ISO 6358 (ISO 8778)."""

AMBIENT_PA_ABS = 101_325.0
"""Ambient pressure [Pa abs]: one standard atmosphere (ISO 2533)."""

REFERENCE_DENSITY_KG_PER_M3 = 1.185
"""Density rho0 [kg/m3] of air in the reference atmosphere of ISO 8778 (20 C, 100 kPa, 65 % humidity), in
which ISO 6358 states sonic conductances."""

VISCOSITY_PA_S = 1.813e-5
"""Dynamic viscosity of air at 20 C [Pa s] (Sutherland's formula of the U.S. Standard Atmosphere 1976)."""

HEAT_CAPACITY_RATIO = 1.4
"""Ratio of specific heats of air [-]: the exponent of an adiabatic change of state."""
