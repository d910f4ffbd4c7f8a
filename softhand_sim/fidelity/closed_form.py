"""The finger by hand: its bending and tip force from dimensions and material sheets alone, without finite elements.

Three equal hinges, a thrust at an arm from each, and the actuator's wall as a spring along the thrust:

    p A r = k q + N(delta) r,    delta = 3 r q        (moment balance of a joint)

    A = pi r_w^2                                      thrust on the ring radius r_w: the rings do not stretch
    k = 3 mu I / g                                    Euler-Bernoulli flexure over the gap g, E = 3 mu (incompressible)
    N = pi mu_s (3 (r_o^2 - r_i^2) + r_w^4 (1 / r_i^2 - 1 / r_o^2)) delta / L
                                                      wall between inextensible rings, small stretch

The last line is the ring tube's energy (`fea.verification.ring_tube`) to second order: hoop strain
e (r_w^2 - R^2) / (2 R^2) at axial strain e, integrated over the wall. With ``finite`` the wall follows its Ogden law at
any stretch instead.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import cos, pi, sin
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, root

from softhand_sim.calibration import FingerCalibration

Vector = npt.NDArray[np.float64]
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_WIDEST_RAD = 0.5 * pi


class Strip(StrEnum):
    """Second moment of the flexure's section: two limits of what a strip cut from a tube does.

    CURVED: it keeps its section, an annular sector about its own neutral line: the stiffest.
    FLAT: it flattens as it bends, w t^3 / 12 of its developed width.
    """

    CURVED = "curved"
    FLAT = "flat"


@dataclass(frozen=True, kw_only=True)
class Wall:
    """The actuator's wall between inextensible rings: dimensions [m] and Ogden coefficients c_k [Pa], exponents a_k."""

    inner_m: float
    ring_m: float
    outer_m: float
    length_m: float
    coefficients_pa: tuple[float, ...]
    exponents: tuple[float, ...]

    @property
    def stiffness_n(self) -> float:
        """Small-stretch tension for each unit of stretch [N]."""
        shear = 0.5 * sum(c * a * a for c, a in zip(self.coefficients_pa, self.exponents, strict=True))
        i, w, o = self.inner_m, self.ring_m, self.outer_m
        return pi * shear * (3.0 * (o**2 - i**2) + w**4 * (1.0 / i**2 - 1.0 / o**2))

    def tension_n(self, lengthening_m: float) -> float:
        """Tension at any stretch [N]: dW/dl of stretches l, t(R), 1 / (l t), R^2 t^2 = r_w^2 - (r_w^2 - R^2) / l."""
        axial = 1.0 + lengthening_m / self.length_m
        half = 0.5 * (self.outer_m - self.inner_m)
        radius = self.inner_m + half * (_POINTS + 1.0)
        rest = self.ring_m**2 - radius**2
        hoop = np.sqrt(self.ring_m**2 - rest / axial) / radius
        slope = rest / (2.0 * radius**2 * hoop * axial**2)
        change = np.zeros_like(radius)
        for c, a in zip(self.coefficients_pa, self.exponents, strict=True):
            third = (axial * hoop) ** (-a - 1.0) * (hoop + axial * slope)
            change += c * a * (axial ** (a - 1.0) + hoop ** (a - 1.0) * slope - third)
        return float(half * (_WEIGHTS @ (2.0 * pi * radius * change)))


