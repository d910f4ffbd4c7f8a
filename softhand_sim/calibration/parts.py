"""Parts of the finger calibration: joints, tendon, chamber, rigid body, pressure-angle curve."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softhand_sim.checks import require_finite

JOINTS: tuple[str, ...] = ("proximal", "middle", "distal")
"""Joints of a finger, from its base."""

BRANCHES = ("loading", "unloading")
"""Branches of a pressure cycle."""

JOINT_RANGE_RAD = (-0.35, 1.4)
"""Choice: just above what the calibrated curve holds, so that ctrl never asks for an extrapolation."""


@dataclass(frozen=True, kw_only=True)
class JointCalibration:
    """One hinge: torque ``-(a q + b q^2 + c q^3)`` at angle ``q`` [rad], and the arm ``r(q)`` of the tendon.

    The arm is that of a line through two points, one on either side of the hinge: ``offset_m`` to its back, and twice
    the slope past it. ``r = r0 cos(q / 2) + 2 r1 sin(q / 2)`` with the offset r0 and the slope r1 when straight.
    """

    name: str
    offset_m: float
    offset_slope_m_per_rad: float
    stiffness_n_m_per_rad: float
    stiffness_n_m_per_rad2: float
    stiffness_n_m_per_rad3: float
    damping_n_m_s_per_rad: float

    def __post_init__(self) -> None:
        require_finite("offset_m", self.offset_m, above=0.0)
        # the line's two points must not meet where the joint may go
        least = 0.5 * self.offset_m * math.tan(0.5 * JOINT_RANGE_RAD[1])
        require_finite("offset_slope_m_per_rad", self.offset_slope_m_per_rad, above=least)
        require_finite("damping_n_m_s_per_rad", self.damping_n_m_s_per_rad, at_least=0.0)
        a = require_finite("stiffness_n_m_per_rad", self.stiffness_n_m_per_rad, at_least=0.0)
        b = require_finite("stiffness_n_m_per_rad2", self.stiffness_n_m_per_rad2)
        c = require_finite("stiffness_n_m_per_rad3", self.stiffness_n_m_per_rad3, at_least=0.0)
        # a + 2 b q + 3 c q^2 >= 0 for all q; the margin is for decimal rounding of a fit on the boundary
        if b * b > 3.0 * a * c * (1.0 + 1e-9):
            raise ValueError(f"stiffness_n_m_per_rad2 = {b!r}: torque must be monotone, b^2 <= 3 a c = {3.0 * a * c:g}")

    def elongation_m_at(self, angle_rad: float) -> float:
        """Return the arm's integral from 0 to an angle [m], what this joint lengthens the tendon by."""
        half = 0.5 * angle_rad
        grown = 4.0 * self.offset_slope_m_per_rad * (1.0 - math.cos(half))
        return 2.0 * self.offset_m * math.sin(half) + grown

    @property
    def polynomial(self) -> tuple[float, float, float]:
        """Stiffness coefficients (a, b, c) [N m/rad, N m/rad2, N m/rad3]."""
        return self.stiffness_n_m_per_rad, self.stiffness_n_m_per_rad2, self.stiffness_n_m_per_rad3


@dataclass(frozen=True, kw_only=True)
class TendonCalibration:
    """The actuator's wall: tension ``N = a d + b d^2 + c d^3`` at elongation ``d`` [m]."""

    stiffness_n_per_m: float
    stiffness_n_per_m2: float
    stiffness_n_per_m3: float

    def __post_init__(self) -> None:
        require_finite("stiffness_n_per_m", self.stiffness_n_per_m, at_least=0.0)
        require_finite("stiffness_n_per_m2", self.stiffness_n_per_m2)
        require_finite("stiffness_n_per_m3", self.stiffness_n_per_m3)

    @property
    def polynomial(self) -> tuple[float, float, float]:
        """Stiffness coefficients (a, b, c) [N/m, N/m2, N/m3]."""
        return self.stiffness_n_per_m, self.stiffness_n_per_m2, self.stiffness_n_per_m3

    def slope_n_per_m_at(self, elongation_m: float) -> float:
        """Return ``dN/dd`` [N/m]."""
        a, b, c = self.polynomial
        return a + 2.0 * b * elongation_m + 3.0 * c * elongation_m**2


