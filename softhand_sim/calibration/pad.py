"""Reader of the pads' indentation curves: a rigid sphere pressed into the phalanges of the finite-element finger."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from assets import asset_path
from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.checks import require_finite

Vector = npt.NDArray[np.float64]
SCHEMA = "softhand-sim/finger-pad-evidence"
SCHEMA_VERSION = 1
SECTIONS = ("middle", "distal")
_LEAST_ROWS = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class PadCurve:
    """Depth of the sphere [m] and force of the finger on it [N], (n,), from zero on."""

    section: str
    depth_m: Vector
    force_n: Vector

    def __post_init__(self) -> None:
        if self.section not in SECTIONS:
            raise ValueError(f"section = {self.section!r}: must be one of {list(SECTIONS)}")
        for name in ("depth_m", "force_n"):
            values = getattr(self, name)
            if len(values) < _LEAST_ROWS or values[0] != 0.0 or (np.diff(values) <= 0.0).any():
                raise ValueError(f"{name} = {values.tolist()}: must be {_LEAST_ROWS} or more rising values from 0")
        if len(self.force_n) != len(self.depth_m):
            raise ValueError(f"force_n has {len(self.force_n)} rows: must have {len(self.depth_m)}")


@dataclass(frozen=True, kw_only=True, eq=False)
class PadEvidence:
    """Curves by section, for a sphere of ``sphere_radius_m``; ``provenance`` says how they were made."""

    geometry: Mapping[str, Any]
    sphere_radius_m: float
    curves: Mapping[str, PadCurve]
    provenance: Mapping[str, Any]

    def __post_init__(self) -> None:
        require_finite("sphere_radius_m", self.sphere_radius_m, above=0.0)
        if set(self.curves) != set(SECTIONS):
            raise ValueError(f"sections = {sorted(self.curves)}: must be {sorted(SECTIONS)}")


def load_pad_evidence(path: Path | None = None) -> PadEvidence:
    """Read and check the curves; the shipped ``assets/calibration/finger_pad_evidence.json`` by default.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file isn't of this schema and version, or a field is missing or wrong; the one-line message names file,
        field, value and what is allowed.
    """
    root = read_fields(asset_path("calibration", "finger_pad_evidence.json") if path is None else path)
    root.require_equal("schema", SCHEMA)
    root.require_equal("schema_version", SCHEMA_VERSION)
    with root.naming_file():
        curves = [_curve(fields) for fields in root.objects("sections", len(SECTIONS))]
        return PadEvidence(
            geometry=MappingProxyType(root.object("geometry").raw),
            sphere_radius_m=root.value("sphere_radius_m"),
            curves=MappingProxyType({curve.section: curve for curve in curves}),
            provenance=MappingProxyType(root.object("provenance").raw),
        )


def _curve(fields: Fields) -> PadCurve:
    return fields.build(
        PadCurve,
        section=fields.text("section"),
        depth_m=fields.numbers("depth_m", (None,)),
        force_n=fields.numbers("force_n", (None,)),
    )
