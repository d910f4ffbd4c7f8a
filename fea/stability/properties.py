"""What must hold for any finger and any material: no crash, no silent NaN, only typed errors.

A property takes plain numbers, so that an example that fails is a JSON file. `ValueError` is the typed error of bad
input; anything else that is raised, and anything that is not finite, is a failure.
"""

import json
import math
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from fea.actuator import ActuatorMesh, actuator_lattice
from fea.assembly import SolidModel
from fea.geometry import MINIMUM_WALL_M, FingerGeometry
from fea.lattice import build_mesh
from fea.laws import StVenantKirchhoff
from fea.materials import LARGEST_EXPONENT, LEAST_EXPONENT, load_material

REFUSED = "refused"
_SMALL = ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1)


@dataclass(frozen=True, kw_only=True)
class SolidProperty:
    """One property: name, span of each of its values (two floats, two integers, or words), check, share of examples."""

    name: str
    spans: Mapping[str, tuple[Any, ...]]
    check: Callable[..., str]
    weight: int = 1


def geometry(**values: Any) -> str:
    """Refuse any dimensions by name, or mesh them with upright elements of positive volume."""
    starts = tuple(values.pop(f"gap_start_{k}_m") for k in range(3))
    try:
        finger = FingerGeometry(**values, gap_start_m=starts)
        mesh = build_mesh(actuator_lattice(finger, _SMALL))
        model = SolidModel(
            mesh=mesh,
            laws={k: StVenantKirchhoff(young_modulus_pa=1e6, poisson_ratio=0.3) for k in np.unique(mesh.material)},
            fixed=np.zeros((len(mesh.points_m), 3), dtype=bool),
        )
    except ValueError:
        return REFUSED
    assert np.isfinite(mesh.points_m).all(), "nodes that are no numbers"
    assert (model.weights > 0.0).all(), f"inverted elements: {int((model.weights <= 0.0).any(axis=1).sum())}"
    assert math.isfinite(finger.finger_length_m), f"length {finger.finger_length_m}"
    return "kept"


def material(  # noqa: PLR0913 - each is a value of the example
    *, shear_pa: float, second: float, alpha_0: float, alpha_1: float, signs: str, bulk: float, density: float,
    stretch: float, seed: int,
) -> str:  # fmt: skip
    """Read any sheet of rubber: refused by name, or energy, stress and tangent finite up to twofold stretches.

    The sheet has two Ogden terms: the first one's initial shear modulus, and the second one's as a share of that.
    """
    alpha_0, alpha_1 = (a if sign == "+" else -a for a, sign in zip((alpha_0, alpha_1), signs, strict=True))
    # half of mu alpha is a term's part of the initial shear modulus
    mu_0, mu_1 = (2.0 * part / a if a else math.nan for part, a in ((shear_pa, alpha_0), (second * shear_pa, alpha_1)))
    sheet = "\n".join(
        [
            'name = "any"', 'law = "ogden"', 'convention = "mu_over_alpha"', 'default_set = "one"', 'source = "any"',
            f'[density]\nvalue = {density!r}\nunit = "kg/m^3"\nsource = "any"',
            '[volumetric]\ndefault = "near_incompressible"',
            f'[volumetric.bulk_to_shear]\nvalue = {bulk!r}\nunit = "1"\nsource = "any"',
            f'[sets.one]\nmu = {{ value = [{mu_0!r}, {mu_1!r}], unit = "Pa" }}',
            f'alpha = {{ value = [{alpha_0!r}, {alpha_1!r}], unit = "1" }}\nd1 = {{ value = 1.0, unit = "Pa" }}',
        ]
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "any.toml"
        path.write_text(sheet, encoding="utf-8")
        try:
            law = load_material(path).law
        except ValueError:
            return REFUSED
    if not 1.0 <= stretch <= 2.0:
        return REFUSED
    rng = np.random.default_rng(seed)
    F = np.eye(3) + (stretch - 1.0) * rng.uniform(-0.3, 0.3, (4, 3, 3))
    stress, tangent = law.stress_and_tangent(F)
    for name, value in (("energy", law.energy(F)), ("stress", stress), ("tangent", tangent)):
        assert np.isfinite(value).all(), f"{name} is not finite"
    swapped = np.transpose(tangent, (0, 3, 4, 1, 2))
    assert np.allclose(tangent, swapped, atol=1e-9 * np.abs(tangent).max()), "tangent without major symmetry"
    json.dumps(float(np.abs(tangent).max()), allow_nan=False)
    return "kept"


def _around(finger: FingerGeometry, low: float, high: float) -> dict[str, tuple[Any, ...]]:
    """Return spans around a finger's dimensions; the gaps' places one by one."""
    spans: dict[str, tuple[Any, ...]] = {
        item.name: (low * getattr(finger, item.name), high * getattr(finger, item.name))
        for item in fields(finger)
        if isinstance(getattr(finger, item.name), float)
    }
    return spans | {f"gap_start_{k}_m": (0.9 * start, 1.1 * start) for k, start in enumerate(finger.gap_start_m)}


SOLID_PROPERTIES: Mapping[str, SolidProperty] = {
    one.name: one
    for one in (
        SolidProperty(
            name="geometry",
            spans=_around(FingerGeometry(), 0.98, 1.12)
            | {name: (MINIMUM_WALL_M, 1.12 * MINIMUM_WALL_M) for name in ("tube_wall_m", "end_plate_m")}
            | {"ring_count": (0, 14), "actuator_length_m": (0.08, 0.12)},
            check=geometry,
            weight=2,
        ),
        SolidProperty(
            name="material",
            spans={
                "shear_pa": (1e2, 1e8), "second": (-1.1, 5.0), "alpha_0": (LEAST_EXPONENT, LARGEST_EXPONENT),
                "alpha_1": (LEAST_EXPONENT, LARGEST_EXPONENT), "signs": ("++", "+-", "-+", "--"),
                "bulk": (0.1, 1e5), "density": (1.0, 2e4), "stretch": (1.0, 2.0), "seed": (0, 9999),
            },
            check=material,
            weight=2,
        ),
    )
}  # fmt: skip
"""Properties by name."""
