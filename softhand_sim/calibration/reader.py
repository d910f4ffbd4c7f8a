"""Reader of the finger calibration: the file through which the finite-element lab speaks to the runtime."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from assets import asset_path
from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.calibration.integrity import check_whole, read_geometry
from softhand_sim.calibration.parts import (
    JOINTS,
    CalibrationCurve,
    ChamberCalibration,
    FingerBody,
    FingerCycle,
    JointCalibration,
    SlidingCalibration,
    TendonCalibration,
)

SCHEMA = "softhand-sim/finger-calibration"
SCHEMA_VERSION = 3


@dataclass(frozen=True, kw_only=True, eq=False)
class FingerCalibration:
    """Everything the runtime knows of a finger.

    ``analysis`` is what the complete finger did in the finite elements; ``notes`` holds the parts of the file that the
    runtime doesn't compute with.
    """

    joints: tuple[JointCalibration, ...]
    tendon: TendonCalibration
    chamber: ChamberCalibration
    sliding: SlidingCalibration
    finger: FingerBody
    curve: CalibrationCurve
    analysis: FingerCycle
    geometry: Mapping[str, Any]
    notes: Mapping[str, Any]
    _twice_offset: npt.NDArray[np.float64] = field(init=False, repr=False)
    _four_slopes: npt.NDArray[np.float64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        names = tuple(joint.name for joint in self.joints)
        if names != JOINTS:
            raise ValueError(f"joints = {list(names)}: must be {list(JOINTS)}, in this order")
        offset = np.array([joint.offset_m for joint in self.joints])
        slope = np.array([joint.offset_slope_m_per_rad for joint in self.joints])
        object.__setattr__(self, "_twice_offset", 2.0 * offset)
        object.__setattr__(self, "_four_slopes", 4.0 * slope)
        proximal, middle, distal = np.radians(self.curve.joint_angle_deg).T.tolist()
        bent = [self.elongation_m(row) for row in zip(proximal, middle, distal, strict=True)]
        for elongation in (0.0, *bent):
            if not self.chamber.area_m2_at(elongation) > 0.0:
                area = self.chamber.area_m2_at(elongation)
                raise ValueError(
                    f"chamber.area_slope_m = {self.chamber.area_slope_m!r}: area must be > 0 on the curve, "
                    f"is {area:g} m2 at {elongation:g} m"
                )
            if self.tendon.slope_n_per_m_at(elongation) < 0.0:
                raise ValueError(
                    f"tendon.stiffness_n_per_m2 = {self.tendon.stiffness_n_per_m2!r}: must not fall on the "
                    f"curve: slope is {self.tendon.slope_n_per_m_at(elongation):g} N/m at {elongation:g} m"
                )

    def elongation_m(self, joint_angle_rad: tuple[float, float, float]) -> float:
        """Return the tendon's elongation [m] at the joint angles [rad], (3,)."""
        return math.fsum(joint.elongation_m_at(q) for joint, q in zip(self.joints, joint_angle_rad, strict=True))

    def elongations_m(self, joint_angle_rad: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the elongation [m] of fingers (n,) at their joint angles [rad], (n, 3)."""
        half = 0.5 * joint_angle_rad
        return np.asarray(np.sin(half) @ self._twice_offset + (1.0 - np.cos(half)) @ self._four_slopes)

    def pressure_for_angle(self, angle_deg: float) -> float:
        """Return the pressure [Pa gauge] at which the tip angle is ``angle_deg``, linear between points.

        Raises
        ------
        ValueError
            If the angle is outside the curve.
        """
        return _look_up("angle_deg", angle_deg, self.curve.tip_angle_deg, self.curve.pressure_pa_gauge)

    def closing_pressure(self, angle_deg: float) -> float:
        """Return the pressure [Pa gauge] for a tip angle, or the highest calibrated one if the finger bends less."""
        return self.pressure_for_angle(min(angle_deg, float(self.curve.tip_angle_deg[-1])))

    def angle_for_pressure(self, pressure_pa_gauge: float) -> float:
        """Return the tip angle [deg] on the curve at a pressure [Pa gauge], by linear interpolation.

        Raises
        ------
        ValueError
            If the pressure is outside the curve.
        """
        return _look_up("pressure_pa_gauge", pressure_pa_gauge, self.curve.pressure_pa_gauge, self.curve.tip_angle_deg)


def _look_up(name: str, x: float, xs: npt.NDArray[np.float64], ys: npt.NDArray[np.float64]) -> float:
    if not xs[0] <= x <= xs[-1]:
        raise ValueError(f"{name} = {x!r}: must be within the calibration's {xs[0]:g} to {xs[-1]:g}")
    return float(np.interp(x, xs, ys))


def load_calibration(path: Path | None = None) -> FingerCalibration:
    """Read and check a finger calibration.

    Parameters
    ----------
    path
        JSON file; the shipped ``assets/calibration/finger.json`` by default.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file isn't a calibration of this schema and version, a field is missing, unknown or outside its
        range, or the content isn't what was written; the one-line message names file, field, value and what is
        allowed.
    """
    root = read_fields(asset_path("calibration", "finger.json") if path is None else path)
    root.require_equal("schema", SCHEMA)
    root.require_equal("schema_version", SCHEMA_VERSION)
    joints = root.objects("joints", len(JOINTS))
    curve, analysis = root.object("curve"), root.object("fea").object("finger")
    finger = root.object("finger")
    known = {"schema", "schema_version", "joints", "tendon", "chamber", "sliding", "finger", "curve", "geometry"}
    for name in ("targets_used", "fit_rmse", "provenance"):
        root.object(name)
    with root.naming_file():
        calibration = FingerCalibration(
            joints=tuple(_build_joint(joint) for joint in joints),
            tendon=root.object("tendon").build_only(TendonCalibration),
            chamber=root.object("chamber").build_only(ChamberCalibration),
            sliding=root.object("sliding").build_only(SlidingCalibration),
            finger=_build_body(finger),
            curve=_build_curve(curve),
            analysis=build_cycle(analysis, fitted=analysis.list_of("fitted", bool)),
            geometry=MappingProxyType(read_geometry(root.object("geometry"))),
            notes=MappingProxyType({key: value for key, value in root.raw.items() if key not in known}),
        )
    check_whole(root)
    return calibration


def _build_joint(fields: Fields) -> JointCalibration:
    return fields.build_only(JointCalibration, name=fields.text("name"))


def _build_body(fields: Fields) -> FingerBody:
    positions = tuple(fields.numbers("joint_position_m", (3,)).tolist())
    return fields.build_only(FingerBody, joint_position_m=positions)


def build_cycle(fields: Fields, *, fitted: tuple[bool, ...] | None = None) -> FingerCycle:
    """Return a table of the complete finger from its fields."""
    return fields.build(
        FingerCycle,
        branch=fields.list_of("branch", str),
        pressure_pa_gauge=fields.numbers("pressure_pa_gauge", (None,)),
        joint_angle_rad=fields.numbers("joint_angle_rad", (None, 3)),
        chamber_volume_m3=fields.numbers("chamber_volume_m3", (None,)),
        fitted=fitted,
    )


def _build_curve(fields: Fields) -> CalibrationCurve:
    return fields.build_only(
        CalibrationCurve,
        pressure_pa_gauge=fields.numbers("pressure_pa_gauge", (None,)),
        tip_angle_deg=fields.numbers("tip_angle_deg", (None,)),
        joint_angle_deg=fields.numbers("joint_angle_deg", (None, 3)),
    )
