"""A calibration from a run of analysis (iii) made before, with fewer pressures than the identification asks for.

``scripts/finger_table.py`` keeps such runs. Angles and volume are smooth in the pressure, so cubic splines through six
pressures meet the finger that was solved at sixteen within 0.07 degrees at the tip while loading and 0.14 on the way
back (set3 / set3, calibration mesh).
"""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from fea.actuator import ActuatorResult
from fea.arrays import F64
from fea.artifact import artifact
from fea.calibration import FINGER_PRESSURES_PA_GAUGE, UNLOAD_TO_PA_GAUGE, Calibration, Materials
from fea.checkpoint import content_hash
from fea.density import Density
from fea.exoskeleton import ExoskeletonResult
from fea.finger import CONTACT, MESHES, FingerResult
from fea.geometry import FingerGeometry
from fea.identification import reduce_finger
from fea.newton import Status

LEAST_PRESSURES = 6


def matches(run: Mapping[str, Any], geometry: FingerGeometry, materials: Materials, density: Density) -> bool:
    """Return whether a run is of this finger: dimensions, shipped materials, mesh, friction; loaded and unloaded."""
    case = run["case"]
    return (
        run.get("status") == Status.CONVERGED.value
        and case["geometry"] == geometry.as_dict()
        and (case["mesh"], case["mesh_cells"]) == (density.name, asdict(MESHES[density.name]))
        and (case["formulation"], case["volumetric"], case["unload"]) == ("P2", None, True)
        and case["friction"] == CONTACT.friction
        and materials.silicone.name == "Ecoflex 00-50"
        and materials.tpu.name == "NinjaFlex TPU"
        and case["silicone_set"] == materials.silicone.parameter_set
        and case["tpu_set"] == materials.tpu.parameter_set
    )


def finger_from_run(run: Mapping[str, Any]) -> FingerResult:
    """Return the states of a run at the pressures that the identification works with.

    Raises
    ------
    ValueError
        If the run has fewer than six pressures on its way up, or does not reach the first and last of those needed.
    """
    pressure = np.array(run["pressure_pa_gauge"])
    top = int(np.argmax(pressure))
    wanted = np.array(FINGER_PRESSURES_PA_GAUGE)
    if top < LEAST_PRESSURES or pressure[top] < wanted[-1] or pressure[-1] > UNLOAD_TO_PA_GAUGE:
        raise ValueError(
            f"pressure_pa_gauge = {pressure.tolist()}: must rise in {LEAST_PRESSURES} steps or more to "
            f"{wanted[-1]:g} Pa and fall to {UNLOAD_TO_PA_GAUGE:g} Pa"
        )
    back = wanted[(wanted >= UNLOAD_TO_PA_GAUGE) & (wanted < pressure[top])][::-1]
    up = slice(0, top + 1)

    def at(name: str) -> F64:
        values = np.array(run[name])
        down = CubicSpline(pressure[top:][::-1], values[top:][::-1])
        return np.concatenate([values[:1], CubicSpline(pressure[up], values[up])(wanted), down(back)])

    count = 1 + len(wanted) + len(back)
    joint, nothing = at("joint_rotation_rad"), np.zeros(count)
    return FingerResult(
        branch=("loading",) * (1 + len(wanted)) + ("unloading",) * len(back),
        pressure_pa_gauge=np.concatenate([[0.0], wanted, back]),
        tip_load_n=nothing,
        tip_angle_rad=joint.sum(axis=1),
        joint_angle_rad=joint,
        tip_displacement_m=at("tip_displacement_m"),
        volume_m3=at("volume_m3"),
        minimum_gap_m=nothing,
        contact_force_n=at("contact_force_n"),
        contact_pressure_pa=nothing,
        slip_m=nothing,
        tip_force_n=nothing,
        u_m=np.zeros((0, 3)),
        status=Status.CONVERGED,
        iterations=int(run["newton_iterations"]),
        dofs=int(run["dofs"]),
        elements=0,
    )


def artifact_from_run(
    run: Mapping[str, Any],
    geometry: FingerGeometry,
    materials: Materials,
    density: Density,
    actuator: tuple[ActuatorResult, float],
    exoskeleton: tuple[ExoskeletonResult, float],
) -> dict[str, Any]:
    """Return the calibration of a run and of analyses (i) and (ii), each with its mass [kg].

    Raises
    ------
    ValueError
        If the run is not of this finger, or as :func:`finger_from_run` and :func:`fea.identification.reduce_finger`.
    """
    if not matches(run, geometry, materials, density):
        raise ValueError("case: the run is not of this finger, mesh and friction, loaded and unloaded")
    finger = finger_from_run(run)
    calibration = Calibration(
        geometry=geometry,
        materials=materials,
        density=density,
        actuator=actuator[0],
        exoskeleton=exoskeleton[0],
        finger=finger,
        fit=reduce_finger(actuator[0], exoskeleton[0], finger),
        mass_kg=actuator[1] + exoskeleton[1],
    )
    made = {key: value for key, value in artifact(calibration).items() if key != "content_sha256"}
    made["provenance"]["finger_run"] = {
        "text": "analysis (iii) at the pressures below, the others by cubic splines in the pressure",
        "pressure_pa_gauge": list(run["pressure_pa_gauge"]),
        "code_sha256": run["code_sha256"],
    }
    return made | {"content_sha256": content_hash(made)}
