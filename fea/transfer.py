"""What a finger changes on a coarse mesh, carried over to the calibration of the nominal finger on a finer one.

Laws are carried over as ratios, of the torque at an angle or the tension at an elongation: nominal times member over
the nominal finger of the member's mesh. The member itself, on its own mesh, is a tenth too stiff; the ratio is much
nearer (docs/uncertainty.md has how near). A member whose path ended on its way up has no friction, on any mesh.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fea.checkpoint import content_hash
from fea.identification import USED_ANGLE_RAD, USED_LENGTHENING_M, fit_monotone
from fea.surrogate import Arm, Chamber, Cubic, Sliding, Surrogate

Artifact = Mapping[str, Any]
_POINTS = 40
_TORQUE = ("stiffness_n_m_per_rad", "stiffness_n_m_per_rad2", "stiffness_n_m_per_rad3")
_TENSION = ("stiffness_n_per_m", "stiffness_n_per_m2", "stiffness_n_per_m3")
_ARM = ("offset_m", "offset_slope_m_per_rad", "damping_n_m_s_per_rad")


def transferred(member: Artifact, reference: Artifact, nominal: Artifact) -> dict[str, Any]:
    """Return the calibration of ``member`` as it would be on the mesh of ``nominal``.

    Parameters
    ----------
    member, reference : mapping
        Calibrations on one mesh: of the finger, and of the nominal finger.
    nominal : mapping
        Calibration of the nominal finger on another mesh.

    Raises
    ------
    ValueError
        If member and reference are not of one mesh, reference and nominal not of one finger, one of them was not at a
        state that the member reached, or the result has no equilibrium at a pressure that the member reached.
    """
    if member["provenance"]["mesh"] != reference["provenance"]["mesh"]:
        raise ValueError("provenance.mesh: member and reference must be of one mesh")
    if reference["geometry"] != nominal["geometry"]:
        raise ValueError("geometry: reference and nominal must be of one finger")
    joints = [_joint(*rows) for rows in zip(member["joints"], reference["joints"], nominal["joints"], strict=True)]
    tendon = _law(_TENSION, member["tendon"], reference["tendon"], nominal["tendon"], USED_LENGTHENING_M)
    chamber = _ratios(member["chamber"], reference["chamber"], nominal["chamber"])
    sliding = _ratios(member["sliding"], reference["sliding"], nominal["sliding"])
    body = dict(member["finger"])
    for name in ("mass_kg", "hinge_offset_m"):
        body[name] *= nominal["finger"][name] / reference["finger"][name]
    states = _states(*(one["fea"]["finger"] for one in (member, reference, nominal)))
    pressures = list(member["curve"]["pressure_pa_gauge"])
    law = surrogate(joints, tendon, chamber, sliding)
    angle = np.rad2deg([law.angles(p) for p in pressures])
    made = {key: value for key, value in member.items() if key != "content_sha256"} | {
        "joints": joints,
        "tendon": tendon,
        "chamber": chamber,
        "sliding": sliding,
        "finger": body,
        "fea": {**member["fea"], "finger": states},
        "curve": {
            "pressure_pa_gauge": pressures,
            "tip_angle_deg": angle.sum(axis=1).tolist(),
            "joint_angle_deg": angle.tolist(),
        },
        "provenance": {
            **member["provenance"],
            "transferred": {
                "text": "laws, and the states of the complete finger (fea.finger), are those of the nominal finger on "
                "its mesh times member over nominal finger on this one, which fea.actuator and fea.exoskeleton are of",
                "to_density": nominal["provenance"]["density"],
                "nominal_sha256": nominal["content_sha256"],
            },
        },
    }
    return made | {"content_sha256": content_hash(made)}


def _states(member: Artifact, reference: Artifact, nominal: Artifact) -> dict[str, Any]:
    """Return the member's states of the complete finger: nominal times member over reference, each at its pressure."""
    asked = list(zip(member["branch"], member["pressure_pa_gauge"], strict=True))
    columns: dict[str, Any] = {name: member[name] for name in ("branch", "fitted", "pressure_pa_gauge", "status")}
    rows = []
    for table in (reference, nominal):
        place = {key: k for k, key in enumerate(zip(table["branch"], table["pressure_pa_gauge"], strict=True))}
        if missing := [key for key in asked if key not in place]:
            raise ValueError(f"fea.finger: the nominal finger was not at {missing[0][1]:g} Pa {missing[0][0]}")
        rows.append([place[key] for key in asked])
    for name in ("joint_angle_rad", "chamber_volume_m3"):
        own, coarse, fine = (
            np.array(table[name])[at]
            for table, at in ((member, range(len(asked))), (reference, rows[0]), (nominal, rows[1]))
        )
        ratio = np.divide(own, coarse, out=np.ones_like(own), where=coarse != 0.0)
        columns[name] = (ratio * fine).tolist()
    columns["tip_angle_rad"] = np.sum(columns["joint_angle_rad"], axis=1).tolist()
    return columns


def surrogate(joints: list[dict[str, Any]], tendon: Artifact, chamber: Artifact, sliding: Artifact) -> Surrogate:
    """Return the reduced finger that the parts of a calibration describe."""
    proximal, middle, distal = (_cubic(joint, _TORQUE) for joint in joints)
    arm = Arm(offset_m=joints[0]["offset_m"], offset_slope_m_per_rad=joints[0]["offset_slope_m_per_rad"])
    return Surrogate(
        arm=arm,
        joints=(proximal, middle, distal),
        tendon=_cubic(tendon, _TENSION),
        chamber=Chamber(**chamber),
        sliding=Sliding(**sliding),
    )


def _joint(member: Artifact, reference: Artifact, nominal: Artifact) -> dict[str, Any]:
    arm = {name: member[name] * nominal[name] / reference[name] for name in _ARM}
    return {"name": member["name"], **arm, **_law(_TORQUE, member, reference, nominal, USED_ANGLE_RAD)}


def _law(
    names: tuple[str, str, str], member: Artifact, reference: Artifact, nominal: Artifact, to: float
) -> dict[str, float]:
    """Return the monotone cubic nearest to nominal times member over reference, up to ``to``."""
    x = np.linspace(0.0, to, _POINTS + 1)[1:]
    values = [np.array([_cubic(one, names)(float(v)) for v in x]) for one in (member, reference, nominal)]
    found = fit_monotone(x, values[0] / values[1] * values[2])
    return dict(zip(names, (found.a, found.b, found.c), strict=True))


def _ratios(member: Artifact, reference: Artifact, nominal: Artifact) -> dict[str, float]:
    """Return nominal times member over reference, the nominal value where the reference is zero."""
    return {k: v * member[k] / reference[k] if reference[k] != 0.0 else v for k, v in nominal.items()}


def _cubic(one: Artifact, names: tuple[str, str, str]) -> Cubic:
    a, b, c = (float(one[name]) for name in names)
    return Cubic(a=a, b=b, c=c)