@dataclass(frozen=True, kw_only=True)
class ChamberCalibration:
    """Chamber: ``V = V0 + A d + B d^2 / 2 + C p`` at elongation ``d`` [m]; tendon force ``p dV/dd``.

    ``C p``, with the gauge pressure, is the wall's bulging between the rings, which takes gas and moves nothing.
    """

    volume_m3: float
    area_m2: float
    area_slope_m: float
    bulging_m3_per_pa: float

    def __post_init__(self) -> None:
        require_finite("volume_m3", self.volume_m3, above=0.0)
        require_finite("area_m2", self.area_m2, above=0.0)
        require_finite("area_slope_m", self.area_slope_m)
        require_finite("bulging_m3_per_pa", self.bulging_m3_per_pa, at_least=0.0)

    def volume_m3_at(self, elongation_m: float) -> float:
        """Return the chamber's volume without bulging [m3] at an elongation [m]."""
        return self.volume_m3 + elongation_m * (self.area_m2 + 0.5 * self.area_slope_m * elongation_m)

    def volumes_m3(self, elongation_m: npt.NDArray[np.float64]) -> list[float]:
        """Return `volume_m3_at` elongations [m], (n,)."""
        # a few plain numbers are quicker than small arrays
        return [self.volume_m3_at(d) for d in elongation_m.tolist()]

    def area_m2_at(self, elongation_m: float) -> float:
        """Return the effective area ``dV/dd`` [m2] at an elongation [m]."""
        return self.area_m2 + self.area_slope_m * elongation_m


@dataclass(frozen=True, kw_only=True)
class SlidingCalibration:
    """Friction of the actuator in the exoskeleton: at most a share of the thrust for each radian of bending.

    Below that it is a spring of ``stiffness_n_per_m``. Zeros where no way back was analysed.
    """

    coefficient_per_rad: float
    stiffness_n_per_m: float

    def __post_init__(self) -> None:
        coefficient = require_finite("coefficient_per_rad", self.coefficient_per_rad, at_least=0.0)
        if coefficient > 0.0:
            require_finite("stiffness_n_per_m", self.stiffness_n_per_m, above=0.0)
        else:
            require_finite("stiffness_n_per_m", self.stiffness_n_per_m, at_least=0.0)


@dataclass(frozen=True, kw_only=True)
class FingerBody:
    """Rigid dimensions; ``joint_position_m`` (3,) are hinge centres along the finger from its base plane."""

    length_m: float
    joint_position_m: tuple[float, ...]
    outer_radius_m: float
    mass_kg: float
    hinge_offset_m: float

    def __post_init__(self) -> None:
        for name in ("length_m", "outer_radius_m", "mass_kg"):
            require_finite(name, getattr(self, name), above=0.0)
        require_finite("hinge_offset_m", self.hinge_offset_m, at_least=0.0)
        x = self.joint_position_m
        ends = (0.0, *x, self.length_m)
        if len(x) != len(JOINTS) or not all(low < high for low, high in pairwise(ends)):
            raise ValueError(f"joint_position_m = {list(x)}: must be 3 increasing positions in (0, {self.length_m:g})")


