"""Reader of the evidence of the finger's weight: the finite-element finger under gravity in attitudes of the hand."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from assets import asset_path
from softhand_sim.calibration.evidence import require_same_finger
from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.calibration.parts import JOINTS
from softhand_sim.calibration.reader import FingerCalibration

Vector = npt.NDArray[np.float64]
SCHEMA = "softhand-sim/finger-weight-evidence"
SCHEMA_VERSION = 1


@dataclass(frozen=True, kw_only=True, eq=False)
class WeighedFinger:
    """A finger inflated under gravity: rows (n,), joint angles (n, 3), the first row without pressure or weight.

    ``gravity_m_per_s2`` (2,) lies in the plane of bending: towards the palm side, and along the straight finger to its
    tip.
    """

    name: str
    gravity_m_per_s2: Vector
    pressure_pa_gauge: Vector
    joint_angle_rad: Vector

    def __post_init__(self) -> None:
        size = float(np.linalg.norm(self.gravity_m_per_s2))
        if not 0.0 < size <= 100.0:
            raise ValueError(f"gravity_m_per_s2 = {self.gravity_m_per_s2.tolist()}: must be of 0 to 100 m/s2, not 0")
        rows = len(self.pressure_pa_gauge)
        if rows < 2 or (np.diff(self.pressure_pa_gauge) <= 0.0).any():
            raise ValueError(f"pressure_pa_gauge = {self.pressure_pa_gauge.tolist()}: must be 2 or more rising values")
        if self.joint_angle_rad.shape != (rows, len(JOINTS)):
            raise ValueError(f"joint_angle_rad has shape {self.joint_angle_rad.shape}: must be ({rows}, {len(JOINTS)})")

    @property
    def tip_angle_deg(self) -> Vector:
        """Sum of the joint angles [deg], (n,)."""
        return np.asarray(np.degrees(self.joint_angle_rad.sum(axis=1)))


@dataclass(frozen=True, kw_only=True, eq=False)
class WeightEvidence:
    """The finger in some attitudes; ``provenance`` says how it was solved."""

    geometry: Mapping[str, Any]
    attitudes: tuple[WeighedFinger, ...]
    provenance: Mapping[str, Any]

    def require_same_finger(self, calibration: FingerCalibration) -> None:
        """Raise unless the calibration is of the dimensions, materials and mesh that the evidence was measured with."""
        require_same_finger(self.geometry, self.provenance, calibration)


def weightless_deg(calibration: FingerCalibration, pressure_pa_gauge: float) -> float:
    """Return the tip angle of the calibration's own analysis while loading, without weight [deg].

    Raises
    ------
    ValueError
        If the pressure is not one of its states.
    """
    up = calibration.analysis.loading
    return _row_deg(
        calibration.analysis.pressure_pa_gauge[up], calibration.analysis.tip_angle_deg[up], pressure_pa_gauge
    )


def load_weight_evidence(path: Path | None = None) -> WeightEvidence:
    """Read and check the evidence; the shipped ``assets/calibration/finger_weight_evidence.json`` by default.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file isn't evidence of this schema and version, or a field is missing or wrong; the one-line message
        names file, field, value and what is allowed.
    """
    root = read_fields(asset_path("calibration", "finger_weight_evidence.json") if path is None else path)
    root.require_equal("schema", SCHEMA)
    root.require_equal("schema_version", SCHEMA_VERSION)
    attitudes = root.value("attitudes")
    if not isinstance(attitudes, list) or not attitudes:
        raise root.error("attitudes", attitudes, "a list of one attitude or more")
    with root.naming_file():
        return WeightEvidence(
            geometry=MappingProxyType(root.object("geometry").raw),
            attitudes=tuple(_attitude(fields) for fields in root.objects("attitudes", len(attitudes))),
            provenance=MappingProxyType(root.object("provenance").raw),
        )


def _attitude(fields: Fields) -> WeighedFinger:
    return fields.build(
        WeighedFinger,
        name=fields.text("name"),
        gravity_m_per_s2=fields.numbers("gravity_m_per_s2", (2,)),
        pressure_pa_gauge=fields.numbers("pressure_pa_gauge", (None,)),
        joint_angle_rad=fields.numbers("joint_angle_rad", (None, 3)),
    )


def _row_deg(pressure: Vector, angle_deg: Vector, wanted: float) -> float:
    rows = np.flatnonzero(pressure == wanted)
    if len(rows) != 1:
        raise ValueError(f"pressure_pa_gauge = {wanted:g}: must be one of {pressure.tolist()}")
    return float(angle_deg[rows[0]])
