"""Grasps in TOML files: those that a search found, and a user's own."""

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from softhand_sim.checks import require_finite
from softhand_sim.grasp.plan import FIRM_ANGLE_DEG, GraspPlan
from softhand_sim.grasp.stage import unit_vector

_ANGLES = ("yaw_rad", "pitch_rad", "roll_rad")
_NEEDED = {"position_m", *_ANGLES, "retreat"}
_LENGTH = {"position_m": 3, "retreat": 3, "set_angle_deg": 3}
_FOUND = ("score", "closings", "shape_m")
_ALLOWED = sorted(_NEEDED | {"set_angle_deg", *_FOUND})
_TOP = ("grasp", "hand_sha256", "calibration_sha256", "command")


@dataclass(frozen=True, kw_only=True)
class KeptGrasp:
    """A grasp of a file.

    Attributes
    ----------
    plan: the grasp.
    score, closings: what a search said of it and spent on it, None for a user's own.
    shape_m: the shape it was searched for (`shape_m` of `softhand_sim.grasp.choice.shipped`); empty for a user's own.
    """

    plan: GraspPlan
    score: float | None = None
    closings: int | None = None
    shape_m: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class GraspFile:
    """Grasps by the names of their objects.

    Attributes
    ----------
    grasps: one an object.
    hand_sha256, calibration_sha256, command: layout and finger that they were searched with, and how; empty if unknown.
    """

    grasps: Mapping[str, KeptGrasp]
    hand_sha256: str = ""
    calibration_sha256: str = ""
    command: str = field(default="", compare=False)

    def joined(self, later: "GraspFile") -> "GraspFile":
        """Return these grasps with later ones, which take the place of those of the same objects.

        Raises
        ------
        ValueError
            If the later ones were searched with another hand or finger.
        """
        for name in ("hand_sha256", "calibration_sha256"):
            if getattr(self, name) != getattr(later, name):
                raise ValueError(
                    f"{name} = {getattr(later, name)!r}: must be that of the grasps there, {getattr(self, name)!r}"
                )
        grasps = {**self.grasps, **later.grasps}
        texts = (self.command, later.command) if later.command not in self.command else (self.command,)
        command = "; later ".join(text for text in texts if text)
        return replace(later, grasps=dict(sorted(grasps.items())), command=command)


def load_grasps(path: Path) -> GraspFile:
    """Read a file of grasps.

    A table ``[grasp.NAME]`` an object, for an object whose mass centre stands above the world's origin on the table
    z = 0: ``position_m`` of the palm's centre, ``yaw_rad``, ``pitch_rad``, ``roll_rad`` of the wrist, ``retreat`` the
    direction in which the hand backs off; ``set_angle_deg`` of thumb, index and middle-ring-little if they are not 95.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no file of grasps; the message names file, object, key, value and what is allowed.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no file of grasps at {path}")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        unknown = sorted(set(table) - set(_TOP))
        if unknown:
            raise ValueError(f"unknown keys {unknown}, allowed {list(_TOP)}")
        grasps = table.get("grasp")
        if not isinstance(grasps, dict) or not grasps:
            raise ValueError("no grasps: needs a table [grasp.NAME] for one object or more")
        texts = {name: table.get(name, "") for name in _TOP[1:]}
        for name, text in texts.items():
            if not isinstance(text, str):
                raise ValueError(f"{name} is {text!r}, needs a text")
        return GraspFile(grasps={name: _grasp(name, values) for name, values in grasps.items()}, **texts)
    except (ValueError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: {error}") from error


def write_grasps(path: Path, file: GraspFile) -> None:
    """Write a file of grasps in one piece, lengths to 0.01 mm, angles to 1e-5 rad."""
    lines = [f'{name} = "{getattr(file, name)}"' for name in _TOP[1:] if getattr(file, name)]
    for name, kept in file.grasps.items():
        pose = kept.plan.wrist_pose
        lines += ["", f'[grasp."{name}"]', f"position_m = {_row(pose[:3])}"]
        lines += [f"{key} = {value:.5f}" for key, value in zip(_ANGLES, pose[3:], strict=True)]
        lines += [f"retreat = {_row(kept.plan.retreat)}", f"set_angle_deg = {_row(kept.plan.set_angle_deg, 1)}"]
        if kept.score is not None and kept.closings is not None:
            lines += [f"score = {kept.score:.3f}", f"closings = {kept.closings}"]
        if kept.shape_m:
            lines.append(f"shape_m = {_row(kept.shape_m, 7)}")
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    partial.write_text("\n".join(lines) + "\n", encoding="utf-8")
    partial.replace(path)


def rounded(plan: GraspPlan) -> GraspPlan:
    """Return a grasp as it comes back from a file."""
    pose = tuple(float(f"{value:.5f}") for value in plan.wrist_pose)
    retreat = unit_vector(*(float(f"{value:.5f}") for value in plan.retreat))
    return GraspPlan(wrist_pose=pose, retreat=tuple(retreat.tolist()), set_angle_deg=plan.set_angle_deg)


def _row(values: Any, digits: int = 5) -> str:
    return "[" + ", ".join(f"{value:.{digits}f}" for value in values) + "]"


def _grasp(name: str, values: Any) -> KeptGrasp:
    where = f"grasp.{name}"
    if not isinstance(values, dict):
        raise ValueError(f"{where} is {values!r}, needs a table")
    unknown, missing = sorted(set(values) - set(_ALLOWED)), sorted(_NEEDED - set(values))
    if unknown or missing:
        raise ValueError(f"{where}: unknown keys {unknown}, missing keys {missing}; allowed {_ALLOWED}")
    for key, size in _LENGTH.items():
        row = values.get(key, [FIRM_ANGLE_DEG] * 3)
        if not isinstance(row, list) or len(row) != size:
            raise ValueError(f"{where}: {key} is {row!r}, needs {size} numbers")
    try:
        for key in (*_ANGLES, *(k for k in _FOUND[:2] if k in values)):
            require_finite(key, values[key])
        for key in ("position_m", "retreat", "set_angle_deg", "shape_m"):
            for value in values.get(key, []):
                require_finite(key, value)
        direction = unit_vector(*values["retreat"])
        plan = GraspPlan(
            wrist_pose=tuple(map(float, [*values["position_m"], *(values[key] for key in _ANGLES)])),
            retreat=tuple(direction.tolist()),
            set_angle_deg=tuple(map(float, values.get("set_angle_deg", [FIRM_ANGLE_DEG] * 3))),
        )
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error
    found = {key: values[key] for key in _FOUND[:2] if key in values}
    return KeptGrasp(plan=plan, shape_m=tuple(np.array(values.get("shape_m", []), dtype=float).tolist()), **found)
