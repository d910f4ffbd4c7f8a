"""Contact problems at low density; the table in docs/ has the reference density. Sliding is in test_friction."""

import numpy as np
import pytest

from fea.lattice import free_faces
from fea.load import Load
from fea.meshes import surface_force
from fea.newton import NewtonOptions, solve_equilibrium
from fea.rubber import neo_hookean
from fea.verification.contact_blocks import Block, block_pair, drive, settings
from fea.verification.contact_hertz import boussinesq, hertz
from fea.verification.contact_patch import bonded_patch, contact_patch
from fea.workspace import workspace


def test_a_bonded_interface_carries_a_uniform_stress():
    assert bonded_patch(np.random.default_rng(1)) < 1e-9


@pytest.mark.parametrize("cells", [(4, 4), (3, 4), (5, 2)])
def test_contact_of_faces_that_do_not_match_carries_a_uniform_stress(cells):
    found = contact_patch(cells)
    assert found.worst < 1e-9
    assert found.balance < 1e-9
    assert found.moment_balance < 1e-9


def test_the_barrier_transmits_force_and_moment_and_nearly_a_uniform_stress():
    found = contact_patch((3, 4), contact="barrier")
    assert found.balance < 1e-9
    assert found.moment_balance < 1e-4 / 2.0  # noise of 0.1 um over a side of 2 mm
    assert found.spread_interface < 0.1
    assert found.spread_end < 0.02


@pytest.mark.parametrize("contact", ["segments", "barrier"])
def test_hertz(contact):
    force, radius, centre = hertz(contact=contact)
    assert force.error < 0.005
    assert radius.error < 0.03
    assert centre.error < 0.1


def test_boussinesq_settles_by_the_closed_form_and_balances():
    young, nu, r = 1e6, 0.3, 3.0
    on_surface = boussinesq(np.array([[r, 0.0, 0.0]]), 10.0)[0]
    assert on_surface[2] == pytest.approx(-10.0 * (1.0 - nu**2) / (np.pi * young * r))
    assert on_surface[0] == pytest.approx(-10.0 * (1.0 - 2.0 * nu) * (1.0 + nu) / (2.0 * np.pi * young * r))


@pytest.mark.parametrize(("contact", "friction"), [("segments", 0.0), ("segments", 0.3), ("barrier", 0.3)])
def test_opening_contact_lets_go(contact, friction):
    options = settings(contact, distance_m=0.1e-3, stiffness_pa=1e6, friction=friction)
    blocks = [
        Block(side_m=4e-3, height_m=0.5e-3, cells=3, layers=1),
        Block(side_m=2e-3, height_m=0.5e-3, cells=2, layers=1, turned_deg=17.0),
    ]
    pair = block_pair(*blocks, neo_hookean(3.3e5, 1e6), options, gap_m=0.12e-3)
    heights = 1e-3 * np.array([-0.04, -0.07, -0.05, -0.03, -0.01, 0.1])
    face = free_faces(pair.model.mesh, lambda c: np.abs(c[..., 2] - 0.5e-3) < 1e-9)
    # a load of the lower block's own: residuals are relative, and apart nothing else would be left
    load = Load(force_n=surface_force(pair.model.mesh, face, np.array([1e3, 0.0, 0.0])))
    path = np.column_stack([0.0 * heights, 0.0 * heights, heights])
    states = drive(pair, path, tolerance=1e-8, load=load)
    normal = np.array([-s.force_n[2] for s in states])
    assert normal[1] > 0.05
    assert (normal > -1e-6 * normal[1]).all()  # it never pulls
    assert abs(normal[-1]) < 1e-6 * normal[1]
    start = np.where(pair.upper[:, None], [0.0, 0.0, heights[-1]], 0.0)
    options = NewtonOptions(relative_tolerance=1e-8)
    alone = solve_equilibrium(workspace(pair.model), start, load, options)
    np.testing.assert_allclose(states[-1].u_m, alone.u_m, atol=1e-11)
