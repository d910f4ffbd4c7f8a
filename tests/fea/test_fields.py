import numpy as np
import pytest

from fea.assembly import SolidModel
from fea.fields import node_strain, point_positions, von_mises_fields
from fea.lattice import Lattice, build_mesh
from fea.laws import IsochoricOgden, StVenantKirchhoff


@pytest.fixture(scope="module")
def block() -> SolidModel:
    lattice = Lattice(
        r_m=np.array([1.0, 2.0, 3.0]),
        theta_rad=np.linspace(0, np.pi, 4),
        z_m=np.array([0.0, 1.0, 3.0]),
        material=np.array([[[0, 1]] * 3, [[1, 0]] * 3]),
    )
    mesh = build_mesh(lattice)
    law = IsochoricOgden(coefficients_pa=(2.0e5,), exponents=(1.7,), bulk_modulus_pa=1e7)
    return SolidModel(mesh=mesh, laws={0: law, 1: law}, fixed=np.zeros((len(mesh.points_m), 3), dtype=bool))


def moved(model, F):
    return model.mesh.points_m @ (F - np.eye(3)).T


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


@pytest.mark.parametrize("stretch", [0.7, 1.5])
def test_uniaxial_stretch_has_its_closed_forms_at_any_rotation(block, stretch):
    F = turn(1.1) @ np.diag([stretch**-0.5, stretch**-0.5, stretch])
    fields = von_mises_fields(block, moved(block, F))
    assert fields.strain == pytest.approx(np.full(fields.strain.shape, abs(np.log(stretch))), rel=1e-9)
    assert node_strain(block, moved(block, F)) == pytest.approx(abs(np.log(stretch)), rel=1e-9)
    # tension of an incompressible Ogden material: sigma = c a (l^a - l^(-a/2))
    stress = abs(2.0e5 * 1.7 * (stretch**1.7 - stretch ** (-0.85)))
    assert fields.element_stress_pa() == pytest.approx(np.full(len(fields.strain), stress), rel=1e-9)


@pytest.mark.parametrize("law", [None, StVenantKirchhoff(young_modulus_pa=1e6, poisson_ratio=0.3)])
def test_rigid_motion_and_dilatation_leave_no_von_mises_measure(block, law):
    laws = block.laws if law is None else {0: law, 1: law}
    model = SolidModel(mesh=block.mesh, laws=laws, fixed=np.zeros((len(block.mesh.points_m), 3), dtype=bool))
    for F in (turn(2.0), 1.3 * turn(0.4)):
        fields = von_mises_fields(model, moved(model, F))
        assert fields.strain.max() < 1e-7
        assert fields.stress_pa.max() < 0.1


def test_node_strain_is_exact_where_strain_varies_linearly(block):
    """Pure axial stretch 1 + a z of straight fibres: at each vertex ln-strains follow from its own height."""
    a = 0.05
    u = np.zeros_like(block.mesh.points_m)
    u[:, 2] = 0.5 * a * block.mesh.points_m[:, 2] ** 2
    expected = 2.0 / 3.0 * np.log(1.0 + a * block.mesh.points_m[:, 2])
    vertices = np.unique(block.mesh.elements[:, :4])
    assert node_strain(block, u)[vertices] == pytest.approx(expected[vertices], abs=3e-3)


def test_positions_lie_inside_their_elements_and_carry_the_volume(block):
    r = point_positions(block)[..., 0]
    assert 1.0 < r.min() < r.max() < 3.0
    # integral of r over the half tube: pi (27 - 1) / 3 x 3
    assert (r * block.weights).sum() == pytest.approx(np.pi * 26.0, rel=5e-3)
