"""The pads' stiffness as contact parameters of the engine.

At rest the engine's contact of a depth x pushes with (computation chapter of its documentation: R, aref, impedance)

    f = (S / dmax^2) d(x)^2 x / ((1 - d(x)) w),    solref = (-S, -B),  solimp = (d0, dmax, width, midpoint, power)

where w is the sum of the two bodies' ``body_invweight0`` [1/kg], a constant of the model. So S belongs to a pair of
bodies, and the same S is a stiffer contact on a heavier phalanx. d rises from d0 to dmax over the width, fast up to the
midpoint and then slowly, which makes the contact harden as the pad does: its force grows like the depth to the 1.35.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from softhand_sim.calibration.pad import PadCurve, PadEvidence, load_pad_evidence
from softhand_sim.checks import require_finite, require_in

Vector = npt.NDArray[np.float64]
HIGHEST_IMPEDANCE = 0.95
"""The engine's own default."""
POWER = 3.0
"""Choice: of the impedance's rise; both shipped curves are met within 8 % with 3, within 14 with 2, 25 with 1."""
_LOWEST, _MIDPOINTS = 0.05, (0.01, 0.99)
DAMPING_RATIO = 1.0
"""Choice: that of the contacts of :class:`softhand_sim.contact.ContactSettings`."""


@dataclass(frozen=True, kw_only=True)
class PadLaw:
    """One pad: force over depth where the impedance is full [N/m], impedance at touch, where it is full, midpoint.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    stiffness_n_per_m: float
    impedance: float
    width_m: float
    midpoint: float

    def __post_init__(self) -> None:
        require_finite("stiffness_n_per_m", self.stiffness_n_per_m, above=0.0)
        require_in("impedance", self.impedance, _LOWEST, HIGHEST_IMPEDANCE)
        require_finite("width_m", self.width_m, above=0.0)
        require_in("midpoint", self.midpoint, *_MIDPOINTS)

    @classmethod
    def fit(cls, curve: PadCurve) -> "PadLaw":
        """Return the law nearest to a curve: least squares of the relative error, full impedance at its last depth."""
        depth, force = curve.depth_m[1:], curve.force_n[1:]
        width = float(depth[-1])

        def law(x: Vector) -> "PadLaw":
            stiffness, impedance, midpoint = float(np.exp(x[0])), float(x[1]), float(x[2])
            return cls(stiffness_n_per_m=stiffness, impedance=impedance, width_m=width, midpoint=midpoint)

        start = [np.log(force[-1] / depth[-1]), 0.9, 0.1]
        bounds = ([-np.inf, _LOWEST, _MIDPOINTS[0]], [np.inf, HIGHEST_IMPEDANCE, _MIDPOINTS[1]])

        def error(x: Vector) -> Vector:
            return np.asarray(law(x).force_n(depth) / force - 1.0)

        return law(least_squares(error, start, bounds=bounds, xtol=1e-12, ftol=1e-12).x)

    def force_n(self, depth_m: Vector) -> Vector:
        """Return the force at rest [N] of depths of any shape."""
        x, middle = np.clip(depth_m / self.width_m, 0.0, 1.0), self.midpoint
        late = 1.0 - (1.0 - x) ** POWER / (1.0 - middle) ** (POWER - 1.0)
        rise = np.where(x < middle, x**POWER / middle ** (POWER - 1.0), late)
        d, full = self.impedance + rise * (HIGHEST_IMPEDANCE - self.impedance), HIGHEST_IMPEDANCE
        return np.asarray(self.stiffness_n_per_m * depth_m * (d / full) ** 2 * (1.0 - full) / (1.0 - d))

    def depth_m(self, force_n: float) -> float:
        """Return the depth at a force at rest [m], by bisection."""
        low, high = 0.0, max(self.width_m, force_n / self.stiffness_n_per_m)
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if float(self.force_n(np.array(middle))) < force_n else (low, middle)
        return 0.5 * (low + high)

    def solref(self, inverse_weight_per_kg: float) -> tuple[float, float]:
        """Return the engine's (-stiffness, -damping) for the sum of two bodies' ``body_invweight0``."""
        stiffness = self.stiffness_n_per_m * inverse_weight_per_kg * (1.0 - HIGHEST_IMPEDANCE)
        return -stiffness, -2.0 * DAMPING_RATIO * float(np.sqrt(stiffness))

    @property
    def solimp(self) -> tuple[float, float, float, float, float]:
        """The engine's impedance."""
        return self.impedance, HIGHEST_IMPEDANCE, self.width_m, self.midpoint, POWER


@dataclass(frozen=True, kw_only=True)
class SoftPads:
    """Pads as soft as the finite elements have them; the proximal phalanx is a tube between two joints, as the middle.

    Objects that touch with several points at once meet as many pads side by side. Pads against each other, the palm and
    the table keep the contact that they have without this.
    """

    middle: PadLaw
    distal: PadLaw

    @classmethod
    def of(cls, evidence: PadEvidence | None = None) -> "SoftPads":
        """Return the laws fitted to the curves; the shipped ones by default."""
        evidence = load_pad_evidence() if evidence is None else evidence
        return cls(middle=PadLaw.fit(evidence.curves["middle"]), distal=PadLaw.fit(evidence.curves["distal"]))

    def of_joint(self, joint: str) -> PadLaw:
        """Return the law of the phalanx that follows a joint."""
        return self.distal if joint == "distal" else self.middle
