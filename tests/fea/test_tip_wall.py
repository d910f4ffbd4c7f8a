from dataclasses import replace

import numpy as np
import pytest

from fea.actuator import ActuatorMesh
from fea.exoskeleton import ExoskeletonMesh
from fea.finger import FingerMesh, analyse_finger, finger_model
from fea.finger_path import FingerPath
from fea.newton import Status
from fea.tip_wall import TipWall, tip_wall

MESH = FingerMesh(
    actuator=ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1),
    exoskeleton=ExoskeletonMesh(sector_cells=2, rest_cells=2, wall_cells=1, gap_cells=2, segment_cells=1),
)


def test_force_and_hessian_are_derivatives_of_the_energy():
    rng = np.random.default_rng(0)
    wall = TipWall(points_m=rng.random((6, 3)), nodes=np.array([1, 2, 4, 5]), position_m=0.5, stiffness_n_per_m=30.0)
    u, way, h = rng.standard_normal((6, 3)), rng.standard_normal((6, 3)), 1e-6
    state = wall.evaluate(u)
    slope = (wall.energy(u + h * way) - wall.energy(u - h * way)) / (2.0 * h)
    assert slope == pytest.approx(-float((state.force_n * way).sum()), rel=1e-7)
    bend = (wall.evaluate(u + h * way).force_n - wall.evaluate(u - h * way).force_n) / (2.0 * h)
    np.testing.assert_allclose(-bend.ravel(), state.hessian @ way.ravel(), atol=1e-7)
    assert wall.push_n(u) == pytest.approx(-state.force_n[:, 0].sum())


def test_tip_stops_at_the_sensor_and_presses_on_it(geometry, materials):
    """Before the tip arrives it is free; then the force grows with pressure and the tip stays where the sensor is."""
    g = replace(geometry, ring_count=22)
    model = finger_model(g, materials.silicone, materials.pet, materials.tpu, MESH)
    distance = 2e-3
    wall = tip_wall(model.solid.mesh, g, distance_m=distance)
    free = analyse_finger(model, g, FingerPath((1.5e3, 6e3)))
    held = analyse_finger(model, g, FingerPath((1.5e3, 6e3, 8e3)), wall=wall)
    assert held.status is Status.CONVERGED
    np.testing.assert_allclose(held.tip_angle_rad[1], free.tip_angle_rad[1], rtol=1e-3)
    assert held.tip_force_n[1] == 0.0
    assert 0.0 < held.tip_force_n[2] < held.tip_force_n[3]
    x = model.solid.mesh.points_m[wall.nodes, 0] + held.u_m[wall.nodes, 0]
    assert wall.position_m < x.max() < wall.position_m + 0.1e-3
    assert held.tip_angle_rad[2] < 0.8 * free.tip_angle_rad[2]


def test_bad_distances_are_refused(geometry, materials):
    model = finger_model(replace(geometry, ring_count=22), materials.silicone, materials.pet, materials.tpu, MESH)
    with pytest.raises(ValueError, match="distance_m"):
        tip_wall(model.solid.mesh, geometry, distance_m=0.0)
