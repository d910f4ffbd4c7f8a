import dataclasses

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from softhand_sim.grasp.scripted import ShapeKind, outline, plan_grasp
from softhand_sim.objects.catalogue import load_catalogue, make_object


def turned(model, yaw):
    rotation = Rotation.from_euler("z", yaw).as_matrix()
    mesh = trimesh.Trimesh(model.mesh.vertices @ rotation.T, model.mesh.faces, process=False)
    return dataclasses.replace(model, mesh=mesh, inertia_kg_m2=rotation @ model.inertia_kg_m2 @ rotation.T)


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("apple", ShapeKind.ROUND),
        ("tennis_ball", ShapeKind.ROUND),
        ("mug", ShapeKind.UPRIGHT),
        ("soup_can", ShapeKind.UPRIGHT),
        ("cracker_box", ShapeKind.UPRIGHT),
        ("banana", ShapeKind.LONG),
    ],
)
def test_kind(name, kind):
    assert outline(make_object(name)).kind is kind


@pytest.mark.parametrize("name", ["mug", "cracker_box", "banana"])
@pytest.mark.parametrize("yaw", [0.4, -1.2, 2.5])
def test_the_grasp_turns_with_the_object(name, yaw):
    model = make_object(name)
    straight, after = plan_grasp(model), plan_grasp(turned(model, yaw))
    rotation = Rotation.from_euler("z", yaw)
    turn = (after.wrist_pose[3] - straight.wrist_pose[3] - yaw) % np.pi
    assert min(turn, np.pi - turn) == pytest.approx(0.0, abs=1e-6)
    if name == "mug":  # its handle makes the direction unique
        assert after.wrist_pose[:3] == pytest.approx(rotation.apply(straight.wrist_pose[:3]), abs=1e-6)


def test_the_palm_faces_the_mug_opposite_its_handle():
    mug = make_object("mug")
    handle = mug.mesh.vertices[np.argmax(np.linalg.norm(mug.mesh.vertices[:, :2], axis=1)), :2]
    assert np.dot(handle, plan_grasp(mug).wrist_pose[:2]) < 0.0


@pytest.mark.parametrize("name", load_catalogue())
def test_standoff_lies_on_the_way_in(name):
    plan = plan_grasp(make_object(name))
    step = plan.standoff(0.05)[:3] - plan.standoff(0.0)[:3]
    assert np.linalg.norm(step) == pytest.approx(0.05)
    assert step[2] >= 0.0
