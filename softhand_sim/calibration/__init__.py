"""The finger calibration: the file through which the finite-element lab speaks to the runtime."""

from softhand_sim.calibration.parts import JOINTS
from softhand_sim.calibration.reader import FingerCalibration, load_calibration

__all__ = ["JOINTS", "FingerCalibration", "load_calibration"]
