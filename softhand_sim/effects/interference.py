"""Finger-finger interference: fingers can touch one another."""

import copy
import math
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import mujoco
import numpy as np

from softhand_sim.calibration import JOINTS
from softhand_sim.effects.kind import ActsOn, Closing, Estimate
from softhand_sim.elements import ELEMENT_OF_FINGER, FINGERS

ACTS_ON = ActsOn.MODEL
CLEARANCE_M = 0.005
"""Choice: a third of a finger's diameter, for joints that a load moves off the free curve."""
_LEVELS = 12


@dataclass(frozen=True, kw_only=True)
class FingerInterference:
    """Contact pairs between different fingers; it has no parameters of its own (see `ContactSettings`)."""


def without_interference(root: Any) -> None:
    """Take the pairs between different fingers out of a hand's MJCF, before it is compiled.

    Each finger's shapes get a bit of their own: they still meet everything else, their own finger included.
    """
    for k, finger in enumerate(FINGERS):
        own = 1 << (k + 1)
        for geom in root.find_all("geom"):
            if geom.name is not None and geom.name.startswith(f"{finger}_"):
                geom.contype = own
                geom.conaffinity = 1 | own


def question(scene: Closing) -> Estimate:
    """Ask whether the volumes that the fingers sweep on the way to their set pressures come near one another.

    Any two fingers may stop at any two angles on the way, wherever the object holds them up.
    """
    for one, other in combinations(FINGERS, 2):
        if _meet(scene, one, other):
            reason = f"{one} and {other} can come within {1e3 * CLEARANCE_M:.0f} mm on the way to their set angles"
            return Estimate(own_deg=math.inf, redraws=True, reason=reason)
    return Estimate(own_deg=0.0, redraws=False, reason="no two fingers come near each other")


def _meet(scene: Closing, one: str, other: str) -> bool:
    model = copy.copy(scene.hand)
    model.geom_margin[:] = 0.5 * CLEARANCE_M  # the engine adds up the two shapes' margins
    data = mujoco.MjData(model)
    curve, shares = scene.calibration.curve, np.linspace(0.0, 1.0, _LEVELS)
    owner = [model.geom(k).name.split("_")[0] for k in range(model.ngeom)]
    highest = {f: scene.set_pa_gauge[ELEMENT_OF_FINGER[FINGERS.index(f)]] for f in (one, other)}
    for first in shares:
        for second in shares:
            for finger, share in ((one, first), (other, second)):
                for j, joint in enumerate(JOINTS):
                    angle = np.interp(share * highest[finger], curve.pressure_pa_gauge, curve.joint_angle_deg[:, j])
                    data.joint(f"{finger}_{joint}").qpos[0] = np.radians(angle)
            mujoco.mj_fwdPosition(model, data)
            if any({owner[a], owner[b]} == {one, other} for a, b in data.contact.geom.tolist()):
                return True
    return False
