"""Reader of the evidence: what the finite-element finger does on bench tests, to hold the simulated one against."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from assets import asset_path
from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.calibration.parts import FingerCycle
from softhand_sim.calibration.reader import FingerCalibration, build_cycle
from softhand_sim.checks import require_finite

Vector = npt.NDArray[np.float64]
SCHEMA = "softhand-sim/finger-evidence"
SCHEMA_VERSION = 1


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockedEvidence:
    """A wall ``sensor_distance_m`` in front of the tip: rows (n,), force zero before it arrives."""

    sensor_distance_m: float
    pressure_pa_gauge: Vector
    joint_angle_rad: Vector
    tip_force_n: Vector

    def __post_init__(self) -> None:
        require_finite("sensor_distance_m", self.sensor_distance_m, above=0.0)
        _require_rows(self, ("joint_angle_rad", "tip_force_n"), len(self.pressure_pa_gauge))
        _require_rising("pressure_pa_gauge", self.pressure_pa_gauge)


@dataclass(frozen=True, kw_only=True, eq=False)
class TipLoadEvidence:
    """Loads on the tip towards the back of the hand, at one pressure: rows (n,), the first one without load."""

    pressure_pa_gauge: float
    tip_load_n: Vector
    joint_angle_rad: Vector
    tip_displacement_m: Vector

    def __post_init__(self) -> None:
        require_finite("pressure_pa_gauge", self.pressure_pa_gauge, above=0.0)
        _require_rows(self, ("joint_angle_rad", "tip_displacement_m"), len(self.tip_load_n))
        _require_rising("tip_load_n", self.tip_load_n)

    @property
    def deflection_m(self) -> Vector:
        """How much nearer each load brings the tip to where it is when straight [m], (n,)."""
        return np.asarray(self.tip_displacement_m[0] - self.tip_displacement_m)


@dataclass(frozen=True, kw_only=True, eq=False)
class FingerEvidence:
    """Everything that was measured on the finite-element finger; ``provenance`` says how."""

    geometry: Mapping[str, Any]
    cycle: FingerCycle
    blocked: BlockedEvidence
    tip_loads: tuple[TipLoadEvidence, ...]
    provenance: Mapping[str, Any]

    def require_same_finger(self, calibration: FingerCalibration) -> None:
        """Raise unless the calibration is of the dimensions, materials and mesh that the evidence was measured with."""
        require_same_finger(self.geometry, self.provenance, calibration)


def require_same_finger(
    geometry: Mapping[str, Any], provenance: Mapping[str, Any], calibration: FingerCalibration
) -> None:
    """Raise unless a calibration is of the dimensions, materials and mesh of a piece of evidence.

    Raises
    ------
    ValueError
        If it is of another finger; the message names the field.
    """
    for name, value in geometry.items():
        if calibration.geometry.get(name) != value:
            raise ValueError(
                f"geometry.{name} = {calibration.geometry.get(name)!r}: the evidence is of a finger with {value!r}"
            )
    made = calibration.notes["provenance"]
    if made.get("density") != provenance.get("density"):
        raise ValueError(
            f"provenance.density = {made.get('density')!r}: the evidence is of {provenance.get('density')!r}"
        )
    own = made.get("materials", {})
    for material in provenance.get("materials", {}).values():
        found = own.get(material["name"], {})
        if found.get("parameters") != material["parameters"]:
            raise ValueError(
                f"provenance.materials.{material['name']} is of set {found.get('set')!r}: the evidence is of "
                f"{material['set']!r}"
            )


def load_evidence(path: Path | None = None) -> FingerEvidence:
    """Read and check the evidence; the shipped ``assets/calibration/finger_evidence.json`` by default.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file isn't evidence of this schema and version, or a field is missing or wrong; the one-line message
        names file, field, value and what is allowed.
    """
    root = read_fields(asset_path("calibration", "finger_evidence.json") if path is None else path)
    root.require_equal("schema", SCHEMA)
    root.require_equal("schema_version", SCHEMA_VERSION)
    blocked = root.object("blocked")
    loads = root.value("tip_loads")
    if not isinstance(loads, list) or not loads:
        raise root.error("tip_loads", loads, "a list of one test or more")
    with root.naming_file():
        return FingerEvidence(
            geometry=MappingProxyType(root.object("geometry").raw),
            cycle=build_cycle(root.object("cycle")),
            blocked=blocked.build(BlockedEvidence, **_arrays(blocked, "pressure_pa_gauge", "tip_force_n")),
            tip_loads=tuple(
                test.build(TipLoadEvidence, **_arrays(test, "tip_load_n", "tip_displacement_m"))
                for test in root.objects("tip_loads", len(loads))
            ),
            provenance=MappingProxyType(root.object("provenance").raw),
        )


def _arrays(fields: Fields, *names: str) -> dict[str, Vector]:
    """Return the joint angles and the named columns."""
    return {"joint_angle_rad": fields.numbers("joint_angle_rad", (None, 3))} | {
        name: fields.numbers(name, (None,)) for name in names
    }


def _require_rows(table: object, names: tuple[str, ...], rows: int) -> None:
    for name in names:
        if len(getattr(table, name)) != rows:
            raise ValueError(f"{name} has {len(getattr(table, name))} rows: must have {rows}")


def _require_rising(name: str, values: Vector) -> None:
    if len(values) < 2 or (np.diff(values) <= 0.0).any():
        raise ValueError(f"{name} = {values.tolist()}: must be 2 or more increasing values")
