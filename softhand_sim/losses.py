"""What a finger's actuator loses: forces along its elongation that the engine has no element for."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.relaxation import MaxwellBranch, Relaxation
from softhand_sim.sliding import SlidingFriction, sliding_friction

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LossState:
    """Slip of the friction [m], (n,), and elongation of the relaxation's branches [m], (b, n), of n fingers."""

    slip_m: Vector
    flow_m: Vector


@dataclass(frozen=True, kw_only=True)
class Losses:
    """Sliding friction and relaxation; absent ones are None and cost nothing. The force goes to ``<finger>_loss``."""

    sliding: SlidingFriction | None
    relaxation: Relaxation | None

    @classmethod
    def of(cls, calibration: FingerCalibration, relaxation: tuple[MaxwellBranch, ...] = ()) -> "Losses":
        """Return the losses of a finger; by default its friction alone."""
        return cls(
            sliding=sliding_friction(calibration.sliding, calibration.chamber),
            relaxation=Relaxation.of(calibration.tendon, relaxation) if relaxation else None,
        )

    def rest(self, elongation_m: Vector) -> LossState:
        """Return the state without any force at elongations (n,)."""
        branches = 0 if self.relaxation is None else len(self.relaxation.time_s)
        return LossState(slip_m=elongation_m.copy(), flow_m=np.tile(elongation_m, (branches, 1)))

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
        slip, flow, force = state.slip_m, state.flow_m, np.zeros(len(elongation_m))
        if self.sliding is not None:
            slip, force = self.sliding.step(slip, elongation_m, bend_rad, pressure_pa_gauge)
        if self.relaxation is not None:
            flow, more = self.relaxation.step(flow, elongation_m, dt)
            force = force + more
        return LossState(slip_m=slip, flow_m=flow), force
