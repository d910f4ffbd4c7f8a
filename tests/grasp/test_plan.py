"""Grasp poses: ranges, and the same palm in the engine as in the formulas."""

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from softhand_sim.grasp.plan import GraspPlan, palm_axes, pose_of_palm
from softhand_sim.hand.index import HandIndex
from softhand_sim.hand.scene import build_scene


@pytest.mark.parametrize("seed", range(5))
def test_the_engine_puts_the_palm_where_the_pose_says(seed, calibration):
    rng = np.random.default_rng(seed)
    axes, place = Rotation.random(random_state=rng).as_matrix(), rng.uniform(0.1, 0.3, size=3)
    pose = pose_of_palm(place, axes)
    assert palm_axes(pose) == pytest.approx(axes, abs=1e-9)
    model = build_scene(calibration).model
    data, hand = mujoco.MjData(model), HandIndex.of(model)
    data.qpos[hand.wrist_qpos] = pose
    mujoco.mj_forward(model, data)
    assert data.xmat[hand.palm_body].reshape(3, 3) == pytest.approx(axes, abs=1e-9)
    assert data.xpos[hand.palm_body] == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wrist_pose": (0.0,) * 5}, "wrist_pose: 5 numbers given, must be 6"),
        ({"wrist_pose": (9.0, 0, 0, 0, 0, 0)}, "wrist_pose"),
        ({"retreat": (0.0, 0.0, 2.0)}, "retreat: .* has length 2, must be 1"),
        ({"set_angle_deg": (95.0, float("nan"), 95.0)}, "set_angle_deg"),
    ],
)
def test_impossible_plans_are_refused(change, message):
    values = {"wrist_pose": (0.0, 0.0, 0.1, 0.0, 0.0, 0.0), "retreat": (0.0, 0.0, 1.0), **change}
    with pytest.raises(ValueError, match=message):
        GraspPlan(**values)
