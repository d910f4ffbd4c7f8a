from dataclasses import dataclass

import numpy as np
import pytest

from fea.assembly import SolidModel
from fea.contact import ContactOptions, SurfaceContact
from fea.lattice import Lattice, build_mesh, free_faces, symmetry_nodes
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import linear_mesh
from fea.newton import NewtonOptions, Status, solve_equilibrium
from fea.workspace import workspace

RADIUS, HEIGHT, GAP = 4e-3, 3e-3, 0.15e-3
YOUNG = 1e6


def block(bottom: float, layers: int, index: int) -> Lattice:
    z = np.linspace(bottom, bottom + HEIGHT, layers + 1)
    theta = np.linspace(0.0, np.pi, 5)
    return Lattice(
        r_m=np.array([0.0, 0.5 * RADIUS, RADIUS]),
        theta_rad=theta,
        z_m=z,
        material=np.full((2, 4, layers), index, dtype=np.int64),
    )


@dataclass(frozen=True)
class Blocks:
    model: SolidModel
    contact: SurfaceContact
    lower: np.ndarray
    upper: np.ndarray
    area_m2: float

    def shifted(self, distance: float) -> np.ndarray:
        u = np.zeros_like(self.model.mesh.points_m)
        u[self.upper, 2] = -distance
        return u


@pytest.fixture(scope="module", params=["P1", "P2"])
def blocks(request) -> Blocks:
    """Two half discs, one above the other; the outer faces keep u_z, and one node of each keeps u_x."""
    mesh = build_mesh(block(0.0, 2, 0), block(HEIGHT + GAP, 1, 1))
    # four chords of 45 degrees instead of the arc
    area = {"P1": 0.5 * RADIUS**2 * 4.0 * np.sin(np.pi / 4.0), "P2": 0.5 * np.pi * RADIUS**2}[request.param]
    mesh = linear_mesh(mesh) if request.param == "P1" else mesh
    z = mesh.cylindrical[:, 2]
    fixed = np.zeros((len(z), 3), dtype=bool)
    fixed[symmetry_nodes(mesh), 1] = True
    top = 2.0 * HEIGHT + GAP
    fixed[(z == 0.0) | np.isclose(z, top), 2] = True
    fixed[(mesh.cylindrical[:, 0] == 0.0) & ((z == 0.0) | np.isclose(z, top)), 0] = True
    law = StVenantKirchhoff(young_modulus_pa=YOUNG, poisson_ratio=0.3)
    model = SolidModel(mesh=mesh, laws={0: law, 1: law}, fixed=fixed)
    faces = [free_faces(mesh, lambda c, at=at: np.isclose(c[..., 2], at)) for at in (HEIGHT, HEIGHT + GAP)]
    contact = SurfaceContact(mesh, *faces, ContactOptions(stiffness_pa=YOUNG))
    return Blocks(model, contact, z <= HEIGHT + 1e-9, z > HEIGHT + 1e-9, area)


def test_pressed_blocks_transmit_the_force_of_uniaxial_compression(blocks):
    start = blocks.shifted(0.12e-3)
    options = NewtonOptions(relative_tolerance=1e-9, max_iterations=40)
    outcome = solve_equilibrium(workspace(blocks.model), start, Load(), options, contact=blocks.contact)
    assert outcome.status is Status.CONVERGED
    reaction = blocks.model.evaluate(outcome.u_m, Load(), tangent=False).reaction_n
    push = blocks.contact.evaluate(outcome.u_m).force_n
    z = blocks.model.mesh.cylindrical[:, 2]
    ends = [reaction[z == 0.0, 2].sum(), -reaction[np.isclose(z, z.max()), 2].sum()]
    force = -push[blocks.lower, 2].sum()
    assert force > 0.0
    np.testing.assert_allclose(ends, force, rtol=1e-6)
    np.testing.assert_allclose(push.sum(axis=0), 0.0, atol=1e-9 * force)
    x = blocks.model.mesh.points_m + outcome.u_m
    gap = x[np.isclose(z, HEIGHT + GAP), 2].mean() - x[np.isclose(z, HEIGHT), 2].mean()
    strain = (0.12e-3 - (GAP - gap)) / (2.0 * HEIGHT)
    # half disc in uniaxial stress, St Venant-Kirchhoff: P = E (l^3 - l) / 2
    stretch = 1.0 - strain
    expected = 0.5 * YOUNG * (stretch - stretch**3) * blocks.area_m2
    assert force == pytest.approx(expected, rel=0.05)  # curved sides and the barrier's edge rows
    assert 0.0 < blocks.contact.minimum_gap_m(outcome.u_m, within_m=GAP) < 0.1e-3
    pressure = blocks.contact.contact_pressure_pa(outcome.u_m)
    assert np.median(pressure) == pytest.approx(force / blocks.area_m2, rel=0.05)


