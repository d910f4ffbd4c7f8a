"""Who touches whom: the object's contacts with the hand's links, and fingers with one another."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.elements import FINGERS

PALM = len(FINGERS)
"""Number that stands for the palm beside the fingers' 0 to 4."""
_NEITHER, _OBJECT = -1, -2


@dataclass(frozen=True, kw_only=True)
class ContactMap:
    """What each geometry of a model belongs to.

    Attributes
    ----------
    member: per geometry: 0 to 4 a finger, 5 the palm, -2 the object, -1 anything else.
    link: per geometry the name of its body.
    """

    member: npt.NDArray[np.int64]
    link: tuple[str, ...]

    @classmethod
    def of(cls, model: mujoco.MjModel) -> "ContactMap":
        """Look the names up once."""
        names = [str(model.body(body).name) for body in model.geom_bodyid]
        return cls(member=np.array([_member(name) for name in names], dtype=np.int64), link=tuple(names))

    def of_object(self, data: mujoco.MjData) -> npt.NDArray[np.int64]:
        """Return the indices of the contacts between object and hand, shape (n,)."""
        pair = self.member[data.contact.geom]
        return np.flatnonzero((pair == _OBJECT).any(axis=1) & (pair >= 0).any(axis=1))

    def of_fingers(self, data: mujoco.MjData) -> npt.NDArray[np.int64]:
        """Return the indices of the contacts of one finger with another, shape (n,)."""
        pair = self.member[data.contact.geom]
        fingers = ((pair >= 0) & (pair < PALM)).all(axis=1)
        return np.flatnonzero(fingers & (pair[:, 0] != pair[:, 1]))

    def hand_geom(self, data: mujoco.MjData, contact: int) -> int:
        """Return the hand's geometry in a contact with the object."""
        first, second = data.contact.geom[contact]
        return int(second) if self.member[first] == _OBJECT else int(first)

    def normal_forces_n(self, model: mujoco.MjModel, data: mujoco.MjData) -> npt.NDArray[np.float64]:
        """Sum of the normal forces (N) of each finger and the palm on the object, shape (6,)."""
        total, force = np.zeros(PALM + 1), np.zeros(6)
        for contact in self.of_object(data):
            mujoco.mj_contactForce(model, data, int(contact), force)
            total[self.member[self.hand_geom(data, int(contact))]] += force[0]
        return total


def _member(body: str) -> int:
    if body == "object":
        return _OBJECT
    if body == "palm":
        return PALM
    return next((i for i, finger in enumerate(FINGERS) if body.startswith(f"{finger}_")), _NEITHER)
