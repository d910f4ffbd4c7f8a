"""Evidence of what the finger's own weight does: the complete finger under gravity in attitudes of the hand.

Each attitude is one loading run of analysis (iii) with the weight as a dead force in the plane of symmetry. The finger
without weight, at the same pressures, is in the calibration file (``fea.finger``).
"""

from typing import Any

from fea.evidence import Run
from fea.study import FingerCase

WEIGHT_SCHEMA, WEIGHT_SCHEMA_VERSION = "softhand-sim/finger-weight-evidence", 1
ACROSS_M_PER_S2, ALONG_M_PER_S2 = 2.556, 9.471
"""Gravity across and along a long finger of a palm that looks down: 9.81 m/s2, 15.1 degrees off the finger's axis, as
the hand's mounts have it (their ``elevation_deg`` is 74.9)."""
PRESSURES_PA_GAUGE = tuple(1e3 * p for p in (15, 30, 45, 60, 75))


def _run(towards_palm_side: float, towards_tip: float) -> Run:
    case = FingerCase(unload=False, gravity_m_per_s2=(towards_palm_side, towards_tip))
    return Run(case=case, pressures_pa_gauge=PRESSURES_PA_GAUGE)


WEIGHT_RUNS = {
    "palm down": _run(ACROSS_M_PER_S2, ALONG_M_PER_S2),
    "palm up": _run(-ACROSS_M_PER_S2, -ALONG_M_PER_S2),
}
"""A long finger in two attitudes of the hand; on its side it bends in a level plane, where the weight has no part."""


def weight_evidence(runs: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Return the file's contents from the figures of all runs; deterministic, SI units, JSON ready."""
    first = runs["palm down"]["provenance"]
    kept = ("linear_solver", "element_kernels", "code_sha256", "finger")
    cost = ("dofs", "elements", "newton_iterations", "wall_s", "status")
    return {
        "schema": WEIGHT_SCHEMA,
        "schema_version": WEIGHT_SCHEMA_VERSION,
        "geometry": first["geometry"],
        "attitudes": [
            {
                "name": name,
                "gravity_m_per_s2": figures["provenance"]["finger"]["gravity_m_per_s2"],
                "pressure_pa_gauge": figures["pressure_pa_gauge"],
                "joint_angle_rad": figures["joint_rotation_rad"],
            }
            for name, figures in runs.items()
        ],
        "provenance": {
            "materials": first["materials"],
            "density": first["density"],
            "runs": {
                name: {key: figures["provenance"][key] for key in kept} | {key: figures[key] for key in cost}
                for name, figures in runs.items()
            },
        },
    }
