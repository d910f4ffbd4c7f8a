import numpy as np
import pytest

from fea.actuator import RING, ActuatorMesh, actuator_lattice, actuator_model
from fea.assembly import element_gradients
from fea.exoskeleton import ExoskeletonMesh, exoskeleton_lattice
from fea.lattice import Lattice, build_mesh, free_faces, is_conforming

COARSE = ActuatorMesh(theta_cells=4, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)


def test_volumes_match_the_cylinders(geometry, materials):
    g = geometry
    mesh = build_mesh(actuator_lattice(g, COARSE))
    _, weights = element_gradients(mesh, 2)
    volume = 2.0 * weights.sum(axis=1)
    ring = 2 * np.pi * g.ring_radius_m * g.ring_width_m * g.ring_height_m * g.ring_count
    assert volume[mesh.material == RING].sum() == pytest.approx(ring, rel=3e-3)
    whole = np.pi * g.actuator_outer_radius_m**2 * g.actuator_length_m
    chamber = np.pi * g.actuator_inner_radius_m**2 * g.chamber_length_m
    assert volume.sum() == pytest.approx(whole - chamber, rel=3e-3)
    model = actuator_model(g, materials.silicone, materials.pet, COARSE)
    assert 2.0 * model.cavity.volume_m3(model.mesh.points_m) == pytest.approx(chamber, rel=3e-3)


def test_volume_converges_with_the_angle_of_the_cells():
    errors = []
    for cells in (3, 6):
        lattice = Lattice(
            r_m=np.array([0.0, 1.0, 2.0]),
            theta_rad=np.linspace(0, np.pi, cells + 1),
            z_m=np.array([0.0, 1.0]),
            material=np.zeros((2, cells, 1), dtype=np.int64),
        )
        _, weights = element_gradients(build_mesh(lattice), 2)
        errors.append(abs(weights.sum() - 2.0 * np.pi))
    # curved quadratic edges: the error falls with the fourth power; straight ones would give the second
    assert errors[1] < errors[0] / 12.0


def test_meshes_conform(geometry):
    for lattice in (actuator_lattice(geometry, COARSE), exoskeleton_lattice(geometry, ExoskeletonMesh())):
        mesh = build_mesh(lattice)
        assert is_conforming(mesh)
        surface = free_faces(mesh, lambda c: np.ones(c.shape[:-1], dtype=bool))
        centre = mesh.cylindrical[surface[:, :3]]
        # a free face lies on a lattice surface: all vertices share r or z, or lie in a plane of constant angle
        same = np.ptp(centre, axis=1) < 1e-12
        on_axis = (centre[..., 0] == 0.0).any(axis=1)
        assert (same.any(axis=1) | on_axis).all()


def test_removing_a_cell_breaks_conformity_checks_of_bad_lattices():
    with pytest.raises(ValueError, match="r_m must increase"):
        Lattice(
            r_m=np.array([1.0, 1.0]),
            theta_rad=np.array([0.0, np.pi]),
            z_m=np.array([0.0, 1.0]),
            material=np.zeros((1, 1, 1), dtype=np.int64),
        )
