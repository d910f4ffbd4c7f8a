"""Making an ensemble of calibrations: every member solved through the store, then put together with a manifest."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fea.calibration import run_actuator, run_exoskeleton
from fea.checkpoint import code_version
from fea.density import DENSITIES, Density
from fea.ensemble import MESH_ANGLE_DEG, EnsembleMember, EnsembleSource, ensemble_sources, member_density, mesh_place
from fea.finger_design import FingerDesign
from fea.from_table import artifact_from_run, matches
from fea.transfer import transferred
from scripts import _cli, _solving
from softhand_sim.uncertainty.ensemble import MANIFEST, SCHEMA, SCHEMA_VERSION

SOLVED = "solved"
"""Folder, in that of the ensemble, of what the analyses gave."""
NOMINAL = "nominal-coarse"
Artifact = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class Job:
    """Where the members of an ensemble come from and go to."""

    base: FingerDesign
    density: Density
    folder: Path
    solve: _solving.Solver
    runs: Sequence[Mapping[str, Any]] = ()

    def solved_file(self, name: str) -> Path:
        """Return the file of what the analyses gave for a member."""
        return self.folder / SOLVED / f"{name}.json"


def solve_members(job: Job, only: Sequence[str] = (), say: Callable[[str], None] = print) -> None:
    """Solve the nominal finger on the coarse mesh and every member; each is kept as it is done, refusals too.

    Raises
    ------
    ValueError
        If ``only`` names no member, or the nominal finger is refused.
    """
    sources = ensemble_sources(job.base)
    names = [NOMINAL, *(member.name for source in sources for member in source.members)]
    unknown = [name for name in only if name not in names]
    if unknown:
        raise ValueError(f"--only {unknown[0]}: no such member; known: {', '.join(names)}")
    parts = _Parts(job.density)
    if not only or NOMINAL in only:
        made, _ = job.solve(job.base, DENSITIES["coarse"], label=NOMINAL)
        _cli.write_json(job.solved_file(NOMINAL), dict(made.artifact))
    for source in sources:
        for member in source.members:
            if member.design is not None and (not only or member.name in only):
                _cli.write_json(job.solved_file(member.name), _outcome(job, member, member.design, parts))
                say(f"{member.name}: {job.solved_file(member.name)}")


def assemble(job: Job, nominal_file: Path) -> Path:
    """Write the calibrations of solved members, and the manifest, about a nominal finger; return the manifest.

    Members on another mesh than the nominal finger's are carried over (:mod:`fea.transfer`).

    Raises
    ------
    ValueError
        If the nominal finger's file is not of ``job.base``, nothing was solved, or the runtime refuses a member.
    """
    nominal = _read(nominal_file)
    if nominal["geometry"] != job.base.geometry.as_dict():
        raise ValueError(f"{nominal_file}: geometry is not that of the finger whose members are put together")
    coarse = _read(job.solved_file(NOMINAL))
    rows = [_source_row(job, source, coarse, nominal) for source in ensemble_sources(job.base)]
    if nominal["provenance"]["density"] == "calibration":
        rows.append(_mesh_row())
    manifest = job.folder / MANIFEST
    contents = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "nominal_sha256": nominal["content_sha256"],
        "sources": [row for row in rows if row["members"]],
        "provenance": {"code_sha256": code_version(), "mesh_tip_angle_deg_at_75_kpa": MESH_ANGLE_DEG},
    }
    _cli.write_json(manifest, contents)
    return manifest


class _Parts:
    """Analyses (i) and (ii) of materials, each run once; mutable, it remembers them."""

    def __init__(self, density: Density) -> None:
        self._density = density
        self._known: dict[tuple[str, str], Any] = {}

    def of(self, design: FingerDesign) -> tuple[Any, Any]:
        """Return actuator and exoskeleton, each with its mass."""
        found = []
        for role, run in (("silicone", run_actuator), ("tpu", run_exoskeleton)):
            key = (role, getattr(design.materials, role).parameter_set)
            if key not in self._known:
                self._known[key] = run(design.geometry, design.materials, self._density)
            found.append(self._known[key])
        return found[0], found[1]


def _outcome(job: Job, member: EnsembleMember, design: FingerDesign, parts: _Parts) -> dict[str, Any]:
    """Return a member's calibration, or why it has none."""
    run = next((r for r in job.runs if matches(r, design.geometry, design.materials, job.density)), None)
    try:
        if run is not None:
            made = artifact_from_run(run, design.geometry, design.materials, job.density, *parts.of(design))
        else:
            density = member_density(job.density, job.base, design)
            made = dict(job.solve(design, density, label=member.name)[0].artifact)
        _solving.checked(made)
    except ValueError as error:
        return {"refused": str(error)}
    return made


def _source_row(job: Job, source: EnsembleSource, coarse: Artifact, nominal: Artifact) -> dict[str, Any]:
    members = [_member_row(job, member, coarse, nominal) for member in source.members]
    return {
        "name": source.name,
        "kind": source.kind,
        "text": source.text,
        "members": [row for row in members if row is not None],
    }


def _member_row(job: Job, member: EnsembleMember, coarse: Artifact, nominal: Artifact) -> dict[str, Any] | None:
    """Return a member's row of the manifest, None where it was not solved yet; writes its calibration."""
    row: dict[str, Any] = {"name": member.name, "at": member.at}
    if member.refused is not None:
        return row | {"refused": member.refused}
    file = job.solved_file(member.name)
    if not file.is_file():
        return None
    solved = _read(file)
    if "refused" in solved:
        return row | {"refused": solved["refused"]}
    if solved["provenance"]["density"] == nominal["provenance"]["density"]:
        return row | {"file": f"{SOLVED}/{file.name}"}
    try:
        made = transferred(solved, coarse, nominal)
        _solving.checked(made)
    except ValueError as error:
        return row | {"refused": f"carried over to the nominal finger's mesh: {error}"}
    _cli.write_json(job.folder / file.name, made)
    return row | {"file": file.name}


def _mesh_row() -> dict[str, Any]:
    angle = MESH_ANGLE_DEG
    text = (
        f"calibration mesh against reference: {angle['calibration']:g} and {angle['reference']:g} degrees at 75 kPa; "
        "in the direction from the coarse mesh to the calibration mesh, as far either way"
    )
    member = {"name": "mesh-coarse", "at": mesh_place(), "file": f"{SOLVED}/{NOMINAL}.json"}
    return {"name": "mesh", "kind": "tolerance", "text": text, "members": [member]}


def _read(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise ValueError(f"{file}: not there; solve it first (uncertainty.py solve)")
    try:
        content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{file}: not a JSON file: {error}") from None
    return content
