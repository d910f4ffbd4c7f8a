"""Material sheets: TOML in, constitutive law and density out. Every parameter carries its unit."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assets import asset_path
from fea.laws import IsochoricOgden, StVenantKirchhoff

_UNITS: dict[str, dict[str, float]] = {
    "stress": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "density": {"kg/m^3": 1.0, "g/cm^3": 1e3},
    "number": {"1": 1.0},
}
_CONVENTIONS = {
    "ogden": ("mu_over_alpha", "two_mu_over_alpha_squared"),
    "mooney_rivlin": ("c10_c01",),
    "linear_elastic": ("young_poisson",),
}
VOLUMETRIC_READINGS = ("near_incompressible", "d1_literal")

LEAST_EXPONENT, LARGEST_EXPONENT = 1e-3, 100.0
"""Choice: Ogden's exponents in the literature lie within 0.1 and 30; 2 to the power of 1e300 is no number."""
LARGEST_MODULUS_PA = 2e12
"""Choice: twice diamond."""
AnyLaw = IsochoricOgden | StVenantKirchhoff


@dataclass(frozen=True, kw_only=True)
class Material:
    """One parameter set of one material sheet.

    Attributes
    ----------
    name, parameter_set, source : str
        What it is, which set of the sheet, and where the numbers come from.
    law : IsochoricOgden or StVenantKirchhoff
        Constitutive law with its bulk modulus.
    density_kg_m3 : float
        Mass density.
    parameters : mapping
        The set's entries in SI units, for provenance.
    """

    name: str
    parameter_set: str
    source: str
    law: AnyLaw
    density_kg_m3: float
    parameters: Mapping[str, Any]


def load_material(path: Path | str, parameter_set: str | None = None, volumetric: str | None = None) -> Material:
    """Read one set of a material sheet.

    Parameters
    ----------
    path : Path or str
        A TOML file, or the bare name of a shipped one (``"ninjaflex"``).
    parameter_set : str, optional
        Name under ``[sets]``; the sheet's ``default_set`` if not given.
    volumetric : str, optional
        ``"near_incompressible"`` (bulk modulus from ``bulk_to_shear``) or ``"d1_literal"`` (W_vol = D1 (J - 1)^2 with
        D1 in Pa, so kappa = 2 D1); the sheet's default if not given.

    Raises
    ------
    ValueError
        If a field is missing or out of range; the message names file, field, value and what is allowed.
    FileNotFoundError
        If there is no such sheet.
    """
    file = Path(path)
    if file.suffix != ".toml":
        file = asset_path("materials", f"{path}.toml")
    sheet = _Sheet(file)
    name = parameter_set or sheet.text("default_set")
    sets = sheet.table("sets")
    if name not in sets:
        raise ValueError(f"{file.name}: sets has no {name!r}; allowed: {sorted(sets)}")
    law, parameters = _law(sheet, f"sets.{name}", volumetric)
    density_at = f"sets.{name}.density" if "density" in sets[name] else "density"
    density = sheet.quantity(density_at, "density")
    if not density > 0.0:
        raise ValueError(f"{file.name}: {density_at} = {density:g} kg/m^3 must be positive")
    parameters["density_kg_m3"] = density
    return Material(
        name=sheet.text("name"),
        parameter_set=name,
        source=sheet.text("source"),
        law=law,
        density_kg_m3=density,
        parameters=parameters,
    )


def _law(sheet: "_Sheet", at: str, volumetric: str | None) -> tuple[AnyLaw, dict[str, Any]]:
    kind = sheet.choice("law", tuple(_CONVENTIONS))
    convention = sheet.choice("convention", _CONVENTIONS[kind])
    parameters: dict[str, Any] = {"law": kind, "convention": convention}
    if kind == "linear_elastic":
        young = sheet.quantity(f"{at}.young_modulus", "stress")
        poisson = sheet.quantity(f"{at}.poisson_ratio", "number")
        if not -1.0 < poisson < 0.5:
            raise ValueError(f"{sheet.file.name}: {at}.poisson_ratio = {poisson:g} must lie in (-1, 0.5)")
        _check_shear(sheet, at, young / (2.0 * (1.0 + poisson)))
        parameters |= {"young_modulus_pa": young, "poisson_ratio": poisson}
        return StVenantKirchhoff(young_modulus_pa=young, poisson_ratio=poisson), parameters
    if kind == "ogden":
        mu = sheet.quantities(f"{at}.mu", "stress")
        alpha = sheet.quantities(f"{at}.alpha", "number")
        if len(mu) != len(alpha) or not mu or 0.0 in alpha:
            raise ValueError(f"{sheet.file.name}: {at}.alpha = {alpha} must be as long as mu, without zeros")
        if not all(LEAST_EXPONENT <= abs(a) <= LARGEST_EXPONENT for a in alpha):
            allowed = f"[{LEAST_EXPONENT:g}, {LARGEST_EXPONENT:g}]"
            raise ValueError(f"{sheet.file.name}: {at}.alpha = {alpha} must have sizes in {allowed}")
        if convention == "mu_over_alpha":
            coefficients = tuple(m / a for m, a in zip(mu, alpha, strict=True))
        else:
            coefficients = tuple(2.0 * m / a**2 for m, a in zip(mu, alpha, strict=True))
        parameters |= {"mu_pa": list(mu), "alpha": list(alpha)}
    else:
        coefficients = (sheet.quantity(f"{at}.c10", "stress"), sheet.quantity(f"{at}.c01", "stress"))
        alpha = (2.0, -2.0)
        parameters |= {"c10_pa": coefficients[0], "c01_pa": coefficients[1]}
    shear = IsochoricOgden(coefficients_pa=coefficients, exponents=alpha).shear_modulus_pa
    _check_shear(sheet, at, shear)
    bulk, reading = _bulk(sheet, at, shear, volumetric)
    parameters |= {"initial_shear_modulus_pa": shear, "bulk_modulus_pa": bulk, "volumetric": reading}
    return IsochoricOgden(coefficients_pa=coefficients, exponents=alpha, bulk_modulus_pa=bulk), parameters


