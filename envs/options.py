"""Options of ``reset``: each fixes one quantity of an episode and leaves the others as the seed has them."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from envs.draw import Draw
from envs.errors import BadOptionError
from softhand_sim.checks import require_finite, require_in
from softhand_sim.elements import FINGERS
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice

NEED_GAS = ("leak", "valve_flow_ratio", "sensor_offset_pa")


def _number(name: str, value: Any, low: float, high: float) -> float:
    return require_in(name, value.item() if isinstance(value, np.generic) else value, low, high)


def _pair(name: str, value: Any) -> tuple[float, float]:
    try:
        x, y = (float(v) for v in value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r}: must be two numbers x, y") from None
    return require_in(name, x, -0.2, 0.2), require_in(name, y, -0.2, 0.2)


def _leak(name: str, value: Any) -> Leak | None:
    if value is None or isinstance(value, Leak):
        return value
    keys = {"finger", "sonic_conductance_m3_per_s_pa"}
    if not isinstance(value, Mapping) or set(value) != keys or value["finger"] not in FINGERS:
        raise ValueError(f"{name} = {value!r}: must be None or a table of {sorted(keys)}, a finger of {list(FINGERS)}")
    size = require_in(name, value["sonic_conductance_m3_per_s_pa"], 1e-14, 1e-9)
    return Leak(finger=value["finger"], orifice=Orifice(sonic_conductance_m3_per_s_pa=size))


_READERS: Mapping[str, Callable[[str, Any], Any]] = {
    "object_offset_m": _pair,
    "object_yaw_rad": lambda name, v: _number(name, v, -np.pi, np.pi),
    "mass_kg": lambda name, v: require_finite(name, float(v), above=0.0),
    "friction": lambda name, v: _number(name, v, 0.0, 10.0),
    "leak": _leak,
    "valve_flow_ratio": lambda name, v: _number(name, v, 0.01, 100.0),
    "sensor_offset_pa": lambda name, v: _number(name, v, -10e3, 10e3),
}

OPTIONS = ("object", "calibration", *_READERS)
"""Options that every task has."""


def fixed(
    draw: Draw, options: Mapping[str, Any], *, objects: tuple[str, ...], calibrations: int, has_gas: bool
) -> Draw:
    """Return a draw with what the options fix; options that are not in `OPTIONS` are a task's own.

    Parameters
    ----------
    draw
        As drawn.
    options
        Values by name.
    objects, calibrations
        Names of the objects, and number of the calibrations, that the environment has.
    has_gas
        Whether valves, sensors and leaks exist.

    Raises
    ------
    BadOptionError
        If a value is not allowed; names the option, the value and what is allowed.
    """
    changes: dict[str, Any] = {}
    for name in (name for name in OPTIONS if name in options):
        value = options[name]
        try:
            if name == "object":
                changes[name] = _index_of(name, value, objects)
            elif name == "calibration":
                changes[name] = _index_of(name, value, tuple(range(calibrations)))
            else:
                changes[name] = _READERS[name](name, value)
            if name in NEED_GAS and not has_gas and changes[name] is not None:
                raise ValueError(f"{name} = {value!r}: means nothing without gas dynamics")
        except (TypeError, ValueError) as error:
            raise BadOptionError(f"options: {error}") from None
    return replace(draw, **changes)


def _index_of(name: str, value: Any, allowed: tuple[Any, ...]) -> int:
    if isinstance(value, bool) or value not in allowed:
        raise ValueError(f"{name} = {value!r}: must be one of {list(allowed)}")
    return allowed.index(value)
