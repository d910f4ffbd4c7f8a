"""Objects in the engine: they rest where the model says, and slide by their own friction."""

import dataclasses

import mujoco
import numpy as np
import pytest
import trimesh
from dm_control import mjcf

from softhand_sim.contact import ContactSettings
from softhand_sim.objects.catalogue import load_catalogue, make_object
from softhand_sim.objects.mjcf import attach_object

NAMES = tuple(load_catalogue())


def on_table(model, *, height=0.0, gravity=(0.0, 0.0, -9.81), contact=None):
    root = mjcf.RootElement()
    root.option.timestep = 0.002
    root.option.integrator = "implicitfast"
    root.option.cone = "elliptic"
    root.option.impratio = 10
    root.option.gravity = gravity
    root.worldbody.add("geom", type="plane", size=(1, 1, 0.1), friction=(1.0, 0.005, 1e-4))
    body = attach_object(root, model, contact=contact)
    body.pos = (0, 0, model.rest_height_m + height)
    compiled = mujoco.MjModel.from_xml_string(root.to_xml_string())
    return compiled, mujoco.MjData(compiled)


def run(model, data, seconds):
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)


def tilt_deg(data):
    """Angle between the body's z axis and the vertical."""
    return np.degrees(np.arccos(np.clip(data.xmat[-1].reshape(3, 3)[2, 2], -1, 1)))


@pytest.mark.parametrize("name", NAMES)
def test_object_rests_on_the_table_without_drift(name):
    model = make_object(name)
    compiled, data = on_table(model)
    run(compiled, data, 0.5)  # the soft contact takes up the weight
    settled, place = data.qpos.copy(), 0.0
    assert settled[:3] == pytest.approx([0.0, 0.0, model.rest_height_m], abs=2e-4)
    for _ in range(1000):
        mujoco.mj_step(compiled, data)
        place = max(place, np.linalg.norm(data.qpos[:3] - settled[:3]))
    assert place < 2e-5  # m within two seconds
    assert tilt_deg(data) < 0.5
    assert not any(warning.number for warning in data.warning)


@pytest.mark.parametrize("name", NAMES)
def test_dropped_object_comes_to_rest_upright_without_a_warning(name):
    model = make_object(name)
    compiled, data = on_table(model, height=0.01)
    run(compiled, data, 2.0)
    rest = data.qpos.copy()
    assert data.ncon > 0
    assert rest[2] == pytest.approx(model.rest_height_m, abs=2e-4)
    # an oval may rock over to the next facet of its hull
    oval = model.kind == "egg"
    assert tilt_deg(data) < (6.0 if oval else 0.5)
    assert np.hypot(rest[0], rest[1]) < (5e-3 if oval else 5e-4)
    wander = 0.0
    for _ in range(500):
        mujoco.mj_step(compiled, data)
        wander = max(wander, np.linalg.norm(data.qpos[:3] - rest[:3]))
    assert wander < 2e-5  # m within one second
    assert not any(warning.number for warning in data.warning)


@pytest.mark.parametrize("name", NAMES)
def test_engine_has_the_mass_and_inertia_of_the_model(name):
    model = make_object(name)
    compiled, data = on_table(model)
    body = compiled.body("object").id
    assert compiled.body_mass[body] == pytest.approx(model.mass_kg)
    assert np.allclose(compiled.body_ipos[body], 0, atol=1e-9)
    principal = np.sort(np.linalg.eigvalsh(model.inertia_kg_m2))
    assert np.allclose(np.sort(compiled.body_inertia[body]), principal, rtol=1e-6)
    mujoco.mj_forward(compiled, data)
    visual = compiled.geom("object_visual").id
    assert compiled.geom_contype[visual] == compiled.geom_conaffinity[visual] == 0


@pytest.mark.parametrize("name", ["cracker_box", "mug"])
def test_object_slides_by_its_own_friction_not_by_that_of_the_table(name):
    # gravity inclined by atan(0.2): holds at mu 0.8, slides at 0.05 with g (sin - mu cos), although the table has mu 1
    angle = np.arctan(0.2)
    gravity = 9.81 * np.array([0.0, np.sin(angle), -np.cos(angle)])
    rough, data = on_table(make_object(name), gravity=gravity)
    run(rough, data, 0.5)
    assert abs(data.qpos[1]) < 1e-3
    oiled, data = on_table(make_object(name).with_overrides(friction=0.05), gravity=gravity)
    run(oiled, data, 0.5)
    acceleration = 9.81 * (np.sin(angle) - 0.05 * np.cos(angle))
    assert data.qpos[1] == pytest.approx(acceleration * 0.5**2 / 2, rel=0.03)


def test_open_or_inverted_picture_mesh_is_no_obstacle():
    model = make_object("cracker_box")
    surface = model.mesh
    for faces in (surface.faces[:, ::-1], surface.faces[:1]):
        odd = dataclasses.replace(model, mesh=trimesh.Trimesh(surface.vertices, faces, process=False))
        compiled, _ = on_table(odd)
        assert compiled.body("object").mass[0] == pytest.approx(model.mass_kg)


def test_contact_settings_reach_the_engine():
    model = make_object("banana")
    settings = ContactSettings(condim=6, patch_radius_m=0.003, rolling_friction_m=2e-4, time_constant_s=0.01)
    compiled, _ = on_table(model, contact=settings)
    for i in range(len(model.convex_parts)):
        geom = compiled.geom(f"object_collision_{i}")
        assert geom.condim[0] == 6
        assert geom.friction == pytest.approx([0.8, 2 / 3 * 0.8 * 0.003, 2e-4])
        assert geom.solref[0] == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("field", "value"),
    [("condim", 2), ("patch_radius_m", -1.0), ("rolling_friction_m", float("nan")), ("time_constant_s", 0.0)],
)
def test_impossible_contact_settings_are_refused(field, value):
    with pytest.raises(ValueError, match=field):
        ContactSettings(**{field: value})


def test_second_object_of_the_same_name_is_refused():
    root = mjcf.RootElement()
    attach_object(root, make_object("apple"), name="fruit")
    with pytest.raises(ValueError, match="'fruit'"):
        attach_object(root, make_object("apple"), name="fruit")
