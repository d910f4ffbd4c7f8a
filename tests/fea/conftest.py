import pytest

from fea.calibration import Materials, load_materials
from fea.density import DENSITIES
from fea.exoskeleton import ExoskeletonResult, analyse_exoskeleton, exoskeleton_model
from fea.geometry import FingerGeometry


@pytest.fixture(scope="session")
def geometry() -> FingerGeometry:
    return FingerGeometry()


@pytest.fixture(scope="session")
def materials() -> Materials:
    return load_materials()


@pytest.fixture(scope="session")
def exoskeleton(geometry: FingerGeometry, materials: Materials) -> ExoskeletonResult:
    model = exoskeleton_model(geometry, materials.tpu, DENSITIES["coarse"].exoskeleton)
    return analyse_exoskeleton(model, geometry, materials.tpu)
