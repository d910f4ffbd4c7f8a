"""Parameters as plain values and back: frozen dataclasses of this package, arrays, numbers. No code runs on reading.

Only the kinds named here are made; each checks its own values. Numbers come back bit for bit.
"""

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from softhand_sim.calibration.parts import (
    CalibrationCurve,
    ChamberCalibration,
    FingerBody,
    FingerCycle,
    JointCalibration,
    SlidingCalibration,
    TendonCalibration,
)
from softhand_sim.calibration.reader import FingerCalibration
from softhand_sim.control.onoff import OnOffController
from softhand_sim.guards.limits import Guards
from softhand_sim.hand.anatomy import FingerMount, HandAnatomy
from softhand_sim.losses import Losses
from softhand_sim.pneumatics.chamber import Chamber
from softhand_sim.pneumatics.delay import ValveDelay
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.sensor import PressureSensor
from softhand_sim.pneumatics.supply import Supply
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.pneumatics.tube import Tubing
from softhand_sim.relaxation import Relaxation
from softhand_sim.relief import ProximalRelief, Relief
from softhand_sim.sliding import SlidingFriction

_KINDS: Mapping[str, type[Any]] = {
    kind.__name__: kind
    for kind in (
        CalibrationCurve, Chamber, ChamberCalibration, Element, FingerBody, FingerCalibration, FingerCycle, FingerMount,
        Guards, HandAnatomy, JointCalibration, Leak, Losses, OnOffController, Orifice, PneumaticSystem, Polytropic,
        PressureSensor, ProximalRelief, Relaxation, Relief, SlidingCalibration, SlidingFriction, Supply,
        TendonCalibration, Tubing, ValveDelay,
    )
}  # fmt: skip


class NotPlainError(ValueError):
    """A value has no plain form: a controller or a phase of one's own, for instance."""


def to_plain(value: Any) -> Any:
    """Return a value as numbers, texts, lists and mappings that JSON can hold.

    Raises
    ------
    NotPlainError
        If it is of a kind that is not known here.
    """
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"kind": "float", "text": repr(float(value))}
    if isinstance(value, np.ndarray):
        return {"kind": "array", "dtype": value.dtype.str, "shape": list(value.shape), "values": value.ravel().tolist()}
    if isinstance(value, tuple | list):
        return {"kind": "tuple", "values": [to_plain(item) for item in value]}
    if isinstance(value, Mapping):
        return {"kind": "mapping", "values": {str(key): to_plain(item) for key, item in value.items()}}
    name = type(value).__name__
    if is_dataclass(value) and _KINDS.get(name) is type(value):
        return {"kind": name, "values": {f.name: to_plain(getattr(value, f.name)) for f in fields(value) if f.init}}
    raise NotPlainError(f"{name} has no plain form")


def from_plain(data: Any) -> Any:
    """Return the value of which `to_plain` made ``data``.

    Raises
    ------
    ValueError
        If it is none, or the value refuses its fields.
    """
    if not isinstance(data, dict):
        return data
    kind, values = data.get("kind"), data.get("values")
    if kind == "float":
        return float(data["text"])
    if kind == "array":
        dtype = np.dtype(str(data["dtype"]))
        if dtype.kind not in "fiub":
            raise ValueError(f"dtype = {data['dtype']!r}: must be one of numbers")
        return np.array(values, dtype=dtype).reshape([int(n) for n in data["shape"]])
    if kind == "tuple" and isinstance(values, list):
        return tuple(from_plain(item) for item in values)
    if isinstance(values, dict):
        inside = {str(key): from_plain(item) for key, item in values.items()}
        if kind == "mapping":
            return inside
        if kind in _KINDS:
            try:
                return _KINDS[str(kind)](**inside)
            except TypeError as error:
                raise ValueError(f"{kind}: {error}") from None
    raise ValueError(f"kind = {kind!r}: must be one of float, array, tuple, mapping, {', '.join(sorted(_KINDS))}")
