import numpy as np
import pytest

from fea.density import DENSITIES
from fea.exoskeleton import LOADS_N, analyse_exoskeleton, exoskeleton_model
from fea.newton import Status


def test_all_loads_of_the_paper_converge_and_bend_towards_the_palm(exoskeleton):
    assert exoskeleton.status is Status.CONVERGED
    np.testing.assert_allclose(exoskeleton.load_n, [0.0, *LOADS_N], atol=1e-12)
    assert exoskeleton.tip_deflection_m[0] > 1e-3  # self-weight alone
    assert (np.diff(exoskeleton.tip_deflection_m) > 0.0).all()


def test_deformation_concentrates_at_the_proximal_joint(exoskeleton):
    angle = exoskeleton.angle_rad
    assert (angle[:, 0] > 1.8 * angle[:, 1]).all()
    assert (angle[:, 1] > 1.8 * angle[:, 2]).all()
    assert (np.diff(angle[:, 0]) > 0.0).all()


def test_moments_are_those_of_the_weight_and_load(exoskeleton, geometry, materials):
    """Under self-weight the finger is nearly straight: statics gives the moments without any finite element."""
    model = exoskeleton_model(geometry, materials.tpu, DENSITIES["coarse"].exoskeleton)
    z = np.einsum("enk,n->ek", model.mesh.points_m[model.mesh.elements], np.full(10, 0.1))[:, 2]
    mass = 2.0 * model.weights.sum(axis=1) * materials.tpu.density_kg_m3
    for joint, position in enumerate(geometry.joint_position_m[:2]):
        beyond = z > position
        moment = 9.80665 * float((mass * (z - position))[beyond].sum())
        # what lies beyond turns about a hinge on the palm side of its axis: a lever L becomes L cos q + r sin q
        offset = exoskeleton.lengthening_m[0, joint] / exoskeleton.angle_rad[0, joint]
        turned = float(exoskeleton.angle_rad[0, : joint + 1].sum())
        longest = moment + 9.80665 * float(mass[beyond].sum()) * offset * np.sin(turned)
        assert 0.88 * moment < exoskeleton.moment_n_m[0, joint] < longest


def test_identical_flexures_have_the_same_stiffness_and_offset(exoskeleton, geometry):
    k = exoskeleton.moment_n_m / exoskeleton.angle_rad
    assert k[:, 0] == pytest.approx(k[:, 1], rel=0.15)
    r = exoskeleton.lengthening_m / exoskeleton.angle_rad
    assert (r[:, :2] > geometry.actuator_inner_radius_m).all()
    assert (r[:, :2] < geometry.tube_outer_radius_m).all()


def test_bad_loads_are_refused(geometry, materials):
    model = exoskeleton_model(geometry, materials.tpu, DENSITIES["coarse"].exoskeleton)
    with pytest.raises(ValueError, match="loads_n"):
        analyse_exoskeleton(model, geometry, materials.tpu, loads_n=(0.2, 0.1))