def test_force_and_hessian_are_derivatives_of_the_energy(blocks):
    rng = np.random.default_rng(3)
    u = blocks.shifted(0.1e-3) + rng.uniform(-5e-6, 5e-6, blocks.model.mesh.points_m.shape)
    direction = rng.standard_normal(u.shape)
    h = 1e-9
    state = blocks.contact.evaluate(u, project=False)
    slope = (blocks.contact.energy(u + h * direction) - blocks.contact.energy(u - h * direction)) / (2.0 * h)
    assert -(state.force_n * direction).sum() == pytest.approx(slope, rel=1e-5)
    change = (
        blocks.contact.evaluate(u - h * direction).force_n - blocks.contact.evaluate(u + h * direction).force_n
    ) / (2.0 * h)
    upper = state.hessian
    product = upper @ direction.ravel() + upper.T @ direction.ravel() - upper.diagonal() * direction.ravel()
    np.testing.assert_allclose(product, change.ravel(), atol=1e-5 * np.abs(change).max())


def test_projected_hessian_is_positive_semi_definite(blocks):
    u = blocks.shifted(0.1e-3)
    dofs = (3 * blocks.contact.nodes[:, None] + np.arange(3)).ravel()

    def lowest(project: bool) -> float:
        upper = blocks.contact.evaluate(u, project=project).hessian[dofs][:, dofs].toarray()
        values = np.linalg.eigvalsh(upper + np.triu(upper, 1).T)
        return values[0] / values[-1]

    assert lowest(project=True) > -1e-12
    assert lowest(project=False) < -1e-6  # so that the projection is needed


def test_no_force_and_no_energy_beyond_the_activation_distance(blocks):
    u = blocks.shifted(0.04e-3)
    assert blocks.contact.energy(u) == 0.0
    assert not blocks.contact.evaluate(u).force_n.any()
    assert blocks.contact.minimum_gap_m(u, within_m=0.12e-3) == pytest.approx(0.11e-3, abs=1e-6)


def test_step_bound_stops_before_the_surfaces_cross(blocks):
    start, through = blocks.shifted(0.0), blocks.shifted(3.0 * GAP)
    bound = blocks.contact.step_bound(start, through)
    assert 0.25 < bound < 1.0 / 3.0  # contact at a third of the way, less the method's margin
    gap = blocks.contact.minimum_gap_m(start + bound * (through - start), within_m=GAP)
    assert gap is not None
    assert gap > 0.0
    assert blocks.contact.step_bound(start, blocks.shifted(0.5 * GAP)) == 1.0


def test_surfaces_that_touch_or_start_too_near_are_refused(blocks):
    mesh = blocks.model.mesh
    face = free_faces(mesh, lambda c: np.isclose(c[..., 2], HEIGHT))
    with pytest.raises(ValueError, match="share"):
        SurfaceContact(mesh, face, face, ContactOptions())
    other = free_faces(mesh, lambda c: np.isclose(c[..., 2], HEIGHT + GAP))
    with pytest.raises(ValueError, match="activation_distance_m"):
        SurfaceContact(mesh, face, other, ContactOptions(activation_distance_m=0.2e-3))
    with pytest.raises(ValueError, match="stiffness_pa"):
        ContactOptions(stiffness_pa=-1.0)
