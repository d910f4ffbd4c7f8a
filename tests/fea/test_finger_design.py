"""A finger's TOML file: what it may hold, and every refusal by name before anything is meshed."""

from dataclasses import fields, replace

import pytest

from assets import asset_path
from fea.calibration import load_materials
from fea.finger_design import load_design, material_named
from fea.geometry import FingerGeometry

SHEET = """
name = "My silicone"
law = "ogden"
convention = "mu_over_alpha"
default_set = "soft"
source = "own tensile test"
[density]
value = 1.1
unit = "g/cm^3"
[volumetric]
default = "near_incompressible"
[volumetric.bulk_to_shear]
value = 500.0
unit = "1"
[sets.soft]
mu = { value = [80.0], unit = "kPa" }
alpha = { value = [2.0], unit = "1" }
[sets.hard]
mu = { value = [240.0], unit = "kPa" }
alpha = { value = [2.0], unit = "1" }
"""


@pytest.fixture
def design(tmp_path):
    def load(text):
        file = tmp_path / "mine.toml"
        file.write_text(text)
        return load_design(file)

    return load


def test_shipped_file_is_the_default_finger():
    shipped = load_design(asset_path("fingers", "default.toml"))
    assert shipped.geometry == FingerGeometry()
    assert shipped.materials == load_materials()
    written = asset_path("fingers", "default.toml").read_text()
    assert all(f"\n{f.name} = " in written for f in fields(FingerGeometry))


def test_stronger_finger_fits_in_the_papers_hand():
    base, strong = (load_design(asset_path("fingers", name)).geometry for name in ("default.toml", "strong.toml"))
    # thrust grows with the rings' area
    assert strong.ring_radius_m**2 > 1.5 * base.ring_radius_m**2
    # fingers stand 21 mm apart (softhand_sim.hand.anatomy)
    assert 2.0 * strong.tube_outer_radius_m < 0.021
    assert strong.finger_length_m == base.finger_length_m


def test_what_is_left_out_has_its_default(design):
    assert design("").geometry == FingerGeometry()
    found = design("[geometry]\ntube_wall_m = 2.5e-3\nring_count = 40\ngap_start_m = [0.006, 0.035, 0.06]")
    expected = replace(FingerGeometry(), tube_wall_m=2.5e-3, ring_count=40, gap_start_m=(0.006, 0.035, 0.06))
    assert found.geometry == expected
    assert found.materials == load_materials()


def test_materials_by_name_and_by_file(design, tmp_path):
    (tmp_path / "sheets").mkdir()
    (tmp_path / "sheets" / "mine.toml").write_text(SHEET)
    own = design('[materials]\nsilicone = "sheets/mine.toml"\ntpu = "ninjaflex/set1"').materials
    # W = mu / alpha (...): shear modulus mu alpha / 2
    assert own.silicone.law.shear_modulus_pa == pytest.approx(80e3)
    assert own.silicone.density_kg_m3 == pytest.approx(1100.0)
    assert own.tpu.law.shear_modulus_pa == pytest.approx(2.0 * (0.677e6 + 1.621e6))
    assert design('[materials]\nsilicone = "sheets/mine.toml/hard"').materials.silicone.parameter_set == "hard"
    assert material_named("ecoflex_00_50/set2") == material_named("ecoflex-00-50/set2")
    assert material_named("ninjaflex").parameter_set == "set3"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("[geometry]\ntube_wall_mm = 2.0", r"geometry\.tube_wall_mm: unknown field \(did you mean tube_wall_m\?\)"),
        ("[geometry]\nvolume = 2.0", r"geometry\.volume: unknown field; allowed: actuator_inner_radius_m"),
        ("[geometry]\ntube_wall_m = 2.0", r"tube_wall_m = 2 m must lie in \(0, 0\.3\) m; are the units metres"),
        ("[geometry]\ntube_wall_m = 0.001", r"tube_wall_m = 0\.001 m must be at least 0\.002"),
        ('[geometry]\ntube_wall_m = "2 mm"', r"geometry\.tube_wall_m = '2 mm' must be a finite number"),
        ("[geometry]\ntube_wall_m = true", r"geometry\.tube_wall_m = True must be a finite number"),
        ("[geometry]\ntube_wall_m = nan", r"geometry\.tube_wall_m = nan must be a finite number"),
        ("[geometry]\ntube_wall_m = [0.002]", r"geometry\.tube_wall_m = \[0\.002\] must be a finite number"),
        ("[geometry]\nring_count = 44.0", r"geometry\.ring_count = 44\.0 must be a whole number"),
        ("[geometry]\nring_count = 400", r"ring_count = 400 must lie in \[1, 200\]"),
        ("[geometry]\nsector_half_angle_rad = 62.2", r"sector_half_angle_rad = 62\.2 must lie in"),
        (
            "[geometry]\ngap_start_m = [0.006, 0.036]",
            r"geometry\.gap_start_m = \[0\.006, 0\.036\] must be a list of three",
        ),
        ("[geometry]\ngap_start_m = [0.006, nan, 0.06]", r"geometry\.gap_start_m\[1\] = nan must be a finite number"),
        ("[geometry]\ngap_length_m = 0.029", r"gap_start_m\[1\]"),
        ("[dimensions]\n", r"dimensions: unknown field; allowed: geometry, materials"),
        ("geometry = 3", r"geometry = 3 must be a table"),
        ("[materials]\nrubber = 'x'", r"materials\.rubber: unknown field; allowed: silicone, tpu, pet"),
        (
            "[materials]\nsilicone = 'ecoflex-00-30'",
            r"materials\.silicone = 'ecoflex-00-30': no such sheet; shipped: eco",
        ),
        (
            "[materials]\ntpu = 'ninjaflex/set9'",
            r"materials\.tpu = 'ninjaflex/set9': ninjaflex\.toml: sets has no 'set9'",
        ),
        ("[materials]\ntpu = 3", r"materials\.tpu = 3: must be a text"),
        ("[materials]\nsilicone = 'pet'", r"materials\.silicone: PET thread must have a law for rubber"),
        ("[geometry\n", r"not valid TOML"),
        ("[geometry]\ntube_wall_m = 0.002\ntube_wall_m = 0.003", r"not valid TOML"),
    ],
)
def test_bad_input_is_refused_by_name(design, tmp_path, text, named):
    with pytest.raises(ValueError, match=named) as caught:
        design(text)
    assert str(caught.value).startswith(str(tmp_path / "mine.toml"))
    assert "\n" not in str(caught.value)


def test_missing_files_are_named(design, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no finger file .*absent\.toml"):
        load_design(tmp_path / "absent.toml")
    with pytest.raises(FileNotFoundError, match=r"materials\.silicone = 'absent\.toml': no material sheet"):
        design("[materials]\nsilicone = 'absent.toml'")


def test_a_sheet_s_own_errors_name_role_sheet_and_field(design, tmp_path):
    (tmp_path / "sheet.toml").write_text(SHEET.replace('unit = "kPa"', 'unit = "psi"'))
    with pytest.raises(
        ValueError, match=r"materials\.silicone = 'sheet\.toml': sheet\.toml: sets\.soft\.mu\.unit = 'psi'"
    ):
        design("[materials]\nsilicone = 'sheet.toml'")
