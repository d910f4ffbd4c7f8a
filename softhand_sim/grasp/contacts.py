"""Who touches whom: the object's contacts with the hand's links, and fingers with one another."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.elements import FINGERS

PALM = len(FINGERS)
"""Number that stands for the palm beside the fingers' 0 to 4."""
_NEITHER, _OBJECT = -1, -2
_ELSEWHERE, IN_HAND, _CROSSING = 1, 2, 3
"""Kinds of contacts (`ContactMap.kind`)."""


@dataclass(frozen=True, kw_only=True)
class ContactMap:
    """What each geometry of a model belongs to.

    Attributes
    ----------
    member: per geometry: 0 to 4 a finger, 5 the palm, -2 the object, -1 anything else.
    link: per geometry the name of its body.
    kind: of a contact of two geometries, (ngeom, ngeom): object and hand, object and anything else, finger and finger,
        none of these; one look-up in place of many comparisons, as it is asked every 20 ms.
    """

    member: npt.NDArray[np.int64]
    link: tuple[str, ...]
    kind: npt.NDArray[np.int8]

    @classmethod
    def of(cls, model: mujoco.MjModel) -> "ContactMap":
        """Look the names up once."""
        names = [str(model.body(body).name) for body in model.geom_bodyid]
        member = np.array([_member(name) for name in names], dtype=np.int64)
        return cls(member=member, link=tuple(names), kind=_kinds(member))

    def kinds(self, data: mujoco.MjData) -> npt.NDArray[np.int8]:
        """Return the kind of each contact, shape (ncon,)."""
        first, second = data.contact.geom.T
        return np.asarray(self.kind[first, second])

    def of_object(self, data: mujoco.MjData) -> npt.NDArray[np.int64]:
        """Return the indices of the contacts between object and hand, shape (n,)."""
        return np.flatnonzero(self.kinds(data) == IN_HAND)

    def of_fingers(self, data: mujoco.MjData) -> npt.NDArray[np.int64]:
        """Return the indices of the contacts of one finger with another, shape (n,)."""
        return np.flatnonzero(self.kinds(data) == _CROSSING)

    def depths_m(self, data: mujoco.MjData) -> tuple[float, float | None]:
        """Deepest contact of the object with anything (0 without), and of fingers with one another (None without)."""
        kinds, depth = self.kinds(data), -data.contact.dist
        crossing = kinds == _CROSSING
        deepest = depth.max(initial=0.0, where=(kinds == _ELSEWHERE) | (kinds == IN_HAND))
        return float(deepest), float(depth[crossing].max()) if crossing.any() else None

    def deeper_m(self, data: mujoco.MjData, limit_m: float) -> float:
        """Return the deepest contact of `depths_m` if any contact at all is deeper than a limit, else 0.

        A quick question where that is rare: `depths_m` takes five times as long.
        """
        if not data.ncon or data.contact.dist.min() >= -limit_m:
            return 0.0
        depth, crossing = self.depths_m(data)
        return max(depth, crossing or 0.0)

    def hand_geom(self, data: mujoco.MjData, contact: int) -> int:
        """Return the hand's geometry in a contact with the object."""
        first, second = data.contact.geom[contact]
        return int(second) if self.member[first] == _OBJECT else int(first)

    def normal_forces_n(
        self, data: mujoco.MjData, found: npt.NDArray[np.int64] | None = None
    ) -> npt.NDArray[np.float64]:
        """Sum of the normal forces (N) of each finger and the palm on the object, shape (6,).

        With elliptic cones, which this simulator has, the first of a contact's forces is the normal one.
        `found`: what `of_object` returns, if it is known.
        """
        found = self.of_object(data) if found is None else found
        if not len(found):
            return np.zeros(PALM + 1)
        # the object's member number is negative, the hand's is not
        member = self.member[data.contact.geom[found]].max(axis=1)
        row = data.contact.efc_address[found]
        force = np.where(row >= 0, data.efc_force[row], 0.0)
        return np.asarray(np.bincount(member, weights=force, minlength=PALM + 1), dtype=np.float64)


def _kinds(member: npt.NDArray[np.int64]) -> npt.NDArray[np.int8]:
    one, other = member[:, None], member[None, :]
    kind = np.zeros((len(member), len(member)), dtype=np.int8)
    kind[(one == _OBJECT) | (other == _OBJECT)] = _ELSEWHERE
    kind[((one == _OBJECT) & (other >= 0)) | ((other == _OBJECT) & (one >= 0))] = IN_HAND
    kind[(one >= 0) & (other >= 0) & (one != other) & (one < PALM) & (other < PALM)] = _CROSSING
    return kind


def _member(body: str) -> int:
    if body == "object":
        return _OBJECT
    if body == "palm":
        return PALM
    return next((i for i, finger in enumerate(FINGERS) if body.startswith(f"{finger}_")), _NEITHER)
