"""Reader of the calibration contract: values, look-ups, and every refusal by name."""

import copy
import json
import math

import numpy as np
import pytest

from assets import asset_path
from softhand_sim.calibration import load_calibration
from softhand_sim.calibration.integrity import CHECKSUM, content_sha256


def plausible():
    """A file of the contract's form with round numbers of a finger's size."""
    pressure = [0.0, 20e3, 40e3, 60e3, 80e3]
    tip = [0.0, 21.0, 45.0, 72.0, 103.0]
    joint = {
        "offset_m": 5.5e-3,
        "offset_slope_m_per_rad": 4e-3,
        "stiffness_n_m_per_rad": 0.03,
        "stiffness_n_m_per_rad2": -0.004,
        "stiffness_n_m_per_rad3": 0.001,
        "damping_n_m_s_per_rad": 1e-3,
    }
    return {
        "schema": "softhand-sim/finger-calibration",
        "schema_version": 3,
        "geometry": {"flexure_thickness_m": 2e-3},
        "finger": {
            "length_m": 0.09,
            "joint_position_m": [0.012, 0.045, 0.07],
            "outer_radius_m": 8.5e-3,
            "mass_kg": 0.012,
            "hinge_offset_m": 6.5e-3,
        },
        "joints": [{"name": name, **joint} for name in ("proximal", "middle", "distal")],
        "tendon": {"stiffness_n_per_m": 250.0, "stiffness_n_per_m2": -3000.0, "stiffness_n_per_m3": 1e5},
        "chamber": {"volume_m3": 2.5e-6, "area_m2": 6.4e-5, "area_slope_m": 1e-4, "bulging_m3_per_pa": 5e-12},
        "sliding": {"coefficient_per_rad": 0.015, "stiffness_n_per_m": 70.0},
        "curve": {
            "pressure_pa_gauge": pressure,
            "tip_angle_deg": tip,
            "joint_angle_deg": [[0.4 * a, 0.35 * a, 0.25 * a] for a in tip],
        },
        "targets_used": {"tip_angle_deg": 95.0},
        "fit_rmse": {},
        "fea": {
            "finger": {
                "branch": ["loading", "loading", "loading", "unloading"],
                "fitted": [False, False, True, False],
                "pressure_pa_gauge": [0.0, 20e3, 40e3, 20e3],
                "joint_angle_rad": [[0.0, 0.0, 0.0], [0.1, 0.11, 0.12], [0.2, 0.22, 0.24], [0.11, 0.12, 0.13]],
                "chamber_volume_m3": [2.5e-6, 2.6e-6, 2.8e-6, 2.65e-6],
            }
        },
        "provenance": {"solver": "none"},
    }


def write(path, data):
    path.write_text(json.dumps(data))
    return path


def test_reads_every_part(tmp_path):
    calibration = load_calibration(write(tmp_path / "finger.json", plausible()))
    assert [joint.name for joint in calibration.joints] == ["proximal", "middle", "distal"]
    assert calibration.joints[1].polynomial == (0.03, -0.004, 0.001)
    assert calibration.tendon.polynomial == (250.0, -3000.0, 1e5)
    assert calibration.finger.joint_position_m == (0.012, 0.045, 0.07)
    assert calibration.curve.joint_angle_deg.shape == (5, 3)
    assert calibration.geometry["flexure_thickness_m"] == 2e-3
    assert calibration.notes["provenance"] == {"solver": "none"}
    assert calibration.sliding.stiffness_n_per_m == 70.0
    assert calibration.analysis.unseen.tolist() == [False, True, False, False]
    assert calibration.analysis.tip_angle_deg[1] == pytest.approx(np.degrees(0.33))


