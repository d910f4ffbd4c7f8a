"""What acts on a body: cavity pressure, from a supply of finite stiffness if wanted, and dead nodal forces."""

from dataclasses import dataclass, replace

import numpy as np

from fea.arrays import F64


@dataclass(frozen=True, kw_only=True)
class Supply:
    """Lets the cavity's pressure fall as its volume V grows, by stiffness x (V - volume): a pump of finite capacity.

    Attributes
    ----------
    volume_m3 : float
        Volume (of the modelled part) at which the load's pressure holds.
    stiffness_pa_per_m3 : float
    """

    volume_m3: float
    stiffness_pa_per_m3: float


@dataclass(frozen=True, kw_only=True)
class Load:
    """External load: cavity pressure and dead nodal forces.

    Attributes
    ----------
    pressure_pa_gauge : float
        Gauge pressure in the cavity.
    force_n : array [n_nodes, 3] or None
        Dead nodal forces on the half model.
    supply : Supply or None
        What the pressure depends on; None: on nothing.
    """

    pressure_pa_gauge: float = 0.0
    force_n: F64 | None = None
    supply: Supply | None = None

    def pressure_at(self, volume_m3: float) -> float:
        """Return the gauge pressure in a cavity of a volume [Pa]."""
        if self.supply is None:
            return self.pressure_pa_gauge
        return self.pressure_pa_gauge + self.supply.stiffness_pa_per_m3 * (self.supply.volume_m3 - volume_m3)

    def towards(self, other: "Load", share: float) -> "Load":
        """Return the load a share of the way to another, with the other's stiffness of supply."""
        force = None
        if self.force_n is not None or other.force_n is not None:
            ours = np.zeros(1) if self.force_n is None else self.force_n
            theirs = np.zeros(1) if other.force_n is None else other.force_n
            force = ours + share * (theirs - ours)
        pressure = self.pressure_pa_gauge + share * (other.pressure_pa_gauge - self.pressure_pa_gauge)
        supply = other.supply
        if self.supply is not None and supply is not None:
            volume = self.supply.volume_m3 + share * (supply.volume_m3 - self.supply.volume_m3)
            supply = replace(supply, volume_m3=volume)
        return Load(pressure_pa_gauge=pressure, force_n=force, supply=supply)
