"""What a finger's actuator loses: forces along its elongation that the engine has no element for."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.relaxation import MaxwellBranch, Relaxation
from softhand_sim.relief import ProximalRelief, Relief
from softhand_sim.sliding import SlidingFriction, sliding_friction

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LossState:
    """Slip of the friction, (n,), elongation of the relaxation's branches, (b, n), bulge of the relief, (n,) [m]."""

    slip_m: Vector
    flow_m: Vector
    bulge_m: Vector


@dataclass(frozen=True, kw_only=True)
class Losses:
    """Sliding friction, relaxation and relief; absent ones are None and cost nothing. They act on ``<finger>_loss``."""

    sliding: SlidingFriction | None
    relaxation: Relaxation | None
    relief: Relief | None = None

    @classmethod
    def of(
        cls,
        calibration: FingerCalibration,
        relaxation: tuple[MaxwellBranch, ...] = (),
        relief: ProximalRelief | None = None,
    ) -> "Losses":
        """Return the losses of a finger; by default its friction alone."""
        chamber, tendon = calibration.chamber, calibration.tendon
        return cls(
            sliding=sliding_friction(calibration.sliding, chamber),
            relaxation=Relaxation.of(tendon, relaxation) if relaxation else None,
            relief=None if relief is None else Relief(law=relief, chamber=chamber, tendon=tendon),
        )

    @property
    def any(self) -> bool:
        """Whether there is any of them."""
        return self.sliding is not None or self.relaxation is not None or self.relief is not None

    def rest(self, elongation_m: Vector) -> LossState:
        """Return the state without any force at elongations (n,)."""
        branches = 0 if self.relaxation is None else len(self.relaxation.time_s)
        return LossState(
            slip_m=elongation_m.copy(),
            flow_m=np.tile(elongation_m, (branches, 1)),
            bulge_m=np.zeros_like(elongation_m),
        )

    def step(
        self, state: LossState, elongation_m: Vector, bend_rad: Vector, pressure_pa_gauge: Vector, dt: float
    ) -> tuple[LossState, Vector]:
        """Return the next state and the force along the elongation [N], (n,).

        Parameters
        ----------
        state
            State so far.
        elongation_m, bend_rad, pressure_pa_gauge
            Elongation, sum of the joints' absolute angles, and pressure of each finger, (n,).
        dt
            Time step [s].
        """
        slip, flow, bulge, force = state.slip_m, state.flow_m, state.bulge_m, np.zeros(len(elongation_m))
        if self.sliding is not None:
            slip, force = self.sliding.step(slip, elongation_m, bend_rad, pressure_pa_gauge)
        if self.relaxation is not None:
            flow, more = self.relaxation.step(flow, elongation_m, dt)
            force = force + more
        if self.relief is not None:
            bulge, more = self.relief.step(bulge, elongation_m, pressure_pa_gauge, dt)
            force = force + more
        return LossState(slip_m=slip, flow_m=flow, bulge_m=bulge), force