def test_elongation_is_the_integral_of_the_arm(tmp_path):
    """Two points 8 mm past the hinge and 5.5 mm to its back: their distance shrinks by what the tendon lengthens."""
    calibration = load_calibration(write(tmp_path / "finger.json", plausible()))
    for q in (-0.3, 0.2, 1.2):
        turned = np.array([[np.cos(q), np.sin(q)], [-np.sin(q), np.cos(q)]]) @ np.array([-5.5e-3, -8e-3])
        shorter = 16e-3 - float(np.linalg.norm(np.array([-5.5e-3, 8e-3]) - turned))
        assert calibration.elongation_m((0.0, q, 0.0)) == pytest.approx(shorter, rel=1e-9)
    angles = np.array([[0.1, 0.2, 0.3], [0.5, -0.1, 1.0]])
    each = [calibration.elongation_m(tuple(row)) for row in angles]
    assert calibration.elongations_m(angles) == pytest.approx(each, rel=1e-12)


def test_area_is_the_derivative_of_the_volume(tmp_path):
    chamber = load_calibration(write(tmp_path / "finger.json", plausible())).chamber
    assert chamber.volume_m3_at(0.0) == 2.5e-6
    for d in (0.0, 0.004, 0.011):
        difference = (chamber.volume_m3_at(d + 1e-5) - chamber.volume_m3_at(d - 1e-5)) / 2e-5
        assert chamber.area_m2_at(d) == pytest.approx(difference, rel=1e-9)


def test_look_ups_are_inverse_and_end_with_the_table(tmp_path):
    calibration = load_calibration(write(tmp_path / "finger.json", plausible()))
    assert calibration.pressure_for_angle(33.0) == pytest.approx(30e3)
    for angle in np.linspace(0.0, 103.0, 23).tolist():
        assert calibration.angle_for_pressure(calibration.pressure_for_angle(angle)) == pytest.approx(angle)
    for outside in (-0.1, 103.1, math.nan):
        with pytest.raises(ValueError, match=r"angle_deg = .*0 to 103"):
            calibration.pressure_for_angle(outside)
    with pytest.raises(ValueError, match=r"pressure_pa_gauge = .*0 to 80000"):
        calibration.angle_for_pressure(80_001.0)


