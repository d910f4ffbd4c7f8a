"""A finger's three joints split into hinges in series, spread over each flexure's length."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import JOINTS, FingerCalibration
from softhand_sim.calibration.parts import JointCalibration

Vector = npt.NDArray[np.float64]

MOST_LINKS = 48
"""Choice: 16 hinges in 5 mm; the time step has to follow the stiffness, which grows as their number."""
ARM_RANGE_RAD = 0.7
"""Choice: bending of a joint over which the split arm is fitted to the calibrated one; at 80 kPa a joint turns 0.65."""


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """One hinge of a chain.

    Attributes
    ----------
    name: its joint's and body's name, without the finger's; a phalanx keeps its joint's own name.
    joint: number of the calibrated joint that it is a part of.
    position_m: along the straight finger from its base plane.
    law: torque, arm and damping of this hinge alone.
    share: its part of the joint's angle.
    """

    name: str
    joint: int
    position_m: float
    law: JointCalibration
    share: float


def hinges(calibration: FingerCalibration, links: int | None = None) -> tuple[Hinge, ...]:
    """Return the hinges of a finger from its base: its three joints, or ``links`` hinges, as many in each flexure.

    m hinges in series, each turned by q / m, carry the joint's torque a q + b q^2 + c q^3 if each has the law
    a m q + b m^2 q^2 + c m^3 q^3, and a joint's dashpot d is m dashpots of d m. They stand at the middles of m equal
    parts of the gap. The arm's law has no such exact split: `split_arm`.

    Raises
    ------
    ValueError
        If ``links`` is no multiple of three from 6 to ``MOST_LINKS``, or the calibration has no length of the gaps.
    """
    finger = calibration.finger
    if links is None:
        rows = zip(calibration.joints, finger.joint_position_m, strict=True)
        return tuple(
            Hinge(name=joint.name, joint=k, position_m=x, law=joint, share=1.0) for k, (joint, x) in enumerate(rows)
        )
    check_links(links)
    gap = calibration.geometry.get("gap_length_m")
    if not isinstance(gap, float) or not gap > 0.0:
        raise ValueError(f"geometry.gap_length_m = {gap!r}: a chain needs the length of the joints' gaps, above 0")
    count, found = links // len(JOINTS), []
    for k, (joint, middle) in enumerate(zip(calibration.joints, finger.joint_position_m, strict=True)):
        law = _split(joint, count)
        for i in range(count):
            name = joint.name if i == count - 1 else f"{joint.name}_{i + 1}"
            place = middle + gap * ((i + 0.5) / count - 0.5)
            found.append(Hinge(name=name, joint=k, position_m=place, law=law, share=1.0 / count))
    return tuple(found)


def check_links(links: int | None) -> None:
    """Raise unless ``links`` is None, three joints, or a number of hinges that a finger can be split into.

    Raises
    ------
    ValueError
        If it is not.
    """
    if links is not None and (links % len(JOINTS) or not 2 * len(JOINTS) <= links <= MOST_LINKS):
        raise ValueError(f"links = {links!r}: must be None or a multiple of {len(JOINTS)} from 6 to {MOST_LINKS}")


def _split(joint: JointCalibration, count: int) -> JointCalibration:
    a, b, c = joint.polynomial
    offset, slope = split_arm(joint.offset_m, joint.offset_slope_m_per_rad, count)
    return replace(
        joint,
        offset_m=offset,
        offset_slope_m_per_rad=slope,
        stiffness_n_m_per_rad=a * count,
        stiffness_n_m_per_rad2=b * count**2,
        stiffness_n_m_per_rad3=c * count**3,
        damping_n_m_s_per_rad=joint.damping_n_m_s_per_rad * count,
    )


@lru_cache(maxsize=64)
def split_arm(offset_m: float, slope_m_per_rad: float, count: int) -> tuple[float, float]:
    """Return offset [m] and slope [m/rad] of each hinge's arm: ``count`` of them lengthen the tendon as one did.

    2 r0 sin(q / 2) + 4 r1 (1 - cos(q / 2)) of the joint against ``count`` times that of q / ``count``, least squares
    over 0 to ``ARM_RANGE_RAD``; equal to the second order for r0 and ``count`` r1.
    """
    angle = np.linspace(0.0, ARM_RANGE_RAD, 57)[1:]
    wanted = offset_m * 2.0 * np.sin(0.5 * angle) + slope_m_per_rad * 4.0 * (1.0 - np.cos(0.5 * angle))
    part = 0.5 * angle / count
    design = count * np.stack([2.0 * np.sin(part), 4.0 * (1.0 - np.cos(part))], axis=1)
    offset, slope = np.linalg.lstsq(design, wanted, rcond=None)[0]
    return float(offset), float(slope)


def joint_angles(angle_rad: Vector, hinges_per_joint: int) -> Vector:
    """Return the angles of the three joints, (..., 3), from those of the hinges, (..., 3 m)."""
    return np.asarray(angle_rad.reshape(*angle_rad.shape[:-1], len(JOINTS), hinges_per_joint).sum(axis=-1))
