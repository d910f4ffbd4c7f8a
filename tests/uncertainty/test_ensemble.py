"""Ensemble of calibrations: reading, fingers between its members, bands."""

import json

import numpy as np
import pytest

from assets import asset_path
from softhand_sim.calibration import load_calibration
from softhand_sim.calibration.integrity import content_sha256
from softhand_sim.characterize.bench import Bench
from softhand_sim.uncertainty import (
    blended,
    combined_band,
    drawn_coordinates,
    load_ensemble,
    scenario_band,
    tolerance_band,
)
from softhand_sim.uncertainty.monotone import nearest_monotone

SHIPPED = json.loads((asset_path("calibration") / "finger.json").read_text())


def signed(content):
    bare = {key: value for key, value in content.items() if key != "content_sha256"}
    return bare | {"content_sha256": content_sha256(bare)}


def stiffer(factor, bend):
    """Return the shipped finger with stiffer joints and a curve that bends less."""
    made = json.loads(json.dumps(SHIPPED))
    for joint in made["joints"]:
        for name in ("stiffness_n_m_per_rad", "stiffness_n_m_per_rad2", "stiffness_n_m_per_rad3"):
            joint[name] *= factor
    made["curve"]["joint_angle_deg"] = (bend * np.array(made["curve"]["joint_angle_deg"])).tolist()
    made["curve"]["tip_angle_deg"] = [sum(row) for row in made["curve"]["joint_angle_deg"]]
    return signed(made)


@pytest.fixture
def manifest():
    return {
        "schema": "softhand-sim/calibration-ensemble",
        "schema_version": 1,
        "nominal_sha256": SHIPPED["content_sha256"],
        "sources": [
            {
                "name": "wall",
                "kind": "tolerance",
                "text": "a wall",
                "members": [
                    {"name": "thin", "at": -1.0, "file": "thin.json"},
                    {"name": "thick", "at": 1.0, "file": "thick.json"},
                ],
            },
            {
                "name": "mesh",
                "kind": "tolerance",
                "text": "one side only",
                "members": [{"name": "coarse", "at": -10.0, "file": "thick.json"}],
            },
            {
                "name": "sets",
                "kind": "scenarios",
                "text": "another material",
                "members": [
                    {"name": "hard", "at": None, "file": "thick.json"},
                    {"name": "soft", "at": None, "refused": "lost its equilibrium"},
                ],
            },
        ],
        "provenance": {},
    }


@pytest.fixture
def folder(tmp_path, manifest):
    (tmp_path / "thin.json").write_text(json.dumps(stiffer(0.8, 1.1)))
    (tmp_path / "thick.json").write_text(json.dumps(stiffer(1.3, 0.9)))
    (tmp_path / "ensemble.json").write_text(json.dumps(manifest))
    return tmp_path


@pytest.fixture
def ensemble(folder):
    return load_ensemble(folder)


def loaded(content, folder):
    file = folder / "between.json"
    file.write_text(json.dumps(content))
    return load_calibration(file)


def test_members_and_refusals_are_read(ensemble):
    assert [source.name for source in ensemble.of_kind("tolerance")] == ["wall", "mesh"]
    refused = [(source.name, member.name, member.refused) for source, member in ensemble.members() if member.refused]
    assert refused == [("sets", "soft", "lost its equilibrium")]


def test_a_finger_at_a_member_is_the_member_and_at_zero_the_nominal_one(ensemble, folder):
    assert loaded(blended(ensemble, {}), folder).joints == ensemble.nominal.calibration.joints
    got = loaded(blended(ensemble, {"wall": 1.0}), folder)
    wanted = load_calibration(folder / "thick.json")
    for a, b in zip(got.joints, wanted.joints, strict=True):
        assert a.polynomial == pytest.approx(b.polynomial, rel=1e-12)
    np.testing.assert_allclose(got.curve.tip_angle_deg, wanted.curve.tip_angle_deg, rtol=1e-12)


