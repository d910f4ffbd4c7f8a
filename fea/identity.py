"""What a calibration depends on, and its hash: equal hash, equal result; any difference, another hash."""

from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from fea.calibration import FINGER_PATH, TARGET_PRESSURE_PA_GAUGE, TARGET_TIP_ANGLE_DEG, Materials
from fea.checkpoint import code_version
from fea.compiled import kernel_name
from fea.density import Density
from fea.exoskeleton import LOADS_N
from fea.finger import CONTACT, MESHES, OPTIONS
from fea.geometry import FingerGeometry
from fea.linear_solver import solver_name
from fea.materials import Material
from fea.newton import NewtonOptions

PACKAGES = ("softhand-sim", "numpy", "scipy", "scikit-fem", "ipctk", "pypardiso", "mkl", "numba")
"""Packages whose arithmetic, or whose version, is in the result."""


def finger_identity(
    geometry: FingerGeometry, materials: Materials, density: Density, *, choose_sector: bool = False
) -> dict[str, Any]:
    """Return everything that a calibration depends on, in named parts, JSON ready.

    The code's part is the hash of the package's source, so that a change of any analysis or fit is a change here. What
    only decides how fast a result comes, the number of threads, is left out.
    """
    return {
        "geometry": geometry.as_dict(),
        "materials": {role: _material(getattr(materials, role)) for role in ("silicone", "tpu", "pet")},
        "mesh": asdict(density) | {"finger": asdict(MESHES[density.name])},
        "settings": {
            "choose_sector": choose_sector,
            "target_tip_angle_deg": TARGET_TIP_ANGLE_DEG,
            "target_pressure_pa_gauge": TARGET_PRESSURE_PA_GAUGE,
            "finger_path": asdict(FINGER_PATH),
            "load_n": list(LOADS_N),
            "contact": asdict(CONTACT),
            "newton": _finite(asdict(NewtonOptions())),
            "newton_finger": _finite(asdict(OPTIONS)),
        },
        "code": {"fea_sha256": code_version(), "linear_solver": solver_name(), "element_kernels": kernel_name()},
        "versions": {name: _version(name) for name in PACKAGES},
    }


def _material(m: Material) -> dict[str, Any]:
    law = {"type": type(m.law).__name__, **asdict(m.law)}
    more = {"name": m.name, "set": m.parameter_set, "source": m.source, "density_kg_m3": m.density_kg_m3}
    return more | {"law": law, "parameters": dict(m.parameters)}


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    """Return the values with infinity, which JSON does not have, as text."""
    return {k: v if not isinstance(v, float) or abs(v) < float("inf") else str(v) for k, v in values.items()}


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
