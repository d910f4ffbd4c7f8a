"""Relaxation of the actuator's wall: Maxwell branches beside the tendon's spring. An effect that is off by default."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import TendonCalibration
from softhand_sim.checks import require_finite

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MaxwellBranch:
    """Spring and dashpot in series: stiffness for that of the wall at rest, and time until its force is down to 1/e."""

    stiffness_ratio: float
    time_s: float

    def __post_init__(self) -> None:
        require_finite("stiffness_ratio", self.stiffness_ratio, above=0.0)
        require_finite("time_s", self.time_s, above=0.0)


CONDITIONED_SILICONE = (
    MaxwellBranch(stiffness_ratio=0.03, time_s=0.5),
    MaxwellBranch(stiffness_ratio=0.03, time_s=10.0),
)
"""Choice: no Prony series of Ecoflex 00-50 was found in an open source. Z. Liao et al. report, from thermo-viscoelastic
experiments on Ecoflex, considerable relaxation of virgin samples only, and next to none of samples that were stretched
before. Hence a few percent, one part within a step of the paper's step test (5 s) and one beyond it."""


@dataclass(frozen=True, kw_only=True)
class Relaxation:
    """Overstress of the walls of fingers (n,), in branches (b,); the branches' own elongation is the state, (b, n).

    A branch that is held keeps no force, so angles at rest stay those of the calibration; it dissipates
    ``k (d - z)^2 / tau`` and gives nothing back but what its spring stores.
    """

    stiffness_n_per_m: Vector
    time_s: Vector

    @classmethod
    def of(cls, tendon: TendonCalibration, branches: tuple[MaxwellBranch, ...]) -> "Relaxation":
        """Return the relaxation of a finger's wall.

        Raises
        ------
        ValueError
            If there is no branch.
        """
        if not branches:
            raise ValueError("branches = (): must be one or more; leave the relaxation out instead")
        ratio = np.array([branch.stiffness_ratio for branch in branches])
        return cls(
            stiffness_n_per_m=tendon.stiffness_n_per_m * ratio, time_s=np.array([branch.time_s for branch in branches])
        )

    def step(self, flow_m: Vector, elongation_m: Vector, dt: float) -> tuple[Vector, Vector]:
        """Return the branches' elongations [m], (b, n), and their force along the elongation [N], (n,), after a step.

        Exact for an elongation that stands still over the step.
        """
        kept = np.exp(-dt / self.time_s)[:, None]
        flow = elongation_m + kept * (flow_m - elongation_m)
        return flow, -self.stiffness_n_per_m @ (elongation_m - flow)
