"""The MuJoCo hand against its calibration, and the shipped files against the code that writes them."""

import subprocess
import sys

import mujoco
import numpy as np
import pytest

from assets import asset_path
from softhand_sim.calibration import JOINTS
from softhand_sim.characterize import pressure_angle
from softhand_sim.elements import FINGERS
from softhand_sim.hand.anatomy import FingerMount, HandAnatomy
from softhand_sim.hand.export import hand_xml, scene_xml
from softhand_sim.hand.index import HandIndex
from softhand_sim.hand.scene import EngineSettings, build_root, build_scene, compile_scene

BARE = """
import sys
import mujoco, numpy as np
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data, rng = mujoco.MjData(model), np.random.default_rng(0)
low, high = model.actuator_ctrlrange.T
while data.time < 1.0:
    data.ctrl[:] = rng.uniform(low, high)
    mujoco.mj_step(model, data)
ours = {"softhand_sim", "fea", "envs", "assets", "dm_control"} & {name.split(".")[0] for name in sys.modules}
assert not ours, ours
assert np.isfinite(data.qpos).all() and np.abs(data.qvel).max() < 1e3
assert not data.warning.number.any(), data.warning.number
"""


def test_pressure_outside_the_curve_is_refused(calibration):
    with pytest.raises(ValueError, match="pressure_pa_gauge = 200000"):
        pressure_angle(calibration, [200e3])


def test_tendon_force_is_the_derivative_of_chamber_volume(calibration):
    """Virtual work: the actuator's force equals p dV/d(delta), by central difference of the calibration's V."""
    model = compile_scene(build_root(calibration)).model
    data, index = mujoco.MjData(model), HandIndex.of(model)
    data.qpos[index.joint_qpos] = [0.3, 0.5, 0.4]
    data.ctrl[index.pressure_ctrl] = 40e3
    mujoco.mj_forward(model, data)
    delta = float(index.elongations_m(data.ten_length)[0])
    assert delta == pytest.approx(calibration.elongation_m((0.3, 0.5, 0.4)), rel=1e-12)
    chamber, h = calibration.chamber, 1e-6
    slope = (chamber.volume_m3_at(delta + h) - chamber.volume_m3_at(delta - h)) / (2 * h)
    forces = data.actuator_force[index.pressure_ctrl]
    assert forces == pytest.approx(np.full(len(FINGERS), 40e3 * slope), rel=1e-6)


def test_joint_torques_are_those_of_the_calibration_s_laws(calibration):
    """Springs, tendon and pressure through the engine's path over the joints, against the closed forms."""
    model = compile_scene(build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))).model
    data, index = mujoco.MjData(model), HandIndex.of(model)
    angles, pressure, h = np.array([0.2, 0.6, 0.45]), 55e3, 1e-6
    data.qpos[index.joint_qpos] = angles
    data.ctrl[index.pressure_ctrl] = pressure
    mujoco.mj_forward(model, data)
    a, b, c = calibration.tendon.polynomial

    def potential(q):
        d = calibration.elongation_m(tuple(q))
        joints = sum(
            x**2 * (k / 2 + x * (m / 3 + x * n / 4))
            for x, (k, m, n) in zip(q, [j.polynomial for j in calibration.joints], strict=True)
        )
        return joints + d**2 * (a / 2 + d * (b / 3 + d * c / 4)) - pressure * calibration.chamber.volume_m3_at(d)

    steps = h * np.eye(3)
    torque = [-(potential(angles + step) - potential(angles - step)) / (2 * h) for step in steps]
    for finger in FINGERS:
        dofs = [model.joint(f"{finger}_{joint}").dofadr[0] for joint in JOINTS]
        assert (data.qfrc_actuator + data.qfrc_passive)[dofs] == pytest.approx(torque, rel=1e-5, abs=1e-8)


def test_mass_is_the_paper_s(calibration):
    model = build_scene(calibration).model
    assert model.body_subtreemass[model.body("palm").id] == pytest.approx(0.100, rel=1e-6)


def test_thumb_opposes_the_fingers(calibration):
    """Closing brings the thumb's tip and the others' toward each other."""
    model = compile_scene(build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))).model
    data, index = mujoco.MjData(model), HandIndex.of(model)

    def gap() -> float:
        mujoco.mj_forward(model, data)
        tips = {f: data.site_xpos[model.site(f"{f}_tip").id] for f in FINGERS}
        return float(np.mean([np.linalg.norm(tips["thumb"] - tips[f]) for f in FINGERS if f != "thumb"]))

    opened = gap()
    data.qpos[index.joint_qpos] = np.radians(25.0)
    assert gap() < 0.5 * opened


@pytest.mark.parametrize("name", ["hand.xml", "scene.xml"])
def test_shipped_file_runs_in_bare_mujoco_under_random_control(name):
    subprocess.run([sys.executable, "-c", BARE, str(asset_path("hand", name))], check=True, cwd="/")


def test_shipped_files_are_up_to_date(calibration):
    assert asset_path("hand", "hand.xml").read_text() == hand_xml(calibration)
    assert asset_path("hand", "scene.xml").read_text() == scene_xml(calibration)


def test_fingers_collide_with_each_other(calibration):
    model = build_scene(calibration).model
    data, index = mujoco.MjData(model), HandIndex.of(model)
    data.qpos[index.joint_qpos] = np.radians(32.0)
    mujoco.mj_forward(model, data)
    names = {tuple(model.geom(g).name.split("_")[0] for g in pair) for pair in data.contact.geom}
    assert any("thumb" in pair and set(pair) - {"thumb"} for pair in names)


def test_bad_settings_are_named(calibration):
    with pytest.raises(ValueError, match=r"timestep_s: 0\.1"):
        EngineSettings(timestep_s=0.1)
    with pytest.raises(ValueError, match="jacobian: 'thin' must be one of dense, sparse"):
        EngineSettings(jacobian="thin")
    with pytest.raises(ValueError, match=r"tolerance: 0\.1"):
        EngineSettings(tolerance=0.1)
    with pytest.raises(ValueError, match=r"hand_mass_kg: 0\.01"):
        build_root(calibration, anatomy=HandAnatomy(hand_mass_kg=0.01))
    mount = FingerMount(base_m=(0, 0, 0), azimuth_deg=0, elevation_deg=90, curl_to_m=(0, 0, 1))
    with pytest.raises(ValueError, match="curl_to_m"):
        mount.rotation()
