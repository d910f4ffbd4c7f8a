"""The bench tests by name: a further one is a file of its own and an entry here."""

from collections.abc import Callable

from softhand_sim.calibration import FingerCalibration, FingerEvidence
from softhand_sim.characterize.energy import energy
from softhand_sim.characterize.hysteresis import hysteresis
from softhand_sim.characterize.pressure_sweep import pressure_angle_report
from softhand_sim.characterize.relief import relief
from softhand_sim.characterize.report import Report
from softhand_sim.characterize.ring_down import ring_down
from softhand_sim.characterize.tip_force import tip_force
from softhand_sim.characterize.tip_load import tip_load
from softhand_sim.characterize.weight import weight

STUDIES: dict[str, Callable[[FingerCalibration, FingerEvidence], Report]] = {
    "pressure-angle": pressure_angle_report,
    "tip-force": tip_force,
    "tip-load": tip_load,
    "hysteresis": hysteresis,
    "energy": energy,
    "relief": relief,
    "weight": weight,
    "ring-down": ring_down,
}