def test_differences_add_up_and_a_missing_side_mirrors_the_other(ensemble):
    def middle(**at):
        return (
            blended(ensemble, at)["joints"][1]["stiffness_n_m_per_rad"] / SHIPPED["joints"][1]["stiffness_n_m_per_rad"]
        )

    assert middle(wall=0.5) == pytest.approx(1.15)
    assert middle(wall=-0.5) == pytest.approx(0.9)
    assert middle(mesh=-1.0) == pytest.approx(1.03)
    assert middle(mesh=1.0) == pytest.approx(0.97)
    assert middle(wall=0.5, mesh=1.0) == pytest.approx(1.12)


@pytest.mark.parametrize("seed", range(3))
def test_every_drawn_finger_of_the_shipped_ensemble_is_valid_monotone_and_in_balance(seed, tmp_path):
    shipped = load_ensemble()
    for at in drawn_coordinates(shipped, 4, np.random.default_rng(seed)):
        calibration = loaded(blended(shipped, at), tmp_path)
        angle = np.linspace(0.0, 1.4, 200)
        for joint in calibration.joints:
            a, b, c = joint.polynomial
            assert (a + 2.0 * b * angle + 3.0 * c * angle**2 >= 0.0).all()
    # the curve is interpolated, and so are the laws: the laws' own equilibrium must be on the curve
    reading = Bench(calibration).go_to(60e3)
    assert reading.tip_angle_deg == pytest.approx(calibration.angle_for_pressure(60e3), abs=0.3)


def test_the_nearest_monotone_law_is_monotone_and_none_of_its_neighbours_is_nearer():
    q = np.linspace(0.0, 0.9, 91)[1:]

    def law(a, b, c):
        return a * q + b * q**2 + c * q**3

    a, b, c = nearest_monotone(0.034, -0.0029, 3.45e-5)
    assert b * b <= 3.0 * a * c * (1.0 + 1e-9)
    off = np.linalg.norm(law(a, b, c) - law(0.034, -0.0029, 3.45e-5))
    assert off < 0.01 * np.linalg.norm(law(a, b, c))
    # along the boundary of the cone, and inwards
    for da in np.linspace(-2e-3, 2e-3, 21):
        for dc in np.linspace(-0.9 * c, 3e-3, 21):
            near = (a + da, -np.sqrt(3.0 * (a + da) * (c + dc)), c + dc)
            assert np.linalg.norm(law(*near) - law(0.034, -0.0029, 3.45e-5)) > off * (1.0 - 1e-3)
    assert nearest_monotone(0.03, 0.0, 1e-3) == (0.03, 0.0, 1e-3)
    with pytest.raises(ValueError, match=r"stiffness_n_m_per_rad = -1: must be above 0"):
        nearest_monotone(-1.0, 0.0, 0.0)


def test_draws_fill_every_part_of_the_tolerance(ensemble):
    drawn = drawn_coordinates(ensemble, 8, np.random.default_rng(3))
    for name in ("wall", "mesh"):
        column = np.sort([at[name] for at in drawn])
        edges = np.linspace(-1.0, 1.0, 9)
        assert ((edges[:-1] <= column) & (column <= edges[1:])).all()
    half = drawn_coordinates(ensemble, 8, np.random.default_rng(3), spread=0.5)
    assert [at["wall"] for at in half] == pytest.approx([0.5 * at["wall"] for at in drawn])
    assert drawn_coordinates(ensemble, 2, np.random.default_rng(3), spread=0.0) == [{"wall": 0.0, "mesh": 0.0}] * 2


def figures(nominal=10.0, thin=12.0, thick=8.0, hard=4.0):
    named = {"nominal": nominal, "thin": thin, "thick": thick, "coarse": nominal, "hard": hard}
    return {name: {"angle": value} for name, value in named.items()}


def test_the_band_of_a_source_holds_the_nominal_value_and_grows_with_the_spread(ensemble):
    wall = ensemble.sources[0]
    bands = [tolerance_band(ensemble, wall, figures(), spread=s)["angle"] for s in (0.0, 0.5, 1.0)]
    assert [(b.low, b.high) for b in bands] == [(10.0, 10.0), (9.0, 11.0), (8.0, 12.0)]
    # both ends on one side: the nominal finger is the other end
    one_sided = tolerance_band(ensemble, wall, figures(thin=9.0, thick=8.0))["angle"]
    assert (one_sided.low, one_sided.nominal, one_sided.high) == (8.0, 10.0, 10.0)


