"""A scene without an object: the hand in the air closes to set angles and holds them."""

import time
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.checks import require_finite, require_in
from softhand_sim.effects.build import TICK_S, apply_to_model, build_losses, build_pneumatics
from softhand_sim.effects.effects import Effects
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.simulation import HandSimulation

_POSE = (0.0, 0.0, 0.4, 0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class BareHand:
    """Palm down in the air, the fingers are told their angles at once; angles count after `close_s`, for `hold_s`.

    Attributes
    ----------
    set_angle_deg: of thumb, index, middle-ring-little [deg].
    close_s, hold_s: times [s].
    """

    set_angle_deg: tuple[float, float, float]
    close_s: float = 3.0
    hold_s: float = 10.0

    def __post_init__(self) -> None:
        for angle in self.set_angle_deg:
            require_in("set_angle_deg", angle, 0.0, 180.0)
        require_finite("close_s", self.close_s, above=0.0)
        require_finite("hold_s", self.hold_s, above=0.0)

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "BareHand":
        """Draw angles from 20 to 95 degrees, 3 to 5 s of closing and 5 to 20 s of holding."""
        thumb, index, rest = rng.uniform(20.0, 95.0, size=3).tolist()
        close_s, hold_s = float(rng.uniform(3.0, 5.0)), float(rng.uniform(5.0, 20.0))
        return cls(set_angle_deg=(thumb, index, rest), close_s=close_s, hold_s=hold_s)

    def set_pa_gauge(self, calibration: FingerCalibration) -> npt.NDArray[np.float64]:
        """Return the pressures that belong to the angles [Pa gauge], (3,)."""
        return np.array([calibration.closing_pressure(angle) for angle in self.set_angle_deg])

    def run(
        self,
        calibration: FingerCalibration,
        effects: Effects,
        seed: int,
        *,
        engine: EngineSettings | None = None,
        links: int | None = None,
    ) -> tuple[npt.NDArray[np.float64], float]:
        """Return tip angles while they count [deg], (n, 5), every 20 ms, and the processor time of the run [s].

        Samples are a whole number of time steps apart: where 20 ms are none, what comes next to it.
        """
        root = build_root(calibration, engine=engine, links=links)
        apply_to_model(effects, root)
        simulation = HandSimulation(
            model=compile_scene(root).model,
            calibration=calibration,
            pneumatics=build_pneumatics(effects, calibration),
            losses=build_losses(effects, calibration),
        )
        simulation.reset(np.random.default_rng(seed), np.array(_POSE))
        simulation.set_pressure_pa_gauge = self.set_pa_gauge(calibration)
        steps, rows = max(1, round(TICK_S / simulation.dt)), []
        period_s = steps * simulation.dt
        began = time.thread_time()
        for _ in range(round((self.close_s + self.hold_s) / period_s)):
            simulation.advance(steps)
            rows.append(np.degrees(simulation.tip_angles_rad()))
        return np.array(rows)[round(self.close_s / period_s) :], time.thread_time() - began
