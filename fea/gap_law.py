"""Contact pressure as a function of the gap between two surfaces."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fea.arrays import F64, I64


class GapLaw(Protocol):
    """Energy per undeformed area and its first two derivatives by the gap."""

    def energy_j_per_m2(self, gap_m: F64, face: I64, /) -> F64:
        """Return the energy at gaps [n] to faces [n] of the second surface."""
        ...

    def pressure_pa(self, gap_m: F64, face: I64, /) -> F64:
        """Return minus its slope: positive where the surfaces push each other apart."""
        ...

    def stiffness_pa_per_m(self, gap_m: F64, face: I64, /) -> F64:
        """Return its second derivative, never negative."""
        ...


@dataclass(frozen=True, kw_only=True)
class Unilateral:
    """Surfaces that may separate: p = K ((d - g) / d)^2 below the distance d, nothing beyond.

    A smooth start and no singularity: unlike a barrier it lets surfaces overlap, by d at the pressure 4 K.
    """

    stiffness_pa: float
    distance_m: float

    def __post_init__(self) -> None:
        _check(self)

    def energy_j_per_m2(self, gap_m: F64, _face: I64, /) -> F64:
        """Return K d / 3 ((d - g) / d)^3."""
        return np.asarray(self.stiffness_pa * self.distance_m / 3.0 * self._closed(gap_m) ** 3)

    def pressure_pa(self, gap_m: F64, _face: I64, /) -> F64:
        """Return the pressure [n]."""
        return np.asarray(self.stiffness_pa * self._closed(gap_m) ** 2)

    def stiffness_pa_per_m(self, gap_m: F64, _face: I64, /) -> F64:
        """Return 2 K / d (d - g) / d."""
        return np.asarray(2.0 * self.stiffness_pa / self.distance_m * self._closed(gap_m))

    def _closed(self, gap_m: F64) -> F64:
        return np.maximum(0.0, 1.0 - gap_m / self.distance_m)


@dataclass(frozen=True, kw_only=True)
class NoSeparation:
    """Surfaces that slide and keep their distance: p = K (g0 - g) / d, pushing and pulling.

    ``gap_m`` is g0, their clearance.
    """

    stiffness_pa: float
    distance_m: float
    gap_m: float

    def __post_init__(self) -> None:
        _check(self)

    def energy_j_per_m2(self, gap_m: F64, _face: I64, /) -> F64:
        """Return K / (2 d) (g0 - g)^2."""
        return np.asarray(0.5 * self.stiffness_pa / self.distance_m * (self.gap_m - gap_m) ** 2)

    def pressure_pa(self, gap_m: F64, _face: I64, /) -> F64:
        """Return the pressure [n], negative where the surfaces are held together."""
        return np.asarray(self.stiffness_pa / self.distance_m * (self.gap_m - gap_m))

    def stiffness_pa_per_m(self, gap_m: F64, _face: I64, /) -> F64:
        """Return K / d."""
        return np.full_like(gap_m, self.stiffness_pa / self.distance_m)


@dataclass(frozen=True, kw_only=True, eq=False)
class ByRegion:
    """Laws of regions of the second surface.

    Attributes
    ----------
    laws : tuple of GapLaw
    region : array [m]
        Which of them each face of the second surface has.
    """

    laws: tuple[GapLaw, ...]
    region: I64

    def energy_j_per_m2(self, gap_m: F64, face: I64, /) -> F64:
        """Return the energy [n]."""
        return self._chosen([law.energy_j_per_m2(gap_m, face) for law in self.laws], face)

    def pressure_pa(self, gap_m: F64, face: I64, /) -> F64:
        """Return the pressure [n]."""
        return self._chosen([law.pressure_pa(gap_m, face) for law in self.laws], face)

    def stiffness_pa_per_m(self, gap_m: F64, face: I64, /) -> F64:
        """Return the second derivative [n]."""
        return self._chosen([law.stiffness_pa_per_m(gap_m, face) for law in self.laws], face)

    def _chosen(self, values: list[F64], face: I64) -> F64:
        return np.asarray(np.choose(self.region[face], values))


def _check(law: Unilateral | NoSeparation) -> None:
    for name in ("stiffness_pa", "distance_m"):
        if not 0.0 < getattr(law, name) < np.inf:
            raise ValueError(f"{name} = {getattr(law, name)} must be positive and finite")
