"""The pads' indentation curves as a file that the runtime takes its soft pads from."""

from collections.abc import Mapping
from typing import Any

from fea.calibration import Materials
from fea.checkpoint import code_version
from fea.geometry import FingerGeometry
from fea.linear_solver import solver_name
from fea.pad import PITCHES, SPHERE_RADIUS_M, PadMesh, PadResult

PAD_SCHEMA, PAD_SCHEMA_VERSION = "softhand-sim/finger-pad-evidence", 1


def pad_evidence(
    geometry: FingerGeometry, materials: Materials, mesh: PadMesh, results: Mapping[str, PadResult]
) -> dict[str, Any]:
    """Return the file's contents from the results of the sections; deterministic, SI units, JSON ready."""
    parts = (materials.silicone, materials.tpu, materials.pet)
    return {
        "schema": PAD_SCHEMA,
        "schema_version": PAD_SCHEMA_VERSION,
        "geometry": geometry.as_dict(),
        "sphere_radius_m": SPHERE_RADIUS_M,
        "sections": [
            {"section": name, "depth_m": result.depth_m.tolist(), "force_n": result.force_n.tolist()}
            for name, result in results.items()
        ],
        "provenance": {
            "materials": {
                m.name: {"name": m.name, "set": m.parameter_set, "parameters": dict(m.parameters)} for m in parts
            },
            "mesh": {name: getattr(mesh, name) for name in mesh.__dataclass_fields__},
            "actuator_pitches": PITCHES,
            "linear_solver": solver_name(),
            "code_sha256": code_version(),
            "solves": {name: {"dofs": r.dofs, "newton_iterations": r.iterations} for name, r in results.items()},
        },
    }
