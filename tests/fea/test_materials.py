import numpy as np
import pytest

from assets import asset_path
from fea.materials import load_material


def edited(tmp_path, sheet: str, old: str, new: str):
    text = asset_path("materials", f"{sheet}.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / f"{sheet}.toml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def test_initial_shear_moduli_are_those_of_the_fact_sheet():
    moduli = [load_material("ecoflex_00_50", f"set{k}").law.shear_modulus_pa for k in (1, 2, 3)]
    np.testing.assert_allclose(moduli, [166.9e3, 79.9e3, 59.7e3], rtol=2e-3)
    young = [6e-6 * sum(load_material("ninjaflex", f"set{k}").law.coefficients_pa) for k in (1, 3)]
    np.testing.assert_allclose(young, [13.8, 4.4], rtol=5e-3)


def test_the_other_ogden_convention_reverses_the_order(tmp_path):
    path = edited(tmp_path, "ecoflex_00_50", 'convention = "mu_over_alpha"', 'convention = "two_mu_over_alpha_squared"')
    moduli = [load_material(path, f"set{k}").law.shear_modulus_pa for k in (1, 2, 3)]
    np.testing.assert_allclose(moduli, [20.8e3, 148.8e3, 111.1e3], rtol=3e-3)


def test_density_and_volumetric_readings():
    assert load_material("ninjaflex", "set1").density_kg_m3 == pytest.approx(1190.0)
    assert load_material("ninjaflex").density_kg_m3 == pytest.approx(830.0)
    assert load_material("pet").density_kg_m3 == pytest.approx(1541.0)
    silicone = load_material("ecoflex_00_50")
    assert silicone.law.bulk_modulus_pa > 100 * silicone.law.shear_modulus_pa
    literal = load_material("ecoflex_00_50", volumetric="d1_literal").law
    assert literal.bulk_modulus_pa == pytest.approx(2.0e5)


@pytest.mark.parametrize(
    ("sheet", "old", "new", "message"),
    [
        ("ecoflex_00_50", '"mu_over_alpha"', '"holzapfel"', r"ecoflex_00_50.toml: convention = 'holzapfel'; allowed"),
        ("ecoflex_00_50", "[1.12e5, 45.0, -975.0]", "[-1.12e5, 45.0, -975.0]", r"sets.set3: initial shear modulus"),
        ("ecoflex_00_50", '-975.0], unit = "Pa"', "-975.0]", r"sets.set3.mu.unit is missing; allowed: .*MPa"),
        ("ecoflex_00_50", "alpha = { value = [1.05, 4.00", "alpha = { value = [4.00", r"sets.set3.alpha"),
        (
            "ninjaflex",
            'c10 = { value = 0.210, unit = "MPa" }',
            "c10 = { value = 0.210 }",
            r"sets.set3.c10.unit is missing",
        ),
        ("ninjaflex", 'value = 0.210, unit = "MPa"', 'value = 0.210, unit = "psi"', r"'psi' is unknown; allowed"),
        ("ninjaflex", 'value = 0.210, unit = "MPa"', 'value = -0.6, unit = "MPa"', r"initial shear modulus -150000 Pa"),
        ("ninjaflex", "value = 0.210", "value = nan", r"sets.set3.c10.value = nan must be a finite number"),
        ("pet", "value = 0.417", "value = 0.5", r"poisson_ratio = 0.5 must lie in"),
        ("pet", 'value = 1541.0\nunit = "kg/m^3"', "value = 1541.0", r"density.unit is missing"),
        ("pet", "law =", "lore =", r"field 'law' is missing"),
    ],
)
def test_bad_sheets_are_refused(tmp_path, sheet, old, new, message):
    path = edited(tmp_path, sheet, old, new)
    with pytest.raises(ValueError, match=message):
        load_material(path)


def test_unknown_set_reading_and_file():
    with pytest.raises(ValueError, match=r"sets has no 'set9'; allowed: \['set1', 'set2', 'set3'\]"):
        load_material("ninjaflex", "set9")
    with pytest.raises(ValueError, match="volumetric = 'stiff'; allowed"):
        load_material("ecoflex_00_50", volumetric="stiff")
    with pytest.raises(FileNotFoundError, match="no_such"):
        load_material("no_such")
