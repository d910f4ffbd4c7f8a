"""Trials as an Apache Parquet file: a row a trial, typed columns in SI units, the run's conditions as its metadata."""

import json
import os
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from softhand_sim.benchmark.report import trial_rows
from softhand_sim.elements import ELEMENTS, FINGERS
from softhand_sim.grasp.result import TrialResult

_NUMBERS = (
    "mass_kg", "friction", "lift_m", "slip_m", "tilt_rad", "worst_slip_m", "worst_tilt_rad", "creep_m_per_s",
    "penetration_m", "hold_penetration_m", "finger_contact_s", "finger_penetration_m", "object_offset_yaw_rad",
    "simulated_s", "wall_s",
)  # fmt: skip


def require_pyarrow() -> Any:
    """Return pyarrow.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    if find_spec("pyarrow") is None:
        raise ValueError("Parquet: pyarrow is missing (pip install 'softhand-sim[parquet]')")
    import pyarrow  # noqa: PLC0415 - optional dependency

    return pyarrow


def write_parquet(path: Path, results: Sequence[TrialResult], conditions: Mapping[str, Any]) -> None:
    """Write trials in one piece.

    Columns are the fields of `TrialResult`: forces and peak pressures are structs, engine warnings and what went beyond
    the calibration are maps, the object's offset is ``object_offset_x_m`` and ``object_offset_y_m``. The conditions are
    in the metadata, as JSON under ``softhand_sim_conditions``.

    Raises
    ------
    ValueError
        If pyarrow is not installed.
    """
    arrow = require_pyarrow()
    import pyarrow.parquet  # noqa: PLC0415 - optional dependency

    schema = _schema(arrow).with_metadata({"softhand_sim_conditions": json.dumps(dict(conditions), sort_keys=True)})
    table = arrow.Table.from_pylist([_row(row) for row in trial_rows(results)], schema=schema)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    pyarrow.parquet.write_table(table, partial)
    partial.replace(path)


def _schema(arrow: Any) -> Any:
    text, whole, number = arrow.string(), arrow.int64(), arrow.float64()
    return arrow.schema(
        {
            **{name: text for name in ("object", "protocol", "outcome", "alarm", "replay")},
            **{name: whole for name in ("seed", "phases_run", "contacts")},
            **{name: number for name in (*_NUMBERS, "object_offset_x_m", "object_offset_y_m")},
            "links": arrow.list_(text),
            "caveats": arrow.list_(text),
            "force_n": arrow.struct([(name, number) for name in (*FINGERS, "palm")]),
            "peak_pressure_pa_gauge": arrow.struct([(name, number) for name in ELEMENTS]),
            "engine_warnings": arrow.map_(text, whole),
            "beyond_calibration": arrow.map_(text, number),
        }
    )


def _row(row: dict[str, Any]) -> dict[str, Any]:
    x, y = row.pop("object_offset_m")
    maps = {name: list(row[name].items()) for name in ("engine_warnings", "beyond_calibration")}
    return {**row, **maps, "object_offset_x_m": x, "object_offset_y_m": y}
