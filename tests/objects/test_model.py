"""Overrides of mass and friction, and refusals of the catalogue."""

import numpy as np
import pytest

from assets import asset_path
from softhand_sim.objects.catalogue import load_catalogue, make_object


def test_overrides_scale_inertia_and_leave_the_original_alone():
    apple = make_object("apple")
    heavy = apple.with_overrides(mass_kg=1.5, friction=0.05)
    assert (heavy.mass_kg, heavy.friction) == (1.5, 0.05)
    assert np.allclose(heavy.inertia_kg_m2, apple.inertia_kg_m2 * 1.5 / 0.068)
    assert (apple.mass_kg, apple.friction) == (0.068, 0.8)
    assert apple.with_overrides().mass_kg == apple.mass_kg


@pytest.mark.parametrize("mass", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_mass_is_refused(mass):
    with pytest.raises(ValueError, match="mass_kg"):
        make_object("apple").with_overrides(mass_kg=mass)


@pytest.mark.parametrize("friction", [-0.1, float("nan"), float("inf")])
def test_impossible_friction_is_refused(friction):
    with pytest.raises(ValueError, match="friction"):
        make_object("apple").with_overrides(friction=friction)


def test_unknown_object_is_named_with_the_choice():
    with pytest.raises(ValueError, match=r"'durian'.*apple, banana"):
        make_object("durian")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mass_kg = 0.068", "mass_kg = -1", r"'apple'.*mass_kg"),
        ("mass_kg = 0.068", 'mass_kg = "light"', r"'apple'.*mass_kg.*number"),
        ("mass_kg = 0.068\n", "", r"'apple'.*mass_kg"),
        ('kind = "apple"', 'kind = "durian"', r"'apple'.*shape.kind is 'durian'"),
        ("diameter_m = 0.075\n", "", r"'apple'.*missing \['diameter_m'\]"),
        ("diameter_m = 0.075", "diameter_m = 0.075\nstalk_m = 0.01", r"'apple'.*unknown \['stalk_m'\]"),
        ("ycb =", "isbn =", r"'apple'.*isbn.*may have ycb"),
        ("[apple]", "[apple", "not a TOML file"),
    ],
)
def test_wrong_catalogue_is_refused_by_name(tmp_path, old, new, message):
    text = asset_path("objects", "catalogue.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "catalogue.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ValueError, match=message) as caught:
        load_catalogue(path)
    assert "\n" not in str(caught.value)


def test_new_object_is_one_more_table(tmp_path):
    text = asset_path("objects", "catalogue.toml").read_text(encoding="utf-8")
    path = tmp_path / "catalogue.toml"
    table = """
[brick]
mass_kg = 0.5
friction = 0.6
rgba = [0.5, 0.2, 0.1, 1.0]
source = "test"
shape = { kind = "box", depth_m = 0.05, width_m = 0.1, height_m = 0.03 }
"""
    path.write_text(text + table, encoding="utf-8")
    assert load_catalogue(path)["brick"].parameters["width_m"] == 0.1


def test_missing_catalogue_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml"):
        load_catalogue(tmp_path / "nowhere.toml")