def _bulk(sheet: "_Sheet", at: str, shear: float, volumetric: str | None) -> tuple[float, str]:
    reading = volumetric or sheet.text("volumetric.default")
    if reading not in VOLUMETRIC_READINGS:
        raise ValueError(f"{sheet.file.name}: volumetric = {reading!r}; allowed: {list(VOLUMETRIC_READINGS)}")
    if reading == "d1_literal":
        bulk = 2.0 * sheet.quantity(f"{at}.d1", "stress")
    else:
        bulk = shear * sheet.quantity("volumetric.bulk_to_shear", "number")
    if not 0.0 < bulk < 1e3 * LARGEST_MODULUS_PA:
        allowed = f"(0, {1e3 * LARGEST_MODULUS_PA:g}) Pa"
        raise ValueError(f"{sheet.file.name}: {at}: bulk modulus {bulk:g} Pa must be positive, in {allowed}")
    return bulk, reading


def _check_shear(sheet: "_Sheet", at: str, shear: float) -> None:
    if not 0.0 < shear < LARGEST_MODULUS_PA:
        allowed = f"(0, {LARGEST_MODULUS_PA:g}) Pa"
        raise ValueError(f"{sheet.file.name}: {at}: initial shear modulus {shear:g} Pa must be positive, in {allowed}")


class _Sheet:
    """A parsed TOML file whose accessors name file and field when something is wrong."""

    def __init__(self, file: Path) -> None:
        if not file.is_file():
            raise FileNotFoundError(f"no material sheet {file}")
        self.file = file
        try:
            self.data: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
        except tomllib.TOMLDecodeError as error:
            raise ValueError(f"{file.name}: not valid TOML: {error}") from None

    def get(self, at: str) -> Any:
        value: Any = self.data
        for key in at.split("."):
            if not isinstance(value, dict) or key not in value:
                raise ValueError(f"{self.file.name}: field {at!r} is missing")
            value = value[key]
        return value

    def table(self, at: str) -> dict[str, Any]:
        value = self.get(at)
        if not isinstance(value, dict):
            raise ValueError(f"{self.file.name}: {at} = {value!r} must be a table")
        return value

    def text(self, at: str) -> str:
        value = self.get(at)
        if not isinstance(value, str) or not value:
            raise ValueError(f"{self.file.name}: {at} = {value!r} must be a text")
        return value

    def choice(self, at: str, allowed: tuple[str, ...]) -> str:
        value = self.text(at)
        if value not in allowed:
            raise ValueError(f"{self.file.name}: {at} = {value!r}; allowed: {list(allowed)}")
        return value

    def quantity(self, at: str, kind: str) -> float:
        value = self._value(at)
        return self._number(at, value) * self._factor(at, kind)

    def quantities(self, at: str, kind: str) -> tuple[float, ...]:
        value = self._value(at)
        if not isinstance(value, list):
            raise ValueError(f"{self.file.name}: {at}.value = {value!r} must be a list of numbers")
        factor = self._factor(at, kind)
        return tuple(self._number(at, v) * factor for v in value)

    def _value(self, at: str) -> Any:
        table = self.get(at)
        if not isinstance(table, dict) or "value" not in table:
            raise ValueError(f"{self.file.name}: {at} = {table!r} must be a table with 'value' and 'unit'")
        return table["value"]

    def _factor(self, at: str, kind: str) -> float:
        allowed = _UNITS[kind]
        unit = self.get(at).get("unit")
        if unit not in allowed:
            state = "is missing" if unit is None else f"= {unit!r} is unknown"
            raise ValueError(f"{self.file.name}: {at}.unit {state}; allowed: {sorted(allowed)}")
        return allowed[unit]

    def _number(self, at: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise ValueError(f"{self.file.name}: {at}.value = {value!r} must be a finite number")
        return float(value)
