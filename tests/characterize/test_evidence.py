"""Reader of the evidence: every refusal by name."""

import copy
import json

import pytest

from assets import asset_path
from softhand_sim.calibration import load_evidence


@pytest.fixture(scope="module")
def contents():
    return json.loads(asset_path("calibration", "finger_evidence.json").read_text(encoding="utf-8"))


def test_shipped_evidence_is_of_the_shipped_finger_and_says_how_it_was_made(calibration):
    evidence = load_evidence()
    evidence.require_same_finger(calibration)
    assert evidence.provenance["density"] == "calibration"
    runs = evidence.provenance["runs"]
    assert {run["status"] for run in runs.values()} == {"converged"}
    assert len(runs) == 2 + len(evidence.tip_loads)
    assert evidence.cycle.pressure_pa_gauge[-1] == 0.0
    assert evidence.cycle.pressure_pa_gauge.max() == 80e3
    assert {test.pressure_pa_gauge for test in evidence.tip_loads} >= {30e3, 60e3}
    assert (evidence.blocked.tip_force_n[evidence.blocked.pressure_pa_gauge > 40e3] > 0.0).all()


def test_calibration_and_evidence_agree_where_both_have_been(calibration):
    """The same analysis, run twice; the bounds allow for another linear solver or machine."""
    own, cycle = calibration.analysis, load_evidence().cycle
    rows = {key: k for k, key in enumerate(zip(cycle.branch, cycle.pressure_pa_gauge.tolist(), strict=True))}
    shared = [rows[key] for key in zip(own.branch, own.pressure_pa_gauge.tolist(), strict=True)]
    assert own.joint_angle_rad == pytest.approx(cycle.joint_angle_rad[shared], abs=1e-4)
    assert own.chamber_volume_m3 == pytest.approx(cycle.chamber_volume_m3[shared], rel=1e-4)


@pytest.mark.parametrize(
    ("place", "value", "named"),
    [
        (("schema",), "softhand-sim/finger-calibration", "schema = "),
        (("schema_version",), 0, "schema_version = 0: must be 1"),
        (("tip_loads",), [], r"tip_loads = \[\]"),
        (("tip_loads", 1, "tip_load_n", 2), 0.0, r"tip_loads\[1\]\.tip_load_n = .*increasing"),
        (("tip_loads", 0, "tip_displacement_m"), [0.0], r"tip_loads\[0\]\.tip_displacement_m has 1 rows"),
        (("tip_loads", 0, "pressure_pa_gauge"), -1.0, r"tip_loads\[0\]\.pressure_pa_gauge = -1\.0"),
        (("blocked", "sensor_distance_m"), 0.0, r"blocked\.sensor_distance_m = 0\.0"),
        (("blocked", "tip_force_n"), "0.1", r"blocked\.tip_force_n = '0\.1'"),
        (("blocked", "pressure_pa_gauge", 1), 0.0, r"blocked\.pressure_pa_gauge = .*increasing"),
        (("cycle", "branch", 1), "up", r"cycle\.branch = 'up'"),
        (("cycle", "pressure_pa_gauge", 3), 1e3, r"cycle\.pressure_pa_gauge: must rise"),
        (("cycle", "chamber_volume_m3", 0), float("nan"), r"cycle\.chamber_volume_m3\[0\] = nan"),
    ],
)
def test_refuses_a_bad_field_by_name(contents, tmp_path, place, value, named):
    data = copy.deepcopy(contents)
    parent = data
    for key in place[:-1]:
        parent = parent[key]
    parent[place[-1]] = value
    file = tmp_path / "bad.json"
    file.write_text(json.dumps(data))
    with pytest.raises(ValueError, match=named) as caught:
        load_evidence(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


def test_refuses_a_missing_part_by_name(contents, tmp_path):
    for name in contents:
        file = tmp_path / "bad.json"
        file.write_text(json.dumps({key: value for key, value in contents.items() if key != name}))
        with pytest.raises(ValueError, match=f"{name} is missing"):
            load_evidence(file)
    file.write_text(json.dumps(contents)[:-100])
    with pytest.raises(ValueError, match="not a JSON file"):
        load_evidence(file)
