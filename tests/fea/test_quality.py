import numpy as np
import pytest

from fea.actuator import RING, SILICONE, actuator_lattice
from fea.density import DENSITIES
from fea.exoskeleton import TPU, exoskeleton_lattice
from fea.lattice import Lattice, build_mesh
from fea.quality import element_size_m, mean_ratio, mesh_quality


def test_mean_ratio_of_known_tetrahedra():
    regular = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    flat = corner * [1, 1, 1e-6]
    ratio = mean_ratio(np.stack([regular, 7e-3 * regular, corner, flat]))
    # corner of a cube: 12 (3 / 6)^(2/3) / 9
    assert ratio == pytest.approx([1.0, 1.0, 12.0 * 0.5 ** (2 / 3) / 9.0, 0.0], abs=1e-3)


def test_straight_elements_have_an_even_jacobian_and_curved_ones_improve_with_the_angle():
    worst = []
    for cells in (3, 6, 12):
        lattice = Lattice(
            r_m=np.array([4.0, 5.0]),
            theta_rad=np.linspace(0, np.pi, cells + 1),
            z_m=np.array([0.0, 1.0]),
            material=np.zeros((1, cells, 1), dtype=np.int64),
        )
        worst.append(mesh_quality(build_mesh(lattice)).scaled_jacobian_min)
    assert 0.3 < worst[0] < worst[1] < worst[2] < 1.0


@pytest.mark.parametrize("name", sorted(DENSITIES))
def test_meshes_of_every_density_keep_their_quality(geometry, name):
    # choice: bounds a little under what the shipped densities have; coarse rings are long and thin
    bound = {"coarse": 0.08, "calibration": 0.08, "reference": 0.3}[name]
    density = DENSITIES[name]
    for lattice in (actuator_lattice(geometry, density.actuator), exoskeleton_lattice(geometry, density.exoskeleton)):
        quality = mesh_quality(build_mesh(lattice))
        assert quality.mean_ratio_min > bound
        assert quality.mean_ratio_mean > 0.15
        assert quality.scaled_jacobian_min > 0.4


def test_reference_density_has_the_paper_s_element_sizes(geometry):
    density = DENSITIES["reference"]
    actuator = actuator_lattice(geometry, density.actuator)
    assert element_size_m(actuator, RING) <= 1.0e-3
    assert element_size_m(actuator, SILICONE) <= 1.5e-3
    assert element_size_m(exoskeleton_lattice(geometry, density.exoskeleton), TPU) <= 2.5e-3
