"""Soft pads: the law against the engine's own contact, the fit, and what the reader refuses."""

import copy
import json

import mujoco
import numpy as np
import pytest

from assets import asset_path
from softhand_sim.calibration.pad import PadCurve, load_pad_evidence
from softhand_sim.effects import BENCH, Effects
from softhand_sim.effects.auto import choose
from softhand_sim.effects.pads import soften
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.elements import FINGERS
from softhand_sim.hand.scene import build_root, compile_scene
from softhand_sim.objects.catalogue import make_object
from softhand_sim.pads import PadLaw, SoftPads

SPHERE_M = 10e-3
CLEAR_M = 1e-3


@pytest.fixture(scope="module")
def evidence():
    return load_pad_evidence()


@pytest.fixture(scope="module")
def pads(evidence):
    return SoftPads.of(evidence)


def clamped_hand(calibration, pads, joint):
    """The index straight with its joints locked; a fixed sphere in front of the pad of one of its phalanges."""
    root = build_root(calibration)
    for name in ("proximal", "middle", "distal"):
        root.equality.add("joint", joint1=f"index_{name}", solref=(0.004, 1.0), solimp=(0.9999, 0.9999, 1e-3, 0.5, 2))
    body = root.worldbody.add("body", name="object", mocap=True, pos=(0.0, 0.0, 2.0))
    body.add("geom", name="object_collision_0", type="sphere", size=(SPHERE_M,), condim=1, friction=(0.8, 2e-3, 1e-4))
    soften(root, pads)
    model = compile_scene(root).model
    model.opt.gravity[:] = 0.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # hold the wrist where it is
    for k in range(model.nu):
        if model.actuator_trntype[k] == mujoco.mjtTrn.mjTRN_JOINT:
            data.ctrl[k] = data.qpos[model.jnt_qposadr[model.actuator_trnid[k, 0]]]
    pad = model.geom(f"index_{joint}_pad").id
    out = data.xmat[model.body(f"index_{joint}").id].reshape(3, 3)[:, 0].copy()
    touch = data.geom_xpos[pad] + (model.geom_size[pad, 0] + SPHERE_M) * out
    return model, data, touch, out


@pytest.mark.parametrize("joint", ["proximal", "middle", "distal"])
def test_a_fixed_sphere_on_a_clamped_phalanx_dents_it_as_the_finite_elements_have_it(
    calibration, evidence, pads, joint
):
    """Depth and force of the engine's contact at rest, against the curve of the phalanx; 10 % over 0.1 to 1 mm."""
    model, data, touch, out = clamped_hand(calibration, pads, joint)
    curve = evidence.curves["distal" if joint == "distal" else "middle"]
    depths, forces, load = [], [], np.zeros(6)
    for way in np.linspace(0.1e-3, 1.3e-3, 7):
        data.mocap_pos[0] = touch - way * out
        for _ in range(400):
            mujoco.mj_step(model, data)
        touching = [k for k in range(data.ncon) if data.contact[k].dist < 0.0]
        assert len(touching) == 1
        mujoco.mj_contactForce(model, data, touching[0], load)
        depths.append(-data.contact[touching[0]].dist)
        forces.append(float(load[0]))
    depth, force = np.array(depths), np.array(forces)
    inside = (depth > 0.1e-3) & (depth < 1e-3)
    assert inside.sum() >= 4
    expected = np.interp(depth, curve.depth_m, curve.force_n)
    assert force[inside] == pytest.approx(expected[inside], rel=0.1)
    # and it is the closed form of the engine's contact (friction's regularisation would add up to 7 %)
    assert force == pytest.approx(pads.of_joint(joint).force_n(depth), rel=0.005)


