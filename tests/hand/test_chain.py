"""Fingers as chains of hinges against the laws of the joints that they were split from."""

import mujoco
import numpy as np
import pytest

from softhand_sim.calibration import JOINTS
from softhand_sim.characterize import Bench
from softhand_sim.elements import FINGERS
from softhand_sim.hand.chain import hinges
from softhand_sim.hand.hand import WRIST
from softhand_sim.hand.index import HandIndex
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.simulation import HandSimulation, default_pneumatics

LINKS = 12
BEND_RAD = np.array([0.5, 0.35, 0.6])


@pytest.fixture(scope="module")
def chain(calibration):
    return compile_scene(
        build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0, timestep_s=1e-3), links=LINKS)
    ).model


def _evenly_bent(model):
    """A hand whose hinges share their joints' angles evenly."""
    data, index = mujoco.MjData(model), HandIndex.of(model)
    data.qpos[index.joint_qpos] = np.repeat(BEND_RAD, LINKS // 3) / (LINKS // 3)
    mujoco.mj_forward(model, data)
    return data, index


def test_hinges_in_series_store_the_energy_of_the_joint(calibration, chain):
    data, index = _evenly_bent(chain)
    joints = [joint.polynomial for joint in calibration.joints]
    energy = sum(q * q * (a / 2 + q * (b / 3 + q * c / 4)) for q, (a, b, c) in zip(BEND_RAD, joints, strict=True))
    # the tendon's share by its own law, at the length that the engine has
    d = float(index.elongations_m(data.ten_length)[0])
    a, b, c = calibration.tendon.polynomial
    energy += d * d * (a / 2 + d * (b / 3 + d * c / 4))
    mujoco.mj_energyPos(chain, data)
    assert float(data.energy[0]) == pytest.approx(len(FINGERS) * energy, rel=1e-9)


def test_a_split_arm_lengthens_the_tendon_as_the_joint_s(calibration, chain):
    data, index = _evenly_bent(chain)
    assert index.elongations_m(data.ten_length) == pytest.approx(calibration.elongation_m(tuple(BEND_RAD)), rel=2e-3)
    assert index.joint_angles_rad(data.qpos) == pytest.approx(np.tile(BEND_RAD, (5, 1)), abs=1e-12)


def test_pressure_force_is_the_derivative_of_the_chamber_volume(calibration, chain):
    data, index = _evenly_bent(chain)
    data.ctrl[index.pressure_ctrl] = 40e3
    mujoco.mj_forward(chain, data)
    area = calibration.chamber.area_m2_at(float(index.elongations_m(data.ten_length)[0]))
    assert data.actuator_force[index.pressure_ctrl] == pytest.approx(np.full(5, 40e3 * area), rel=1e-9)


def test_a_bent_flexure_is_an_arc_of_the_gap_s_length(calibration):
    """Arc of length g turned by q: its end is g (1 - cos q) / q aside, g sin q / q ahead; m chords miss by 1/m^2."""
    gap, q, misses = calibration.geometry["gap_length_m"], 0.8, []
    for links in (6, 12, 24):
        bench = Bench(calibration, links=links)
        count = links // 3
        bench.data.qpos[bench.qpos[:count]] = q / count
        mujoco.mj_forward(bench.model, bench.data)
        # the flexure's far end lies half a part behind the last hinge
        body = bench.data.body("finger_proximal")
        end = body.xpos + 0.5 * gap / count * body.xmat.reshape(3, 3)[:, 2]
        start = np.array([calibration.finger.hinge_offset_m, 0.0, calibration.geometry["gap_start_m"][0]])
        arc = start + gap / q * np.array([1.0 - np.cos(q), 0.0, np.sin(q)])
        misses.append(float(np.linalg.norm(end - arc)))
    assert misses[1] == pytest.approx(misses[0] / 4, rel=0.1)
    assert misses[2] == pytest.approx(misses[1] / 4, rel=0.1)


def test_a_chain_comes_to_rest_near_the_three_joints(calibration):
    """The laws are the same; what differs is the arm's fit and where contact and weight would act."""
    angles = [Bench(calibration, links=links).go_to(75e3) for links in (None, LINKS)]
    assert angles[1].joint_angle_rad == pytest.approx(angles[0].joint_angle_rad, abs=np.radians(0.2))


def test_a_hand_of_chains_has_the_mass_and_the_angles_of_the_plain_one(calibration, chain):
    plain = compile_scene(build_root(calibration)).model
    total = [float(model.body_subtreemass[model.body("palm").id]) for model in (plain, chain)]
    assert total[1] == pytest.approx(total[0], rel=1e-12)
    simulation = HandSimulation(model=chain, calibration=calibration, pneumatics=default_pneumatics(calibration))
    simulation.reset(np.random.default_rng(0), np.zeros(len(WRIST)))
    simulation.set_pressure_pa_gauge = np.full(3, 30e3)
    simulation.advance(300)
    assert not simulation.diverged
    assert simulation.index.joint_qpos.shape == (5, LINKS)
    assert simulation.tip_angles_rad().min() > 0.0


@pytest.mark.parametrize("links", [0, 3, 7, 51])
def test_other_numbers_of_links_are_refused_by_name(calibration, links):
    with pytest.raises(ValueError, match=f"links = {links}"):
        hinges(calibration, links)


def test_without_links_the_hinges_are_the_joints(calibration):
    found = hinges(calibration)
    assert tuple(h.name for h in found) == JOINTS
    assert [h.law for h in found] == list(calibration.joints)
