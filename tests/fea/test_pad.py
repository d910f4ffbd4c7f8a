"""The pads' indentation: the sphere against Hertz and against energy, the section's symmetry of force, bad input."""

import numpy as np
import pytest

from fea.assembly import SolidModel
from fea.indenter import SphereIndenter
from fea.lattice import free_faces
from fea.laws import StVenantKirchhoff
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.newton import NewtonOptions, solve_equilibrium
from fea.pad import PadMesh, press
from fea.workspace import workspace

COARSE = PadMesh(pressed_z_cells=2, pressed_theta_cells=3, rest_theta_cells=3, wall_cells=1)


def test_sphere_on_a_block_is_hertz():
    """F = 4/3 E* sqrt(R) d^(3/2) (Johnson, Contact Mechanics, ch. 4); a quarter of a block larger than the patch."""
    young, nu, radius, depth = 1e6, 0.3, 50e-3, 0.08e-3
    patch = np.sqrt(radius * depth)
    edges = patch * np.array([0.0, 0.33, 0.67, 1.0, 1.4, 2.2, 4.0, 8.0, 16.0])
    mesh = sweep(rectangle(edges, edges), -edges[[0, 1, 2, 4, 5, 6, 7, 8]][::-1])
    fixed = np.abs(mesh.points_m) < 1e-12
    fixed[:, 2] = False
    fixed[np.isclose(mesh.points_m[:, 2], -edges[-1])] = True
    law = StVenantKirchhoff(young_modulus_pa=young, poisson_ratio=nu)
    model = SolidModel(mesh=mesh, laws={0: law}, fixed=fixed)
    top = free_faces(mesh, lambda c: (np.abs(c[..., 2]) < 1e-12) & (c[..., :2] < 2.5 * patch).all(axis=-1))
    sphere = SphereIndenter(
        points_m=mesh.points_m,
        faces=top,
        centre_m=np.array([0.0, 0.0, radius - depth]),
        radius_m=radius,
        stiffness_pa_per_m=3e11,
    )
    options = NewtonOptions(relative_tolerance=1e-6, max_iterations=40)
    outcome = solve_equilibrium(workspace(model), np.zeros_like(mesh.points_m), Load(), options, contact=sphere)
    assert outcome.converged
    force = -4.0 * sphere.force_n(outcome.u_m)[:, 2].sum()
    exact = 4.0 / 3.0 * young / (1.0 - nu**2) * np.sqrt(radius) * depth**1.5
    # the block is 16 patches deep: Boussinesq's field is cut off there
    assert force == pytest.approx(exact, rel=0.1)


def test_forces_of_the_sphere_are_those_of_its_energy():
    rng = np.random.default_rng(0)
    edges = np.linspace(0.0, 1e-3, 3)
    mesh = sweep(rectangle(edges, edges), np.array([-1e-3, 0.0]))
    top = free_faces(mesh, lambda c: np.abs(c[..., 2]) < 1e-12)
    sphere = SphereIndenter(
        points_m=mesh.points_m,
        faces=top,
        centre_m=np.array([4e-4, 3e-4, 4.9e-3]),
        radius_m=5e-3,
        stiffness_pa_per_m=1e9,
    )
    u, way = (1e-5 * rng.standard_normal(mesh.points_m.shape) for _ in range(2))
    h = 1e-6
    slope = (sphere.energy(u + h * way) - sphere.energy(u - h * way)) / (2.0 * h)
    assert -float((sphere.force_n(u) * way).sum()) == pytest.approx(slope, rel=1e-6)
    upper = sphere.evaluate(u, project=False).hessian.toarray()
    full = upper + np.triu(upper, 1).T
    change = (sphere.force_n(u + h * way) - sphere.force_n(u - h * way)).ravel() / (2.0 * h)
    assert -full @ way.ravel() == pytest.approx(change, rel=1e-5, abs=1e-6 * np.abs(change).max())


def test_wall_hardens_and_the_actuator_behind_it_helps(geometry, materials):
    depths = (0.1e-3, 0.4e-3)
    bare = press(geometry, materials, "middle", mesh=COARSE, depths_m=depths, actuator=False)
    assert (np.diff(bare.force_n) > 0.0).all()
    # more than in proportion: the patch grows
    assert bare.force_n[2] > 4.2 * bare.force_n[1]
    # a ring of the tube's wall over a length of its diameter, thin-ring formula, is of the same order
    modulus, radius, wall = 4.4e6, 6.7e-3, 2e-3
    ring = modulus * wall**3 / 12.0 / (0.149 * radius**3) * 2.0 * radius
    assert 0.5 * ring < bare.force_n[2] / depths[1] < 5.0 * ring


@pytest.mark.parametrize(
    ("section", "depths", "named"), [("proximal", (1e-4,), "section"), ("distal", (2e-4, 1e-4), "depths_m")]
)
def test_bad_input_is_refused_by_name(geometry, materials, section, depths, named):
    with pytest.raises(ValueError, match=named):
        press(geometry, materials, section, depths_m=depths)
