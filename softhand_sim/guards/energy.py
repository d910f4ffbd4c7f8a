"""Energy book of a running world: what appears beyond the actuators' and external forces' work.

Over a tick from 0 to 1 the mechanical energy E (kinetic, gravity, springs of joints and tendons) may grow by the work
of the actuators and by that of a force on the object. Each actuator's work is at most its way l1 - l0 times the larger
force of both ends, max(f0 (l1 - l0), f1 (l1 - l0)), as long as its force changes one way: a command may jump at 0.
Contact, friction and damping only take. The excess over that is summed up and never falls below zero (Page, 1954,
Biometrika 41: a one-sided cumulative sum), so that neither a slow gain nor a jolt hides behind what is dissipated
elsewhere. `RULE_ERROR` of what moved in a tick is allowed to that rule.
"""

from collections.abc import Mapping

import mujoco
import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]

RULE_ERROR = 0.1
"""Choice: a force may also swing within a tick; with the wrist shaking at 4 Hz less than 1 mJ is left."""


class EnergyBook:
    """Sum of the energy from nowhere, in J, since the last `begin`."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, body: int) -> None:
        """Watch a world, with external forces on one body."""
        self._model, self._data = model, data
        # views of the engine's memory, which never moves
        self._energy, self._force, self._length = data.energy, data.actuator_force, data.actuator_length
        self._place, self._push = data.xipos[body], data.xfrc_applied[body, :3]
        # what the engine's gravity compensation bears has no weight, yet its potential is counted
        self._places, self._borne_kg = data.xipos, model.body_gravcomp * model.body_mass
        self._floats = bool(self._borne_kg.any())
        self._work, self._way = np.empty_like(self._force), np.empty_like(self._length)
        self.begin()

    def begin(self) -> None:
        """Start from the present state, with nothing in the book."""
        self.excess_j = 0.0
        self._energy_before = self._energy_j()
        self._force_before, self._length_before = self._force.copy(), self._length.copy()
        self._place_before = self._place.copy()
        self.notice_push()

    def notice_push(self) -> None:
        """Take note of whether a force acts on the body; to be called where that changes."""
        self._pushed = bool(self._push.any())

    def look(self) -> float:
        """Take in the time since the last look; return the excess [J], NaN if it has none."""
        energy = self._energy_j()
        np.subtract(self._length, self._length_before, out=self._way)
        np.multiply(self._force, self._way, out=self._work)
        np.multiply(self._force_before, self._way, out=self._way)
        np.maximum(self._work, self._way, out=self._work)
        work = float(self._work.sum())
        if self._pushed:
            work += float(self._push.dot(self._place - self._place_before))
        gained = energy - self._energy_before
        excess = self.excess_j + gained - work - RULE_ERROR * (abs(gained) + abs(work))
        # so ordered that a NaN stays one
        self.excess_j = 0.0 if excess < 0.0 else excess
        self._energy_before = energy
        self._force_before[:], self._length_before[:], self._place_before[:] = self._force, self._length, self._place
        return self.excess_j

    def _energy_j(self) -> float:
        mujoco.mj_energyPos(self._model, self._data)
        mujoco.mj_energyVel(self._model, self._data)
        energy = float(sum(self._energy.tolist()))
        if self._floats:
            energy += float(self._borne_kg @ self._places @ self._model.opt.gravity)
        return energy

    def state(self) -> dict[str, Vector]:
        """Return what the next look depends on."""
        scalars = np.array([self.excess_j, self._energy_before])
        return {
            "scalars": scalars,
            "force": self._force_before.copy(),
            "length": self._length_before.copy(),
            "place": self._place_before.copy(),
        }

    def restore(self, state: Mapping[str, Vector]) -> None:
        """Go back to what `state` returned."""
        self.excess_j, self._energy_before = (float(x) for x in state["scalars"])
        self._force_before, self._length_before = state["force"].copy(), state["length"].copy()
        self._place_before = state["place"].copy()
