"""The cheap closing that grasp candidates are scored by: many worlds at once inside the engine, pressures played back.

The hand comes in, closes and lifts until the object must be off the table, as in a trial, but nothing is fed back: the
pressures are those of a closing in free air, and friction within the fingers is left out. What was lifted with some of
its weight is lifted again with more, from the same closed hand.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt
from mujoco import rollout

from softhand_sim.calibration import JOINT_RANGE_RAD, FingerCalibration
from softhand_sim.effects import BENCH
from softhand_sim.effects.build import TICK_S
from softhand_sim.effects.rehearsal import rehearse
from softhand_sim.elements import spread_to_fingers
from softhand_sim.grasp.contacts import ContactMap
from softhand_sim.grasp.place import Offset, on_table
from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.verdict import Thresholds
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.index import HandIndex
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.model import ObjectModel

Vector = npt.NDArray[np.float64]

_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
_CONTROL = mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_XFRC_APPLIED
# choice: an initial state with more overlap than a settled contact has was not reached by any motion
START_DEPTH_M = 0.5e-3
# choice: half a minute of simulated time in memory at once is some 20 MB
_WORLDS_AT_ONCE = 32


# choice: what the lift has to spare over the largest slip and tilt allowed, so that what stays on the table, with one
# end or all of it, counts as lost. A banana that was lifted by 25 mm alone stood on its end and looked held
SPARE_M, SHORTEST_LIFT_M = 0.005, 0.025
# choice: shares of the weight, each lifted from the same closed hand; the first ones give a search a slope to climb. A
# load that grows in the hand tells trials less: a baseball that came up with 0.6 of its weight was then held to 1.2 of
# it, and not once came up with all of it
LOADS = (0.6, 0.8, 1.0, 1.2)
DWELL_S = 0.5
# choice: a hand that has to be pressed onto object or table with more than this does not count as having come in; it
# would force a can between the fingers' bases with all the strength of the arm
PRESS_N = 10.0
# choice: a hold that a joint's stop carries is refused: a finger bent back is not calibrated, and nobody knows where it
# would stop; one that touches the stop for a moment is not
STOPPED_SHARE = 0.25
# choice: held pressures end up to a pulse, 2 kPa, below the set ones; an apple that is drawn in still moves when the
# last finger has filled
FILLED = 0.97
CLOSED_REST_S = 0.4
# choice: coming in and closing are nearly quasi-static, hurried ones serve to sort candidates; what can roll is pushed
# further by a slow finger, so the last word belongs to closings in real time. The way in stays within 200 mm/s
FASTEST_WAY_IN = 2.0
# choice: the longest step that the contacts' time constant of 6 ms allows; no noslip iterations. Costs a third
TIMESTEP_S = 0.003
ENGINE = EngineSettings(timestep_s=TIMESTEP_S, noslip_iterations=0)


@dataclass(frozen=True, kw_only=True)
class Closing:
    """Closes the hand of one scene around its object from many poses.

    Attributes
    ----------
    model: scene with hand, table and object.
    calibration: of the fingers.
    rest_height_m: of the object's mass centre.
    protocol: its way in and its limits of slip and tilt.
    anatomy: the wrist's speed.
    lift_m: height that the hand gains; see `lift_of`.
    """

    model: mujoco.MjModel
    calibration: FingerCalibration
    rest_height_m: float
    protocol: GraspProtocol
    anatomy: HandAnatomy
    lift_m: float

    def load_factors(self, plans: Sequence[GraspPlan], offsets: Sequence[Offset], haste: float = 1.0) -> Vector:
        """Return the load that each plan holds for each displacement of the object, shape (plans, offsets).

        In shares of the object's weight: the last of `LOADS` with which it was lifted, within the limits of slip and
        tilt, and of the step to the next one the share of the time that it held; 0 for a start in which the hand
        overlaps object or table, if it must be pressed to its pose, or if the stop of a joint that is bent back carries
        the weight.

        Parameters
        ----------
        plans: grasps.
        offsets: x, y (m) and yaw (rad) of the object beside its place.
        haste: how many times faster than in a trial the fingers fill.
        """
        result = np.zeros((len(plans), len(offsets)))
        data, hand = mujoco.MjData(self.model), HandIndex.of(self.model)
        waiting: dict[tuple[float, ...], list[tuple[int, int, Vector]]] = {}
        for i, plan in enumerate(plans):
            for j, offset in enumerate(offsets):
                start = self._start(data, hand, plan, offset)
                if start is not None:
                    waiting.setdefault(plan.set_angle_deg, []).append((i, j, start))
        for angles, worlds in waiting.items():
            pressures = self._pressures_pa(angles, haste)
            for k in range(0, len(worlds), _WORLDS_AT_ONCE):
                part = worlds[k : k + _WORLDS_AT_ONCE]
                starts = np.stack([start for _, _, start in part])
                loads = self._loads_held([plans[i] for i, _, _ in part], starts, pressures, haste)
                for (i, j, _), value in zip(part, loads, strict=True):
                    result[i, j] = value
        return result

    def _start(self, data: mujoco.MjData, hand: HandIndex, plan: GraspPlan, offset: Offset) -> Vector | None:
        """Return the state with hand and object at their start, or None if the hand overlaps anything there."""
        mujoco.mj_resetData(self.model, data)
        data.qpos[hand.wrist_qpos] = plan.standoff(self.protocol.approach_m)
        address = self.model.joint("object_joint").qposadr[0]
        data.qpos[address : address + 7] = on_table(self.rest_height_m, offset)
        mujoco.mj_forward(self.model, data)
        if overlap_m(ContactMap.of(self.model), data) > START_DEPTH_M:
            return None
        state = np.empty(mujoco.mj_stateSize(self.model, _STATE))
        mujoco.mj_getState(self.model, data, state, _STATE)
        return state

    def _pressures_pa(self, set_angle_deg: tuple[float, ...], haste: float) -> Vector:
        """Return the pressures of the fingers while they close, a row an engine step, shape (n, 5)."""
        wanted = np.array([self.calibration.closing_pressure(angle) for angle in set_angle_deg])
        rehearsed = rehearse(BENCH, self.calibration, wanted, self.protocol.close_s)
        assert rehearsed is not None  # BENCH has gas
        rows = rehearsed.pressure_pa_gauge
        filled = int(np.argmax((rows >= FILLED * wanted).all(axis=1))) or len(rows) - 1
        fingers = np.array([spread_to_fingers(row) for row in rows[: filled + 1].tolist()])
        ticks = TICK_S / haste * np.arange(1, len(fingers) + 1)
        times = np.arange(0.0, ticks[-1] + CLOSED_REST_S, self.model.opt.timestep)
        return np.column_stack([np.interp(times, ticks, column, left=0.0) for column in fingers.T])

    def _loads_held(self, plans: Sequence[GraspPlan], starts: Vector, pressure_pa: Vector, haste: float) -> Vector:
        """Close, then lift with one load after another those that held the last; return the load held, (n,)."""
        hand = HandIndex.of(self.model)
        closed = self._run(starts, self._closing(plans, hand, pressure_pa, haste))[:, -1]
        off_m = np.linalg.norm(closed[:, 1 + hand.wrist_qpos[:3]] - [plan.wrist_pose[:3] for plan in plans], axis=1)
        result = np.zeros(len(plans))
        left = np.flatnonzero(self.anatomy.wrist_stiffness_n_per_m * off_m <= PRESS_N)
        before = 0.0
        for load in LOADS:
            if not len(left):
                break
            states = self._run(closed[left], self._lifting([plans[int(i)] for i in left], hand, pressure_pa[-1], load))
            lost = self._lost(states, closed[left], hand)
            # what is lost counts by how long it was held
            result[left] = before + (load - before) * lost / states.shape[1]
            stopped = self._on_a_stop(states, hand)
            result[left[stopped]] = 0.0 if load <= 1.0 else before
            left, before = left[(lost == states.shape[1]) & ~stopped], load
        return result

    def _on_a_stop(self, states: Vector, hand: HandIndex) -> npt.NDArray[np.bool_]:
        """Return in which worlds, (n,), a joint rests on its lower stop in more than `STOPPED_SHARE` of the states."""
        bent = states[:, :, 1 + hand.joint_qpos.ravel()].min(axis=2)
        return np.asarray((bent <= JOINT_RANGE_RAD[0]).mean(axis=1) > STOPPED_SHARE)

    def _run(self, starts: Vector, controls: Vector) -> Vector:
        """Return the states, shape (worlds, steps, n), that controls lead to."""
        data = mujoco.MjData(self.model)
        states, _ = rollout.rollout(self.model, data, starts, controls, control_spec=int(_CONTROL))
        return np.asarray(states)

    def _closing(self, plans: Sequence[GraspPlan], hand: HandIndex, pressure_pa: Vector, haste: float) -> Vector:
        """Return each world's control and applied forces as the hand comes in and closes, shape (plans, steps, n)."""
        model, step_s = self.model, self.model.opt.timestep
        step_m = self.anatomy.wrist_speed_m_per_s * step_s
        come = np.linspace(1.0, 0.0, round(self.protocol.approach_m / (min(haste, FASTEST_WAY_IN) * step_m)) + 1)[1:]
        controls = np.zeros((len(plans), len(come) + len(pressure_pa), model.nu + 6 * model.nbody))
        controls[:, len(come) :, hand.pressure_ctrl] = pressure_pa
        for control, plan in zip(controls, plans, strict=True):
            way = np.tile(plan.standoff(0.0), (len(control), 1))
            way[: len(come), :3] += self.protocol.approach_m * come[:, None] * np.array(plan.retreat)
            control[:, hand.wrist_ctrl] = way
        return controls

    def _lifting(self, plans: Sequence[GraspPlan], hand: HandIndex, pressure_pa: Vector, load: float) -> Vector:
        """Return each world's control and applied forces while the hand lifts and waits, shape (plans, steps, n)."""
        model, step_s = self.model, self.model.opt.timestep
        rise = round(self.lift_m / (self.anatomy.wrist_speed_m_per_s * step_s))
        up = np.append(np.linspace(0.0, self.lift_m, rise + 1)[1:], np.full(round(DWELL_S / step_s), self.lift_m))
        body = int(model.body("object").id)
        weight = -float(model.body_mass[body]) * np.array(model.opt.gravity)
        controls = np.zeros((len(plans), len(up), model.nu + 6 * model.nbody))
        controls[:, :, hand.pressure_ctrl] = pressure_pa
        controls[:, :, model.nu + 6 * body : model.nu + 6 * body + 3] = (1.0 - load) * weight
        for control, plan in zip(controls, plans, strict=True):
            way = np.tile(plan.standoff(0.0), (len(control), 1))
            way[:, 2] += up
            control[:, hand.wrist_ctrl] = way
        return controls

    def _lost(self, states: Vector, mark: Vector, hand: HandIndex) -> npt.NDArray[np.int64]:
        """Return the step at which slip or tilt since the mark pass a limit, the number of steps if none does, (n,)."""
        # a full state starts with the time
        path, before = states[:, :, 1 : 1 + self.model.nq], mark[:, None, 1 : 1 + self.model.nq]
        address, wrist = self.model.joint("object_joint").qposadr[0], hand.wrist_qpos[:3]
        place, turn = slice(address, address + 3), slice(address + 3, address + 7)
        in_hand = (path[:, :, place] - path[:, :, wrist]) - (before[:, :, place] - before[:, :, wrist])
        slip = np.linalg.norm(in_hand, axis=2)
        tilt = 2.0 * np.arccos(np.minimum(1.0, np.abs(np.sum(path[:, :, turn] * before[:, :, turn], axis=2))))
        limits = self.protocol.thresholds
        # not a number is lost, too
        kept = (slip <= limits.slip_m) & (tilt <= limits.tilt_rad)
        return np.asarray(np.where(kept.all(axis=1), states.shape[1], np.argmin(kept, axis=1)))


def lift_of(model: ObjectModel, limits: Thresholds) -> float:
    """Return the height (m) from which no part of an object within the limits of slip and tilt reaches the table."""
    furthest_m = float(np.linalg.norm(np.asarray(model.mesh.vertices)[:, :2], axis=1).max())
    return max(SHORTEST_LIFT_M, limits.slip_m + furthest_m * float(np.sin(min(limits.tilt_rad, np.pi / 2))) + SPARE_M)


def overlap_m(contacts: ContactMap, data: mujoco.MjData) -> float:
    """Return how deep (m) the hand is in something else; 0 if it touches nothing."""
    pair = contacts.member[data.contact.geom] if data.ncon else np.empty((0, 2))
    crossing = (pair >= 0).any(axis=1) & (pair < 0).any(axis=1)
    return max(0.0, -float(data.contact.dist[crossing].min(initial=0.0)))