@dataclass(frozen=True, kw_only=True, eq=False)
class CalibrationCurve:
    """The surrogate's own equilibrium while loading, without gravity.

    Attributes
    ----------
    pressure_pa_gauge
        Pressures [Pa gauge], (n,), increasing from 0 or above.
    tip_angle_deg
        Tip angle [deg], (n,), increasing; the sum of the joint angles.
    joint_angle_deg
        Joint angles, proximal to distal [deg], (n, 3).
    """

    pressure_pa_gauge: npt.NDArray[np.float64]
    tip_angle_deg: npt.NDArray[np.float64]
    joint_angle_deg: npt.NDArray[np.float64]

    def __post_init__(self) -> None:
        n = len(self.pressure_pa_gauge)
        if n < 2:
            raise ValueError(f"pressure_pa_gauge has {n} points: must have at least 2")
        if self.tip_angle_deg.shape != (n,):
            raise ValueError(f"tip_angle_deg has shape {self.tip_angle_deg.shape}: must be ({n},)")
        if self.joint_angle_deg.shape != (n, 3):
            raise ValueError(f"joint_angle_deg has shape {self.joint_angle_deg.shape}: must be ({n}, 3)")
        for name in ("pressure_pa_gauge", "tip_angle_deg"):
            values = getattr(self, name)
            falls = np.flatnonzero(np.diff(values) <= 0.0)
            if falls.size:
                k = int(falls[0])
                pair = f"{values[k]:g} then {values[k + 1]:g}"
                raise ValueError(f"{name}[{k + 1}]: {pair}: must be strictly increasing")
        if self.pressure_pa_gauge[0] < 0.0:
            raise ValueError(f"pressure_pa_gauge[0] = {self.pressure_pa_gauge[0]:g}: must be >= 0")
        off = np.abs(self.joint_angle_deg.sum(axis=1) - self.tip_angle_deg)
        if off.max() > 0.01:
            k = int(off.argmax())
            raise ValueError(
                f"tip_angle_deg[{k}] = {self.tip_angle_deg[k]:g}: must be the sum of the joint angles, "
                f"{self.joint_angle_deg[k].sum():g}"
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class FingerCycle:
    """The finite-element finger under pressure up and down: rows (n,), joint angles (n, 3), the unloaded state first.

    ``fitted`` says which rows the identification saw, (n,); None where it is not known.
    """

    branch: tuple[str, ...]
    pressure_pa_gauge: npt.NDArray[np.float64]
    joint_angle_rad: npt.NDArray[np.float64]
    chamber_volume_m3: npt.NDArray[np.float64]
    fitted: tuple[bool, ...] | None = None

    def __post_init__(self) -> None:
        rows = len(self.pressure_pa_gauge)
        for name in ("branch", "joint_angle_rad", "chamber_volume_m3", "fitted"):
            column = getattr(self, name)
            if column is not None and len(column) != rows:
                raise ValueError(f"{name} has {len(column)} rows: must have {rows}")
        unknown = sorted(set(self.branch) - set(BRANCHES))
        if unknown:
            raise ValueError(f"branch = {unknown[0]!r}: must be one of {list(BRANCHES)}")
        up = self.loading
        if not up[: up.sum()].all() or up.sum() < 2 or (np.diff(self.pressure_pa_gauge[up]) <= 0.0).any():
            raise ValueError("pressure_pa_gauge: must rise over the loading rows, which come first")
        if (np.diff(self.pressure_pa_gauge[up.sum() - 1 :]) >= 0.0).any():
            raise ValueError("pressure_pa_gauge: must fall over the unloading rows")

    @property
    def loading(self) -> npt.NDArray[np.bool_]:
        """Rows on the way up, (n,)."""
        return np.array([branch == "loading" for branch in self.branch])

    @property
    def unseen(self) -> npt.NDArray[np.bool_]:
        """Loaded rows on the way up that the identification did not see, (n,); all of them where it is not known."""
        seen = np.zeros(len(self.branch), dtype=bool) if self.fitted is None else np.array(self.fitted)
        return np.asarray(self.loading & ~seen & (self.pressure_pa_gauge > 0.0))

    @property
    def tip_angle_deg(self) -> npt.NDArray[np.float64]:
        """Sum of the joint angles [deg], (n,)."""
        return np.asarray(np.degrees(self.joint_angle_rad.sum(axis=1)))