@dataclass(frozen=True, kw_only=True)
class ClosedFormFinger:
    """The finger of a calibration's geometry and materials; nothing else of the calibration is used.

    Attributes
    ----------
    area_m2, arm_m, stiffness_n_m_per_rad
        A, r and k.
    wall, finite
        The actuator's wall, and whether it is taken at its full stretch.
    joint_position_m, length_m, radius_m
        Middles of the gaps and end of the finger along it, (3,), and the tube's outer radius.
    """

    area_m2: float
    arm_m: float
    stiffness_n_m_per_rad: float
    wall: Wall
    finite: bool
    joint_position_m: tuple[float, ...]
    length_m: float
    radius_m: float

    @classmethod
    def of(cls, calibration: FingerCalibration, strip: Strip, *, finite: bool = False) -> "ClosedFormFinger":
        """Return the finger of a calibration's dimensions and materials.

        Raises
        ------
        ValueError
            If the calibration's provenance does not say its materials.
        """
        g, materials = calibration.geometry, calibration.notes["provenance"].get("materials", {})
        by_law = {m["parameters"].get("law"): m["parameters"] for m in materials.values()}
        silicone, tpu = by_law.get("ogden"), by_law.get("mooney_rivlin")
        if silicone is None or tpu is None:
            raise ValueError(f"provenance.materials = {sorted(materials)}: needs an ogden and a mooney_rivlin material")
        inner = g["actuator_outer_radius_m"] + g["clearance_m"]
        moment, arm = _section(inner, inner + g["flexure_thickness_m"], g["sector_half_angle_rad"], strip)
        return cls(
            area_m2=pi * g["ring_radius_m"] ** 2,
            arm_m=arm,
            stiffness_n_m_per_rad=3.0 * tpu["initial_shear_modulus_pa"] * moment / g["gap_length_m"],
            wall=Wall(
                inner_m=g["actuator_inner_radius_m"],
                ring_m=g["ring_radius_m"],
                outer_m=g["actuator_outer_radius_m"],
                length_m=g["actuator_length_m"] - g["cap_thickness_m"],
                coefficients_pa=_coefficients(silicone),
                exponents=tuple(silicone["alpha"]),
            ),
            finite=finite,
            joint_position_m=tuple(start + 0.5 * g["gap_length_m"] for start in g["gap_start_m"]),
            length_m=g["actuator_length_m"] + g["end_plate_m"],
            radius_m=inner + g["tube_wall_m"],
        )

    def tension_n(self, lengthening_m: float) -> float:
        """Return N [N]."""
        if self.finite:
            return self.wall.tension_n(lengthening_m)
        return self.wall.stiffness_n * lengthening_m / self.wall.length_m

    def joint_angle_rad(self, pressure_pa_gauge: float) -> float:
        """Return the angle that each joint turns in free air: explicit, or the root of the moment balance if finite."""
        thrust, r, k = pressure_pa_gauge * self.area_m2, self.arm_m, self.stiffness_n_m_per_rad
        if not self.finite:
            return thrust * r / (k + 3.0 * r * r * self.wall.stiffness_n / self.wall.length_m)
        return float(brentq(lambda q: k * q - (thrust - self.tension_n(3.0 * r * q)) * r, 0.0, _WIDEST_RAD))

    def tip_m(self, angle_rad: Vector, aside_m: float = 0.0) -> Vector:
        """Return the tip's place towards the palm side and along the straight finger [m], (2,).

        ``aside_m`` is the point's distance from the finger's axis, towards the palm side.
        """
        return hinged_tip_m(angle_rad, self.joint_position_m, self.length_m, self.arm_m, aside_m)

    def blocked_force_n(self, pressure_pa_gauge: float, distance_m: float) -> float:
        """Return the force on a frictionless wall ``distance_m`` from the palm side of the straight tip [N].

        The same balance with the wall's push F, which turns a joint back by F dx/dq; zero where the tip does not
        arrive.
        """
        limit, r, k = self.radius_m + distance_m, self.arm_m, self.stiffness_n_m_per_rad
        free = np.full(3, self.joint_angle_rad(pressure_pa_gauge))
        if self.tip_m(free, self.radius_m)[0] <= limit:
            return 0.0
        thrust = pressure_pa_gauge * self.area_m2

        def unbalanced(x: Vector) -> Vector:
            q, force = x[:3], x[3]
            drive = (thrust - self.tension_n(r * float(q.sum()))) * r
            lever = np.array([(self._edge_m(q, j, h) - self._edge_m(q, j, -h)) / (2.0 * h) for j in range(3)])
            return np.append((drive - k * q - force * lever) / k, (self.tip_m(q, self.radius_m)[0] - limit) / r)

        h = 1e-6
        found = root(unbalanced, np.append(0.5 * free, 0.1), tol=1e-10)
        if not found.success:
            raise RuntimeError(f"blocked_force_n at {pressure_pa_gauge:g} Pa: no equilibrium found")
        return float(found.x[3])

    def _edge_m(self, angle_rad: Vector, joint: int, by_rad: float) -> float:
        turned = angle_rad.copy()
        turned[joint] += by_rad
        return float(self.tip_m(turned, self.radius_m)[0])


def hinged_tip_m(
    angle_rad: Vector, joint_position_m: Sequence[float], length_m: float, hinge_offset_m: float, aside_m: float = 0.0
) -> Vector:
    """Return where the end of a finger of hinges is, towards the palm side and along the straight finger [m], (2,).

    Parameters
    ----------
    angle_rad, joint_position_m
        Angle of each hinge, and its place along the straight finger, (n,).
    length_m, hinge_offset_m
        Of the finger, and of the hinges from its axis to the palm side.
    aside_m
        The point's distance from the axis, towards the palm side.
    """
    ends = (*joint_position_m[1:], length_m)
    place, turn = np.array([hinge_offset_m, joint_position_m[0]]), 0.0
    for q, start, end in zip(angle_rad, joint_position_m, ends, strict=True):
        turn += float(q)
        place = place + (end - start) * np.array([sin(turn), cos(turn)])
    return np.asarray(place + (aside_m - hinge_offset_m) * np.array([cos(turn), -sin(turn)]))


def _section(inner_m: float, outer_m: float, half_angle_rad: float, strip: Strip) -> tuple[float, float]:
    """Return second moment [m4] of the strip and distance of its centroid from the tube's axis [m].

    An annular sector (Young & Budynas, Roark's Formulas for Stress and Strain, table A.1): area a (R2^2 - R1^2),
    centroid 2 sin a (R2^3 - R1^3) / (3 a (R2^2 - R1^2)), moment about the axis (R2^4 - R1^4) (a + sin a cos a) / 4.
    """
    a = half_angle_rad
    area = a * (outer_m**2 - inner_m**2)
    centroid = 2.0 * sin(a) * (outer_m**3 - inner_m**3) / (3.0 * area)
    if strip is Strip.FLAT:
        return area * (outer_m - inner_m) ** 2 / 12.0, centroid
    return (outer_m**4 - inner_m**4) * (a + sin(a) * cos(a)) / 4.0 - area * centroid**2, centroid


def _coefficients(ogden: Mapping[str, Any]) -> tuple[float, ...]:
    """Return c_k of W = sum c_k (l1^a_k + l2^a_k + l3^a_k - 3) [Pa] by the sheet's convention."""
    pairs = zip(ogden["mu_pa"], ogden["alpha"], strict=True)
    if ogden["convention"] == "mu_over_alpha":
        return tuple(mu / a for mu, a in pairs)
    return tuple(2.0 * mu / a**2 for mu, a in pairs)