def test_scenarios_are_least_and_largest_and_the_missing_ones_are_named(ensemble):
    band = scenario_band(ensemble, ensemble.sources[2], figures())["angle"]
    assert (band.low, band.high, band.missing) == (4.0, 10.0, ("soft",))
    nothing = scenario_band(ensemble, ensemble.sources[2], figures(hard=None))["angle"]
    assert (nothing.low, nothing.high, nothing.missing) == (10.0, 10.0, ("hard", "soft"))


def test_tolerances_together_are_the_closed_form_of_their_sum(ensemble):
    def half(**values):
        band = combined_band(ensemble, figures(**values), np.random.default_rng(0))["angle"]
        assert band.high - 10.0 == pytest.approx(10.0 - band.low, abs=0.05)
        return 0.5 * (band.high - band.low)

    # one uniform tolerance of half width 2: 95 % of it
    assert half() == pytest.approx(0.95 * 2.0, abs=0.01)
    # two of half width 2 (the mesh at -10 with a difference of 20): P(|x + y| > t) = (2 - t / 2)^2 / 4 = 0.05
    both = {**figures(), "coarse": {"angle": 30.0}}
    band = combined_band(ensemble, both, np.random.default_rng(0))["angle"]
    assert 0.5 * (band.high - band.low) == pytest.approx(2.0 * (2.0 - np.sqrt(0.2)), abs=0.05)


def edited(manifest, change):
    change(manifest)
    return json.dumps(manifest)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda m: m.update(schema_version=2), "schema_version = 2: must be 1"),
        (lambda m: m.update(nominal_sha256="0" * 64), "nominal_sha256 = '000.*the ensemble is of another finger"),
        (lambda m: m.update(sources=[]), r"sources = \[\]: must be a list of one source or more"),
        (lambda m: m["sources"][0].update(kind="maybe"), r"sources\[0\]\.kind = 'maybe': must be 'tolerance'"),
        (lambda m: m["sources"][0]["members"][0].update(at="x"), r"members\[0\]\.at = 'x': must be a number"),
        (lambda m: m["sources"][0]["members"][0].update(at=0.5), r"members\[0\]\.at = 0\.5: must be 1 or above"),
        (lambda m: m["sources"][0]["members"][0].update(at=2.0), "one member on either side of 0"),
        (lambda m: m["sources"][2]["members"][0].update(at=1.0), r"members\[0\]\.at = 1\.0: must be null"),
        (lambda m: m["sources"][0]["members"][0].update(file="../a.json"), r"file = '\.\./a\.json': must be a path in"),
        (lambda m: m["sources"][0]["members"][0].update(file="none.json"), "none.json: no such calibration file"),
        (lambda m: m["sources"][1].update(name="wall"), r"sources\.name = .*: must be different names"),
    ],
)
def test_a_wrong_manifest_is_refused_by_name(folder, manifest, change, told):
    (folder / "ensemble.json").write_text(edited(manifest, change))
    with pytest.raises((ValueError, FileNotFoundError), match=told):
        load_ensemble(folder)


def test_a_damaged_member_is_refused(folder):
    text = (folder / "thin.json").read_text()
    (folder / "thin.json").write_text(text.replace("0.012855309653652978", "0.013855309653652978"))
    with pytest.raises(ValueError, match=r"thin\.json: content_sha256"):
        load_ensemble(folder)


@pytest.mark.parametrize(
    ("at", "told"),
    [
        ({"roof": 0.5}, "coordinates.roof: no such tolerance; known: wall, mesh"),
        ({"sets": 0.5}, "coordinates.sets: no such tolerance"),
        ({"wall": 2.5}, r"coordinates\.wall = 2\.5: must be a number in \[-2, 2\]"),
    ],
)
def test_a_place_that_is_none_is_named(ensemble, at, told):
    with pytest.raises(ValueError, match=told):
        blended(ensemble, at)


def test_a_spread_out_of_range_is_named(ensemble):
    with pytest.raises(ValueError, match=r"spread = -0\.1: must be a number in \[0, 2\]"):
        drawn_coordinates(ensemble, 2, np.random.default_rng(0), spread=-0.1)
