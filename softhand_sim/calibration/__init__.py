"""The finger calibration: the file through which the finite-element lab speaks to the runtime."""

from softhand_sim.calibration.evidence import FingerEvidence, load_evidence
from softhand_sim.calibration.parts import (
    JOINT_RANGE_RAD,
    JOINTS,
    ChamberCalibration,
    SlidingCalibration,
    TendonCalibration,
)
from softhand_sim.calibration.reader import FingerCalibration, load_calibration
from softhand_sim.calibration.weight import WeightEvidence, load_weight_evidence

__all__ = [
    "JOINTS",
    "JOINT_RANGE_RAD",
    "ChamberCalibration",
    "FingerCalibration",
    "FingerEvidence",
    "SlidingCalibration",
    "TendonCalibration",
    "WeightEvidence",
    "load_calibration",
    "load_evidence",
    "load_weight_evidence",
]