REFUSALS = [
    (("schema",), "other", "schema = 'other'"),
    (("schema_version",), 2, "schema_version = 2: must be 3"),
    (("joints",), [], "joints = "),
    (("joints", 0, "name"), "distal", "joints = "),
    (("joints", 1, "offset_m"), 0.0, r"joints\[1\]\.offset_m = 0\.0"),
    (("joints", 1, "offset_slope_m_per_rad"), 1e-3, r"joints\[1\]\.offset_slope_m_per_rad = 0\.001.*> 0\.0023"),
    (("sliding", "coefficient_per_rad"), -0.1, r"sliding\.coefficient_per_rad = -0\.1"),
    (("sliding", "stiffness_n_per_m"), 0.0, r"sliding\.stiffness_n_per_m = 0\.0"),
    (("fea", "finger", "fitted"), [True], r"fea\.finger\.fitted has 1 rows: must have 4"),
    (("fea", "finger", "fitted", 0), 1, r"fea\.finger\.fitted = .*a list of bool"),
    (("fea", "finger", "branch", 1), "up", r"fea\.finger\.branch = 'up'"),
    (("fea", "finger", "pressure_pa_gauge", 1), 50e3, r"fea\.finger\.pressure_pa_gauge: must rise"),
    (("fea", "finger", "pressure_pa_gauge", 3), 50e3, r"fea\.finger\.pressure_pa_gauge: must fall"),
    (("joints", 1, "offset_m"), "6.5", r"joints\[1\]\.offset_m = '6\.5'"),
    (("joints", 2, "stiffness_n_m_per_rad"), math.nan, r"joints\[2\]\.stiffness_n_m_per_rad = nan"),
    (("joints", 2, "stiffness_n_m_per_rad"), -1.0, r"joints\[2\]\.stiffness_n_m_per_rad = -1\.0"),
    (("joints", 2, "stiffness_n_m_per_rad3"), -1.0, r"joints\[2\]\.stiffness_n_m_per_rad3 = -1\.0"),
    (
        ("joints", 0, "stiffness_n_m_per_rad2"),
        -0.02,
        r"joints\[0\]\.stiffness_n_m_per_rad2 = -0\.02.*monotone",
    ),
    (("joints", 0, "damping_n_m_s_per_rad"), -1e-3, r"joints\[0\]\.damping_n_m_s_per_rad = -0\.001"),
    (("tendon", "stiffness_n_per_m"), math.inf, r"tendon\.stiffness_n_per_m = inf"),
    (("tendon", "stiffness_n_per_m2"), -3e4, r"tendon\.stiffness_n_per_m2 = -30000.0.*must not fall"),
    (("chamber", "volume_m3"), 0.0, r"chamber\.volume_m3 = 0\.0"),
    (("chamber", "area_m2"), -1e-5, r"chamber\.area_m2 = -1e-05"),
    (("chamber", "area_slope_m"), -0.01, r"chamber\.area_slope_m = -0\.01.*must be > 0"),
    (("finger", "mass_kg"), 0.0, r"finger\.mass_kg = 0\.0"),
    (("finger", "joint_position_m"), [0.01, 0.07, 0.05], r"finger\.joint_position_m = .*increasing"),
    (("finger", "joint_position_m"), [0.01, 0.07], r"finger\.joint_position_m = .*shape"),
    (("curve", "pressure_pa_gauge", 2), 10e3, r"curve\.pressure_pa_gauge\[2\].*strictly increasing"),
    (("curve", "pressure_pa_gauge", 0), -1e3, r"curve\.pressure_pa_gauge\[0\] = -1000"),
    (("curve", "tip_angle_deg", 3), 45.0, r"curve\.tip_angle_deg\[3\].*strictly increasing"),
    (("curve", "tip_angle_deg", 3), math.nan, r"curve\.tip_angle_deg\[3\] = nan: must be finite"),
    (("curve", "tip_angle_deg", 3), 73.0, r"curve\.tip_angle_deg\[3\] = 73: must be the sum"),
    (("curve", "joint_angle_deg", 1), [1.0, 2.0], r"curve\.joint_angle_deg = .*shape \(n, 3\)"),
    (("curve", "tip_angle_deg"), [0.0, 21.0], r"curve\.tip_angle_deg has shape \(2,\)"),
    (("curve", "tip_angle_deg", 3), "72.0", r"curve\.tip_angle_deg = .*array of numbers"),
    (("curve", "pressure_pa_gauge", 1), True, r"curve\.pressure_pa_gauge = .*array of numbers"),
    (("curve", "pressure_pa_gauge", 4), 10**400, r"curve\.pressure_pa_gauge = .*array of numbers"),
    (("curve", "pressure"), [0.0, 1.0], r"curve\.pressure = .*unknown field; known: pressure_pa_gauge"),
    (("chamber", "volume_ml"), 2.5, r"chamber\.volume_ml = 2\.5.*unknown field; known: volume_m3"),
    (("joints", 1, "offset_mm"), 6.5, r"joints\[1\]\.offset_mm = 6\.5.*unknown field"),
    (("tendon", "stiffness_n_per_m"), 10**400, r"tendon\.stiffness_n_per_m = 1000.*must be a number"),
    (("geometry", "tube_wall"), 2.0, r"geometry\.tube_wall = 2\.0: must be a name that ends with a unit"),
    (("geometry", "tube_wall_m"), "2 mm", r"geometry\.tube_wall_m = '2 mm'"),
    (("provenance", "cost"), {"wall_s": [1.0, math.inf]}, r"provenance\.cost\.wall_s\[1\] = inf: must be finite"),
    (("fit_rmse", "finger_tip_angle_rad"), math.nan, r"fit_rmse\.finger_tip_angle_rad = nan: must be finite"),
    ((CHECKSUM,), "0" * 64, rf"{CHECKSUM} = '000.*damaged, or edited"),
]


@pytest.mark.parametrize(("place", "value", "named"), REFUSALS)
def test_refuses_a_bad_field_by_name(tmp_path, place, value, named):
    data = plausible()
    parent = data
    for key in place[:-1]:
        parent = parent[key]
    parent[place[-1]] = value
    with pytest.raises(ValueError, match=named) as caught:
        load_calibration(write(tmp_path / "bad.json", data))
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / 'bad.json'}: ")
    assert "\n" not in message


