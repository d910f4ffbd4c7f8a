import pytest

import softhand_sim  # noqa: F401 - chooses the GL library before mujoco is imported
from softhand_sim.calibration import FingerCalibration, load_calibration


@pytest.fixture(scope="session")
def calibration() -> FingerCalibration:
    return load_calibration()
