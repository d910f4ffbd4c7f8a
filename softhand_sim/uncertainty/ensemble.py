"""Reader of an ensemble: calibrations of fingers that differ from the nominal one in one thing each."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from assets import asset_path
from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.calibration.fields import Fields, read_fields
from softhand_sim.checks import require_finite

SCHEMA, SCHEMA_VERSION = "softhand-sim/calibration-ensemble", 1
MANIFEST = "ensemble.json"
TOLERANCE, SCENARIOS = "tolerance", "scenarios"


@dataclass(frozen=True, kw_only=True, eq=False)
class Member:
    """A finger of an ensemble.

    Attributes
    ----------
    name
        What it is called in tables.
    at
        Its place on its source's axis: 0 is the nominal finger, 1 and -1 the ends of the tolerance; None in scenarios.
    calibration, content
        The finger, and the contents of its file; None where the analyses gave none.
    refused
        Why there is no calibration; empty otherwise.
    """

    name: str
    at: float | None
    calibration: FingerCalibration | None
    content: Mapping[str, Any] | None
    refused: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Source:
    """A reason why a finger may differ: ``tolerance``, an interval about the nominal finger, or ``scenarios``."""

    name: str
    kind: str
    text: str
    members: tuple[Member, ...]

    @property
    def solved(self) -> tuple[Member, ...]:
        """Members that have a calibration."""
        return tuple(member for member in self.members if member.calibration is not None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble:
    """The nominal finger and the sources of its uncertainty."""

    nominal: Member
    sources: tuple[Source, ...]
    provenance: Mapping[str, Any]

    def of_kind(self, kind: str) -> tuple[Source, ...]:
        """Return the sources of a kind that have a solved member."""
        return tuple(source for source in self.sources if source.kind == kind and source.solved)

    def members(self) -> Iterator[tuple[Source, Member]]:
        """Yield every member with its source."""
        for source in self.sources:
            for member in source.members:
                yield source, member


def load_ensemble(folder: Path | None = None, calibration: Path | None = None) -> Ensemble:
    """Read and check an ensemble.

    Parameters
    ----------
    folder
        Has ``ensemble.json`` and the calibration files that it names; the shipped ``assets/calibration/ensemble`` by
        default.
    calibration
        The nominal finger; the shipped one by default.

    Raises
    ------
    FileNotFoundError
        If the manifest, or a file that it names, does not exist.
    ValueError
        If the manifest or a calibration is wrong, or the ensemble belongs to another nominal finger; the one-line
        message names file, field, value and what is allowed.
    """
    place = asset_path("calibration", "ensemble") if folder is None else folder
    path = asset_path("calibration", "finger.json") if calibration is None else calibration
    root = read_fields(place / MANIFEST)
    root.require_equal("schema", SCHEMA)
    root.require_equal("schema_version", SCHEMA_VERSION)
    nominal = _loaded(path, name="nominal", at=0.0)
    assert nominal.content is not None
    wanted, found = root.text("nominal_sha256"), nominal.content.get("content_sha256")
    if wanted != found:
        allowed = f"{found!r}, that of {path.name}: the ensemble is of another finger (uncertainty.py assemble)"
        raise root.error("nominal_sha256", wanted, allowed)
    rows = root.value("sources")
    if not isinstance(rows, list) or not rows:
        raise root.error("sources", rows, "a list of one source or more")
    sources = tuple(_source(fields, place) for fields in root.objects("sources", len(rows)))
    for what, names in (
        ("sources", [source.name for source in sources]),
        ("members", [member.name for source in sources for member in source.members]),
    ):
        if len(set(names)) < len(names):
            raise root.error(f"{what}.name", sorted(names), "different names")
    return Ensemble(nominal=nominal, sources=sources, provenance=MappingProxyType(root.object("provenance").raw))


def _source(fields: Fields, place: Path) -> Source:
    kind = fields.text("kind")
    if kind not in (TOLERANCE, SCENARIOS):
        raise fields.error("kind", kind, f"{TOLERANCE!r} or {SCENARIOS!r}")
    rows = fields.value("members")
    if not isinstance(rows, list) or not rows:
        raise fields.error("members", rows, "a list of one member or more")
    members = tuple(_member(row, place, kind) for row in fields.objects("members", len(rows)))
    if kind == TOLERANCE:
        sides = [member.at > 0.0 for member in members if member.at is not None]
        if len(set(sides)) < len(sides):
            raise fields.error("members", [m.at for m in members], "one member on either side of 0 at most")
    return Source(name=fields.text("name"), kind=kind, text=fields.text("text"), members=members)


def _member(fields: Fields, place: Path, kind: str) -> Member:
    name, at = fields.text("name"), fields.value("at")
    if kind == SCENARIOS and at is not None:
        raise fields.error("at", at, "null in scenarios")
    if kind == TOLERANCE:
        with fields.naming_file():
            at = require_finite(f"{fields.place}at", at)
        if abs(at) < 1.0:
            raise fields.error("at", at, "1 or above, or -1 or below")
    if "refused" in fields.raw:
        return Member(name=name, at=at, calibration=None, content=None, refused=fields.text("refused"))
    file = fields.text("file")
    if Path(file).is_absolute() or ".." in Path(file).parts:
        raise fields.error("file", file, "a path in the ensemble's folder")
    return _loaded(place / file, name=name, at=at)


def _loaded(path: Path, *, name: str, at: float | None) -> Member:
    calibration = load_calibration(path)
    content = json.loads(path.read_text(encoding="utf-8"))
    return Member(name=name, at=at, calibration=calibration, content=MappingProxyType(content))
