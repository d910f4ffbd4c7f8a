from dataclasses import replace

import numpy as np
import pytest

from fea.actuator import ActuatorMesh, actuator_model
from fea.assembly import SolidModel
from fea.lattice import Lattice, build_mesh
from fea.laws import StVenantKirchhoff
from fea.linear_solver import SymmetricSolver
from fea.load import Load
from fea.retraction import Retraction, turned_and_stretched


@pytest.fixture(scope="module")
def model(geometry, materials) -> SolidModel:
    """A short actuator with four rings."""
    length = 4 * geometry.ring_pitch_m + geometry.cap_thickness_m
    gaps = (2.1e-3, 4.3e-3, 6.5e-3)  # they play no part here and only have to fit
    short = replace(geometry, ring_count=4, actuator_length_m=length, gap_start_m=gaps, gap_length_m=1e-4)
    mesh = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)
    return actuator_model(short, materials.silicone, materials.pet, mesh)


def test_linear_step_of_a_turn_becomes_the_turn():
    lattice = Lattice(
        r_m=np.array([0.0, 1.0, 2.0]),
        theta_rad=np.linspace(0.0, np.pi, 4),
        z_m=np.linspace(0.0, 3.0, 3),
        material=np.zeros((2, 3, 2), dtype=np.int64),
    )
    mesh = build_mesh(lattice)
    fixed = np.zeros((len(mesh.points_m), 3), dtype=bool)
    fixed[np.argmin(np.abs(mesh.points_m).sum(axis=1))] = True  # one node at the origin
    law = StVenantKirchhoff(young_modulus_pa=1e9, poisson_ratio=0.3)
    retraction = Retraction(SolidModel(mesh=mesh, laws={0: law}, fixed=fixed))
    axis, angle = np.array([1.0, 2.0, 2.0]) / 3.0, 0.4
    skew = np.cross(np.eye(3), axis).T * angle
    x = mesh.points_m
    linear = x @ skew.T
    k = skew / angle
    rotation = np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k
    np.testing.assert_allclose(retraction(np.zeros_like(x), linear), x @ (rotation - np.eye(3)).T, atol=1e-12)


def test_correction_is_of_second_order(model):
    retraction, rng = Retraction(model), np.random.default_rng(1)
    u, step = np.zeros_like(model.mesh.points_m), np.zeros_like(model.mesh.points_m)
    u.reshape(-1)[model.free] = 1e-4 * rng.standard_normal(len(model.free))
    step.reshape(-1)[model.free] = 1e-4 * rng.standard_normal(len(model.free))
    sizes = [np.abs(retraction(u, t * step) - t * step).max() for t in (1e-3, 5e-4)]
    assert sizes[0] > 0.0
    assert sizes[0] / sizes[1] == pytest.approx(4.0, rel=0.05)


def test_supports_keep_theirs(model):
    step = 1e-4 * np.random.default_rng(2).standard_normal(model.mesh.points_m.shape)
    corrected = Retraction(model)(np.zeros_like(step), step)
    held = np.setdiff1d(np.arange(step.size), model.free)
    np.testing.assert_array_equal(corrected.reshape(-1)[held], step.reshape(-1)[held])


def test_volume_of_an_isochoric_increment_stays():
    F = np.eye(3) + 0.2 * np.random.default_rng(3).standard_normal((20, 3, 3))
    D = 0.05 * np.random.default_rng(4).standard_normal((20, 3, 3))
    D -= np.trace(D, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3.0
    turned = turned_and_stretched(F, D @ F)
    # exp(S) to third order: det exp(S) = exp(tr S) = 1 up to terms of the fourth, (0.15)^4 / 24 each
    np.testing.assert_allclose(np.linalg.det(turned) / np.linalg.det(F), 1.0, atol=5e-5)
    plain = np.linalg.det(F + D @ F) / np.linalg.det(F)
    assert np.abs(plain - 1.0).max() > 1e-3


def test_side_load_on_a_ringed_tube_leaves_little_imbalance(model):
    """The linear step of a dead side load stretches stiff rings; the corrected one turns them."""
    z = model.mesh.cylindrical[:, 2]
    force = np.zeros_like(model.mesh.points_m)
    top = z == z.max()
    force[top, 0] = 0.1 / top.sum()
    rest = np.zeros_like(force)
    state = model.evaluate(rest, Load())
    step = np.zeros_like(force)
    step.reshape(-1)[model.free] = SymmetricSolver().solve(state.tangent, force.reshape(-1)[model.free])
    left = []
    for u in (step, Retraction(model)(rest, step)):
        end = model.evaluate(u, Load(force_n=force), tangent=False)
        left.append(np.linalg.norm(end.internal_n - end.external_n))
    assert np.abs(step).max() > 1e-3  # a large turn: the tube is 10 mm long
    assert left[1] < 0.03 * left[0]
