"""Files of grasps: round trip, errors that name the place, shipped grasps that fit what is shipped."""

import dataclasses
import hashlib

import numpy as np
import pytest

from assets import asset_path
from scripts import choose_grasps
from softhand_sim.grasp.choice import kept
from softhand_sim.grasp.choice.grasp_file import GraspFile, KeptGrasp, load_grasps, rounded, write_grasps
from softhand_sim.grasp.choice.kept import kept_or_searched
from softhand_sim.grasp.choice.search import ScoredGrasp, SearchResult
from softhand_sim.grasp.choice.shipped import default_grasp, hand_sha256, shape_m, shipped_grasps
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.catalogue import load_catalogue, make_object

PLAN = GraspPlan(wrist_pose=(0.01, -0.02, 0.1, 0.3, -0.1, -1.5), retreat=(0.6, 0.8, 0.0), set_angle_deg=(95, 80, 80))
GOOD = """
[grasp.mug]
position_m = [0.0, 0.05, 0.05]
yaw_rad = 0
pitch_rad = 0.0
roll_rad = -1.57
retreat = [0, 2, 0]
"""


def test_round_trip(tmp_path):
    one = KeptGrasp(plan=rounded(PLAN), score=0.913, closings=480, shape_m=(0.0123456, 0.5))
    file = GraspFile(grasps={"mug": one, "my scan": KeptGrasp(plan=rounded(PLAN))}, hand_sha256="abc")
    write_grasps(tmp_path / "g.toml", file)
    assert load_grasps(tmp_path / "g.toml") == file
    assert np.allclose(rounded(PLAN).wrist_pose, PLAN.wrist_pose, atol=1e-5)


def test_later_grasps_join_those_of_other_objects_but_not_of_another_hand():
    one = KeptGrasp(plan=rounded(PLAN))
    other = dataclasses.replace(one, score=0.5, closings=9)
    before = GraspFile(grasps={"mug": one, "pear": one}, hand_sha256="abc", command="first")
    now = GraspFile(grasps={"pear": other, "apple": other}, hand_sha256="abc", command="second")
    both = before.joined(now)
    assert both.grasps == {"apple": other, "mug": one, "pear": other}
    assert both.command == "first; later second"
    assert both.joined(now) == both
    assert both.joined(now).command == both.command
    with pytest.raises(ValueError, match="hand_sha256 = 'xyz'"):
        before.joined(dataclasses.replace(now, hand_sha256="xyz"))


def test_choosing_refuses_to_overwrite_a_file_of_another_hand(tmp_path, capsys):
    file = tmp_path / "g.toml"
    file.write_text(GOOD)
    assert choose_grasps.main(["--objects", "apple", "--out", str(file)]) != 0
    assert "another --out" in capsys.readouterr().err
    assert file.read_text() == GOOD


def test_a_file_of_ones_own(tmp_path):
    (tmp_path / "g.toml").write_text(GOOD)
    mug = load_grasps(tmp_path / "g.toml").grasps["mug"]
    assert mug.plan.retreat == (0.0, 1.0, 0.0)
    assert mug.plan.set_angle_deg == (95.0, 95.0, 95.0)
    assert mug.score is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[grasp.mug]", "[mug]", r"unknown keys \['mug'\]"),
        (GOOD, "", "no grasps"),
        ("yaw_rad = 0", "", r"grasp.mug: .*missing keys \['yaw_rad'\]"),
        ("yaw_rad", "yaw_deg", r"grasp.mug: unknown keys \['yaw_deg'\]"),
        ("yaw_rad = 0", "yaw_rad = nan", "grasp.mug: yaw_rad"),
        ("yaw_rad = 0", "yaw_rad = true", "grasp.mug: yaw_rad = True"),
        ("[0.0, 0.05, 0.05]", "[0.0, 0.05]", "grasp.mug: position_m is .* needs 3 numbers"),
        ("[0.0, 0.05, 0.05]", "[0.0, 5.0, 0.05]", "grasp.mug: wrist_pose = 5.0"),
        ("[0, 2, 0]", "[0, 0, 0]", "grasp.mug: .*not all zero"),
        ("[0, 2, 0]", '["a", 2, 0]', "grasp.mug: retreat = 'a'"),
        ("[0, 2, 0]", "[0, 2, 0]\nset_angle_deg = [95, 95, 900]", "grasp.mug: set_angle_deg = 900"),
        ("[grasp.mug]", "[grasp.mug", "g.toml: "),
    ],
)
def test_errors_name_file_object_and_key(tmp_path, old, new, message):
    (tmp_path / "g.toml").write_text(GOOD.replace(old, new))
    with pytest.raises(ValueError, match=message) as error:
        load_grasps(tmp_path / "g.toml")
    assert "g.toml" in str(error.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.toml"):
        load_grasps(tmp_path / "none.toml")


def test_shipped_grasps_were_searched_with_the_shipped_hand_and_finger():
    """If this fails, run the command that the file names."""
    file = shipped_grasps()
    assert file.hand_sha256 == hand_sha256(HandAnatomy())
    shipped = hashlib.sha256(asset_path("calibration", "finger.json").read_bytes()).hexdigest()
    assert file.calibration_sha256 == shipped
    assert "choose_grasps.py" in file.command


@pytest.mark.parametrize("name", load_catalogue())
def test_each_catalogue_object_has_its_shipped_grasp(name):
    model = make_object(name)
    assert default_grasp(model) == shipped_grasps().grasps[name].plan
    assert default_grasp(model.with_overrides(mass_kg=2.0, friction=0.1)) == default_grasp(model)


def test_another_shape_gets_the_scripted_grasp():
    mug = make_object("mug")
    fewer = dataclasses.replace(mug, convex_parts=mug.convex_parts[:-1])
    assert shape_m(fewer) != shape_m(mug)
    assert default_grasp(fewer) == plan_grasp(fewer)


def test_a_search_is_kept_until_something_changes(tmp_path, monkeypatch, calibration):
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path))
    runs = []

    def counted(model, *_, seed, **__):
        runs.append(seed)
        best = ScoredGrasp(plan=plan_grasp(model), score=1.0, closings=1)
        return SearchResult(grasps=(best,) * (kept.MOST + 1), closings=64)

    monkeypatch.setattr(kept, "search_grasp", counted)
    apple, protocol = make_object("apple"), load_protocol()
    first = kept_or_searched(apple, calibration, protocol=protocol)
    assert kept_or_searched(apple, calibration, protocol=protocol) == first
    assert len(first) == kept.MOST
    assert len(runs) == 1
    kept_or_searched(apple.with_overrides(mass_kg=0.1), calibration, protocol=protocol)
    kept_or_searched(apple, calibration, protocol=protocol, seed=1)
    kept_or_searched(apple, calibration, protocol=protocol, budget=999)
    assert len(runs) == 4
    for file in (tmp_path / "grasps").glob("*.toml"):
        file.write_text("damaged")
    assert kept_or_searched(apple, calibration, protocol=protocol) == first
    assert len(runs) == 5
