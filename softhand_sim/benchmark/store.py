"""Finished trials in an SQLite file: each is written once, whole; a run that was killed goes on where it was.

One process writes (the workers send it their results). The journal is a write-ahead log, so others may read meanwhile.
"""

import hashlib
import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict, fields
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from assets import asset_path
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.model import ObjectModel
from softhand_sim.policy.policy_file import dump_policy

_TABLES = """
CREATE TABLE IF NOT EXISTS conditions (only_row INTEGER PRIMARY KEY CHECK (only_row = 1), text TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS objects (name TEXT PRIMARY KEY, digest TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS trials (
  object TEXT NOT NULL REFERENCES objects (name), seed INTEGER NOT NULL, result TEXT NOT NULL,
  PRIMARY KEY (object, seed)
);
"""


class TrialStore:
    """The trials of one set of conditions; a context manager.

    More objects and more trials may be added to a store; other conditions (protocol, engine, calibration, versions of
    engine and numerics) or another object or grasp of the same name are refused.

    Raises
    ------
    ValueError
        If the file is no store, is being written to by another run, or belongs to other conditions or objects.
    """

    def __init__(self, path: Path, plan: BenchmarkPlan) -> None:
        self._path = path
        try:
            # a lock that the system lifts when the process ends, however it ends
            self._lock = sqlite3.connect(f"{path}.lock", timeout=0.0, isolation_level=None)
            self._lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            raise ValueError(f"{path}: another run writes to it ({error})") from error
        try:
            self._base = sqlite3.connect(path, isolation_level=None)
            self._base.execute("PRAGMA journal_mode = WAL")
            self._base.executescript(_TABLES)
            self._agree(plan)
        except (sqlite3.DatabaseError, ValueError) as error:
            self.close()
            raise ValueError(f"{path}: {error}") from error

    def _agree(self, plan: BenchmarkPlan) -> None:
        """Note the plan's conditions and objects, or refuse those that differ from what is there."""
        new = json.dumps(conditions(plan), sort_keys=True)
        self._base.execute("INSERT OR IGNORE INTO conditions VALUES (1, ?)", (new,))
        (old,) = self._base.execute("SELECT text FROM conditions").fetchone()
        if old != new:
            before, after = json.loads(old), json.loads(new)
            differing = sorted(key for key in {**before, **after} if before.get(key) != after.get(key))
            raise ValueError(f"holds trials under other conditions ({', '.join(differing)}); take another file")
        for model in plan.objects:
            mark = digest(model, plan.grasp(model))
            self._base.execute("INSERT OR IGNORE INTO objects VALUES (?, ?)", (model.name, mark))
            (known,) = self._base.execute("SELECT digest FROM objects WHERE name = ?", (model.name,)).fetchone()
            if known != mark:
                raise ValueError(f"holds trials of another object or grasp called {model.name!r}; take another file")

    def add(self, result: TrialResult) -> None:
        """Write one finished trial, in one transaction.

        Raises
        ------
        sqlite3.IntegrityError
            If it is there already.
        """
        row = {**asdict(result), "outcome": result.outcome.value}
        self._base.execute(
            "INSERT INTO trials VALUES (?, ?, ?)", (result.object, result.seed, json.dumps(row, allow_nan=False))
        )

    def results(self) -> Iterator[TrialResult]:
        """Return the trials that are there."""
        for (text,) in self._base.execute("SELECT result FROM trials").fetchall():
            yield _result(json.loads(text))

    def close(self) -> None:
        """Close the file and let others write to it."""
        if hasattr(self, "_base"):
            self._base.close()
        self._lock.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def read_store(path: Path) -> tuple[dict[str, Any], list[TrialResult]]:
    """Return the conditions and the trials, by object and seed, of a store, which may be in use.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no store.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no store at {path}")
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as base:
            found = base.execute("SELECT text FROM conditions").fetchone()
            texts = base.execute("SELECT result FROM trials ORDER BY object, seed").fetchall()
    except sqlite3.DatabaseError as error:
        raise ValueError(f"{path}: not a store of trials ({error})") from error
    if found is None:
        raise ValueError(f"{path}: not a store of trials (it names no conditions)")
    return json.loads(found[0]), [_result(json.loads(text)) for (text,) in texts]


def conditions(plan: BenchmarkPlan) -> dict[str, Any]:
    """Return what, beside object and seed, decides a trial's result."""
    file = plan.calibration or asset_path("calibration", "finger.json")
    control = {} if plan.control is None else {"control_sha256": hashlib.sha256(plan.control.read_bytes()).hexdigest()}
    policy = {} if plan.policy is None else {"policy_sha256": hashlib.sha256(dump_policy(plan.policy)).hexdigest()}
    tolerance = {} if plan.tolerance is None else {"tolerance": asdict(plan.tolerance)}
    return {
        "protocol": repr(plan.protocol),
        "engine": asdict(plan.engine),
        "effects": repr(plan.effects),
        "calibration_sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
        **tolerance,
        **control,
        **policy,
        "mujoco_version": version("mujoco"),
        "numpy_version": version("numpy"),
        "softhand_sim_version": version("softhand-sim"),
    }


def digest(model: ObjectModel, grasp: GraspPlan) -> str:
    """Return the SHA-256 of everything about an object and its grasp that a trial depends on."""
    sha = hashlib.sha256(repr((model.name, model.mass_kg, model.friction, model.primitive, grasp)).encode())
    arrays = [model.inertia_kg_m2, np.asarray(model.mesh.vertices), np.asarray(model.mesh.faces)]
    for part in model.convex_parts:
        arrays += [np.asarray(part.vertices), np.asarray(part.faces)]
    for array in arrays:
        sha.update(repr(array.shape).encode())
        sha.update(np.ascontiguousarray(array).tobytes())
    return sha.hexdigest()


def _result(row: dict[str, Any]) -> TrialResult:
    values = {field.name: row[field.name] for field in fields(TrialResult)}
    values |= {"outcome": Outcome(row["outcome"]), "links": tuple(row["links"])}
    values |= {"caveats": tuple(row["caveats"])}
    return TrialResult(**{**values, "object_offset_m": tuple(row["object_offset_m"])})