def test_fit_returns_the_law_that_a_curve_was_made_with():
    law = PadLaw(stiffness_n_per_m=2500.0, impedance=0.85, width_m=1e-3, midpoint=0.2)
    depth = np.linspace(0.0, 1e-3, 9)
    found = PadLaw.fit(PadCurve(section="distal", depth_m=depth, force_n=law.force_n(depth)))
    assert found.stiffness_n_per_m == pytest.approx(2500.0, rel=1e-4)
    assert found.impedance == pytest.approx(0.85, rel=1e-4)
    assert found.midpoint == pytest.approx(0.2, rel=1e-2)
    assert law.force_n(np.array(law.depth_m(1.2))) == pytest.approx(1.2)


def test_shipped_curves_are_met_by_their_laws(evidence, pads):
    for section, curve in evidence.curves.items():
        law = pads.of_joint("distal" if section == "distal" else "middle")
        assert law.force_n(curve.depth_m) == pytest.approx(curve.force_n, rel=0.1)


def test_every_pair_of_phalanx_and_object_has_its_contact_and_the_object_s_friction(calibration, pads):
    root = build_root(calibration)
    body = root.worldbody.add("body", name="object")
    body.add("freejoint")
    for k in range(2):
        body.add(
            "geom", name=f"object_collision_{k}", type="sphere", size=(0.01,), mass=0.1, friction=(0.3, 1e-3, 1e-4)
        )
    soften(root, pads)
    model = compile_scene(root).model
    assert model.npair == 2 * 2 * 3 * len(FINGERS)
    assert model.pair_friction == pytest.approx(np.tile([0.3, 0.3, 1e-3, 1e-4, 1e-4], (model.npair, 1)))
    # a heavier phalanx needs a larger S for the same stiffness: S / w is the same for both middle pads
    weight = [
        model.body_invweight0[model.geom_bodyid[[model.pair_geom1[k], model.pair_geom2[k]]], 0].sum()
        for k in range(model.npair)
    ]
    ratio = np.unique((model.pair_solref[:, 0] / weight).round(3))
    assert len(ratio) == 2
    with pytest.raises(ValueError, match="no shapes cup_collision"):
        soften(root, pads, name="cup")


def test_a_tight_tolerance_keeps_the_pads(calibration, pads):
    scene = SceneFacts.of(make_object("apple"), calibration, Effects(pads=pads), survives=lambda: True)
    for angle, stays in ((0.1, True), (60.0, False)):
        chosen, _ = choose(scene, Tolerance(angle_deg=angle, slip_m=1.0))
        assert (chosen.pads is not None) == stays
    assert BENCH.pads is None


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"stiffness_n_per_m": 0.0}, "stiffness_n_per_m"),
        ({"impedance": 0.99}, "impedance"),
        ({"width_m": -1.0}, "width_m"),
        ({"midpoint": 1.0}, "midpoint"),
    ],
)
def test_laws_out_of_range_are_refused_by_name(change, named):
    with pytest.raises(ValueError, match=named):
        PadLaw(**({"stiffness_n_per_m": 2e3, "impedance": 0.9, "width_m": 1e-3, "midpoint": 0.1} | change))


@pytest.mark.parametrize(
    ("place", "value", "named"),
    [
        (("schema_version",), 0, "schema_version = 0: must be 1"),
        (("sphere_radius_m",), 0.0, "sphere_radius_m = 0"),
        (("sections", 0, "section"), "palm", "section = 'palm'"),
        (("sections", 1, "force_n", 3), 0.0, "force_n = .*rising"),
        (("sections", 0, "depth_m"), [0.0, 1e-4], "depth_m = .*rising"),
    ],
)
def test_a_bad_file_is_refused_by_name(tmp_path, place, value, named):
    data = json.loads(asset_path("calibration", "finger_pad_evidence.json").read_text(encoding="utf-8"))
    data = copy.deepcopy(data)
    parent = data
    for key in place[:-1]:
        parent = parent[key]
    parent[place[-1]] = value
    file = tmp_path / "bad.json"
    file.write_text(json.dumps(data))
    with pytest.raises(ValueError, match=named):
        load_pad_evidence(file)
