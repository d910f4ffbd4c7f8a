from dataclasses import replace

import numpy as np
import pytest

from fea.actuator import ActuatorMesh, actuator_model
from fea.assembly import SolidModel
from fea.load import Load
from fea.newton import NewtonOptions, solve_equilibrium
from fea.workspace import workspace

OPTIONS = NewtonOptions(relative_tolerance=1e-6, max_iterations=30)


@pytest.fixture(scope="module")
def model(geometry, materials) -> SolidModel:
    """A slim actuator with eight rings that is free to bend."""
    rings = 8
    length = rings * geometry.ring_pitch_m + geometry.cap_thickness_m
    slim = replace(
        geometry, ring_count=rings, actuator_length_m=length, gap_start_m=(2.1e-3, 4.3e-3, 6.5e-3), gap_length_m=1e-4
    )
    mesh = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)
    return actuator_model(slim, materials.silicone, materials.pet, mesh)


def test_a_step_cut_short_carries_its_share_of_the_load_and_goes_on(model):
    zero, load = np.zeros_like(model.mesh.points_m), Load(pressure_pa_gauge=5e3)
    whole = solve_equilibrium(workspace(model), zero, load, OPTIONS, balanced=Load())
    capped = replace(OPTIONS, step_cap_m=0.3 * float(np.abs(whole.u_m).max()), max_iterations=60)
    short = solve_equilibrium(workspace(model), zero, load, capped, balanced=Load())
    assert short.converged
    assert short.iterations > whole.iterations
    np.testing.assert_allclose(short.u_m, whole.u_m, atol=1e-5 * float(np.abs(whole.u_m).max()))


def test_deflating_to_nothing_converges(model):
    zero, load = np.zeros_like(model.mesh.points_m), Load(pressure_pa_gauge=5e3)
    work = workspace(model)
    up = solve_equilibrium(work, zero, load, OPTIONS, balanced=Load())
    down = solve_equilibrium(work, up.u_m, Load(), OPTIONS, balanced=load)
    assert down.converged
    assert np.abs(down.u_m).max() < 1e-5 * np.abs(up.u_m).max()


def test_loads_between_two_loads():
    force = np.array([[1.0, 2.0, 3.0]])
    there = Load(pressure_pa_gauge=10.0).towards(Load(pressure_pa_gauge=20.0, force_n=force), 0.25)
    assert there.pressure_pa_gauge == 12.5
    np.testing.assert_allclose(there.force_n, 0.25 * force)
    back = Load(force_n=force).towards(Load(), 0.25)
    np.testing.assert_allclose(back.force_n, 0.75 * force)
    assert Load().towards(Load(), 0.5).force_n is None
