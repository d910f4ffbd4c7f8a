"""Sweeps: the benchmark over values of one or two of its conditions, for success curves and surfaces."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Any

from assets import asset_path
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.report import summarise, trial_rows
from softhand_sim.calibration import load_calibration
from softhand_sim.checks import require_in
from softhand_sim.effects import Effects
from softhand_sim.elements import FINGERS
from softhand_sim.grasp.result import TrialResult
from softhand_sim.objects.model import ObjectModel
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice

MOST_AXES = 2
SHIPPED = "shipped"
Change = Callable[[BenchmarkPlan, Any], BenchmarkPlan]


def _objects(plan: BenchmarkPlan, change: Callable[[ObjectModel], ObjectModel]) -> BenchmarkPlan:
    return replace(plan, objects=tuple(change(model) for model in plan.objects))


def _mass(plan: BenchmarkPlan, mass_kg: float) -> BenchmarkPlan:
    return _objects(plan, lambda model: model.with_overrides(mass_kg=mass_kg))


def _mass_scale(plan: BenchmarkPlan, factor: float) -> BenchmarkPlan:
    return _objects(plan, lambda model: model.with_overrides(mass_kg=factor * model.mass_kg))


def _friction(plan: BenchmarkPlan, friction: float) -> BenchmarkPlan:
    return _objects(plan, lambda model: model.with_overrides(friction=friction))


def _pressure(plan: BenchmarkPlan, pressure_pa_gauge: float) -> BenchmarkPlan:
    return replace(plan, protocol=replace(plan.protocol, closing_pressure_pa_gauge=pressure_pa_gauge))


def _offset(axis: int) -> Change:
    def change(plan: BenchmarkPlan, offset_m: float) -> BenchmarkPlan:
        offsets = plan.protocol.offsets
        moved = tuple((x + offset_m * (axis == 0), y + offset_m * (axis == 1)) for x, y in offsets.stated_m)
        return replace(plan, protocol=replace(plan.protocol, offsets=replace(offsets, stated_m=moved)))

    return change


def _calibration(plan: BenchmarkPlan, file: str) -> BenchmarkPlan:
    path = asset_path("calibration", "finger.json") if file == SHIPPED else Path(file)
    load_calibration(path)
    return replace(plan, calibration=path)


def _leak(finger: str) -> Change:
    def change(plan: BenchmarkPlan, conductance: float) -> BenchmarkPlan:
        require_in("leak", conductance, 0.0, 1e-8)
        others = tuple(leak for leak in plan.effects.leaks or () if leak.finger != finger)
        hole = (Leak(finger=finger, orifice=Orifice(sonic_conductance_m3_per_s_pa=conductance)),) if conductance else ()
        effects: Effects = replace(plan.effects, leaks=(*others, *hole) or None)
        return replace(plan, effects=effects)

    return change


AXES: Mapping[str, Change] = MappingProxyType(
    {
        "mass_kg": _mass,
        "mass_scale": _mass_scale,
        "friction": _friction,
        "pressure_pa_gauge": _pressure,
        "offset_x_m": _offset(0),
        "offset_y_m": _offset(1),
        "calibration": _calibration,
        **{f"leak_{finger}_m3_per_s_pa": _leak(finger) for finger in FINGERS},
    }
)
"""What may be varied. `mass_scale` is a factor of each object's own mass; offsets are added to the protocol's; a
calibration (of another material set or dimension, from `scripts/calibrate.py`) is a file or 'shipped'; a leak is the
sonic conductance of a hole in one finger, 0 for none."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A varied condition and its values, in order.

    Raises
    ------
    ValueError
        If there is no such condition, no value, or a value twice.
    """

    name: str
    values: tuple[float | str, ...]

    def __post_init__(self) -> None:
        if self.name not in AXES:
            raise ValueError(f"{self.name}: no such condition; allowed: {', '.join(AXES)}")
        if not self.values or len(set(self.values)) < len(self.values):
            raise ValueError(f"{self.name}: {self.values} must be one or more different values")


@dataclass(frozen=True, kw_only=True)
class SweepPoint:
    """One combination of values, by axis, and its benchmark."""

    values: dict[str, float | str]
    plan: BenchmarkPlan


def sweep_points(base: BenchmarkPlan, axes: Sequence[Axis]) -> tuple[SweepPoint, ...]:
    """Return every combination of the axes' values, the last axis fastest; all are checked here.

    Raises
    ------
    ValueError, FileNotFoundError
        If there is no axis, more than `MOST_AXES` or one twice, or a value is impossible.
    """
    names = [axis.name for axis in axes]
    if not 1 <= len(names) <= MOST_AXES or len(set(names)) < len(names):
        raise ValueError(f"{names}: must be 1 to {MOST_AXES} different conditions")
    return tuple(_points(base, axes, names))


def _points(base: BenchmarkPlan, axes: Sequence[Axis], names: Sequence[str]) -> Iterator[SweepPoint]:
    for combination in product(*(axis.values for axis in axes)):
        values = dict(zip(names, combination, strict=True))
        plan = base
        for name, value in values.items():
            try:
                plan = AXES[name](plan, value)
            except ValueError as error:
                raise ValueError(f"{name}={value}: {error}") from error
        yield SweepPoint(values=values, plan=plan)


def sweep_row(point: SweepPoint, results: Sequence[TrialResult]) -> dict[str, Any]:
    """Return the results of a point, JSON-ready: values, summary an object, every trial."""
    return {"values": point.values, "objects": summarise(results), "trials": trial_rows(results)}
