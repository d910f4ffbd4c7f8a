"""The verification problems at densities small enough for every run; the table in docs/ has the reference density."""

import numpy as np
import pytest

from fea.newton import Status
from fea.verification.balloon import balloon, balloon_rows
from fea.verification.convergence import cylinder_error, manufactured_error
from fea.verification.cook import cook
from fea.verification.inflation import LAWS, cylinder, sphere
from fea.verification.lame import lame_cylinder
from fea.verification.patch import patch
from fea.verification.ring_tube import ring_tube
from fea.verification.treloar import treloar


@pytest.mark.parametrize("formulation", ["P1", "P2/P0", "P2/P1"])
def test_a_distorted_patch_carries_a_uniform_strain(formulation):
    error, dofs = patch(formulation, np.random.default_rng(0))
    assert dofs > 20
    assert error < 1e-9


@pytest.mark.parametrize("law", sorted(LAWS))
def test_inflated_cylinder_and_sphere(law):
    assert cylinder("P2/P0", law, cells=4).error < 5e-3
    assert sphere("P2/P0", law, cells=3, layers=3).error < 5e-3


def test_mixed_form_on_the_near_incompressible_cylinder():
    assert lame_cylinder("P2/P1", poisson_ratio=0.4995).error < 1e-3
    assert cylinder("P2/P1", "Ogden").error < 1e-3
    assert sphere("P2/P1", "Mooney-Rivlin").error < 1e-3


def test_linear_tetrahedra_lock_when_incompressible_and_do_not_otherwise():
    assert lame_cylinder("P1", poisson_ratio=0.3, cells=8).error < 0.03
    assert lame_cylinder("P1", poisson_ratio=0.4995, cells=8).error > 0.05


def test_ring_reinforced_tube():
    assert ring_tube("Ogden", stretch=1.3).error < 5e-3
    assert ring_tube("neo-Hookean", stretch=1.5).error < 5e-3


def test_cooks_membrane():
    assert cook("P2/P0", cells=10).error < 5e-3


def test_displacement_converges_with_the_third_power_of_the_element_size():
    coarse, fine = manufactured_error(3), manufactured_error(6)
    assert np.log2(coarse / fine) > 2.7
    coarse, fine = cylinder_error("P2/P1", 3), cylinder_error("P2/P1", 6)
    assert np.log2(coarse / fine) > 2.7


@pytest.mark.parametrize(("mode", "stretch"), [("uniaxial", 2.0), ("uniaxial", 6.0), ("equibiaxial", 4.0)])
def test_treloars_rubber(mode, stretch):
    assert treloar(mode, stretch).error < 2e-3


def test_balloon_goes_past_its_limit_point():
    greatest, late = balloon_rows()
    assert greatest.error < 2e-3
    assert late.error < 5e-3
    assert late.exact < 0.95 * greatest.exact  # the closed form falls beyond its maximum, and the elements follow


def test_a_limit_point_is_a_typed_outcome():
    path, closed, _ = balloon([1.3, 1.7, 2.2, 3.0, 4.0, 6.0], cells=2, stop_at_limit=True)
    assert path.status is Status.LIMIT_POINT
    assert path.limit is not None
    assert path.slope_pa_per_m3[-2] > 0.0 >= path.slope_pa_per_m3[-1]
    assert path.limit.pressure_pa_gauge >= path.pressure_pa_gauge.max()
    np.testing.assert_allclose(path.pressure_pa_gauge, closed, rtol=1e-2)
    before, _, _ = balloon([1.2, 1.4], cells=2, stop_at_limit=True)
    assert before.status is Status.CONVERGED
    assert before.limit is None


@pytest.mark.parametrize("volumes", [[], [0.9], [1.5, 1.2]])
def test_volumes_must_grow(volumes):
    with pytest.raises(ValueError, match="volumes_m3"):
        balloon(volumes, cells=2)