def required_fields():
    """Paths of every field that the contract requires."""
    data = plausible()
    for top in data:
        yield (top,)
    yield ("fea", "finger")
    for part in ("finger", "tendon", "chamber", "sliding", "curve"):
        yield from ((part, name) for name in data[part])
    yield from (("joints", 1, name) for name in data["joints"][1])


@pytest.mark.parametrize("place", list(required_fields()), ids=lambda place: ".".join(map(str, place)))
def test_refuses_a_missing_field_by_name(tmp_path, place):
    data = copy.deepcopy(plausible())
    parent = data
    for key in place[:-1]:
        parent = parent[key]
    del parent[place[-1]]
    with pytest.raises(ValueError, match=rf"bad\.json: .*{place[-1]} is missing$"):
        load_calibration(write(tmp_path / "bad.json", data))


def test_refuses_what_is_no_calibration_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"absent\.json"):
        load_calibration(tmp_path / "absent.json")
    (tmp_path / "text.json").write_text("{")
    with pytest.raises(ValueError, match=r"text\.json: not a JSON file"):
        load_calibration(tmp_path / "text.json")
    with pytest.raises(ValueError, match=r"list\.json: .*must be an object"):
        load_calibration(write(tmp_path / "list.json", [1]))


def test_a_field_without_its_unit_is_told_from_a_missing_one(tmp_path):
    data = plausible()
    data["curve"]["pressure"] = [1e-3 * p for p in data["curve"].pop("pressure_pa_gauge")]
    with pytest.raises(ValueError, match=r"curve\.pressure_pa_gauge is missing; pressure has no unit in its name$"):
        load_calibration(write(tmp_path / "bad.json", data))


def test_a_field_that_is_there_twice_is_refused(tmp_path):
    text = json.dumps(plausible()).replace('"mass_kg": 0.012', '"mass_kg": 0.012, "mass_kg": 0.013')
    (tmp_path / "twice.json").write_text(text)
    with pytest.raises(ValueError, match=r"twice\.json: mass_kg: must not be there twice"):
        load_calibration(tmp_path / "twice.json")


def test_any_damage_to_a_file_with_a_checksum_is_refused(tmp_path):
    shipped = json.loads(asset_path("calibration", "finger.json").read_text())
    shipped[CHECKSUM] = content_sha256(shipped)
    text = json.dumps(shipped, indent=1)
    (tmp_path / "whole.json").write_text(text)
    load_calibration(tmp_path / "whole.json")
    for end in (0, 1, len(text) // 2, len(text) - 3):
        (tmp_path / "cut.json").write_text(text[:end])
        with pytest.raises(ValueError, match=r"cut\.json: not a JSON file"):
            load_calibration(tmp_path / "cut.json")
    # one digit anywhere, be it in a field that the runtime never reads
    rng, refused = np.random.default_rng(0), 0
    digits = [k for k, letter in enumerate(text) if letter in "12345678"]
    for k in rng.choice(digits, 40).tolist():
        damaged = text[:k] + str(int(text[k]) + 1) + text[k + 1 :]
        if json.loads(damaged) == shipped:  # beyond the digits that a float has
            continue
        refused += 1
        (tmp_path / "digit.json").write_text(damaged)
        with pytest.raises(ValueError, match=r"digit\.json: "):
            load_calibration(tmp_path / "digit.json")
    assert refused > 30
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe" + text.encode())
    with pytest.raises(ValueError, match=r"bytes\.json: not a JSON file"):
        load_calibration(tmp_path / "bytes.json")
    (tmp_path / "deep.json").write_text("[" * 100_000)
    with pytest.raises(ValueError, match=r"deep\.json: not a JSON file"):
        load_calibration(tmp_path / "deep.json")


def test_shipped_calibration_meets_the_stated_angle():
    """The paper's one number: 95 degrees at 75 kPa."""
    assert load_calibration().angle_for_pressure(75e3) == pytest.approx(95.0, abs=2.0)
