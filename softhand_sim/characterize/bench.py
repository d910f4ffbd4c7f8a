"""A test bench: one MuJoCo finger on a fixed base, its pressure and tip load moved slowly, without gravity."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import JOINTS, FingerCalibration
from softhand_sim.contact import ContactSettings
from softhand_sim.hand.chain import hinges, joint_angles
from softhand_sim.hand.finger import add_finger
from softhand_sim.hand.hand import add_defaults
from softhand_sim.hand.index import chain_joints
from softhand_sim.hand.scene import EngineSettings, compile_scene, empty_root
from softhand_sim.losses import Losses
from softhand_sim.relaxation import MaxwellBranch
from softhand_sim.relief import ProximalRelief

Vector = npt.NDArray[np.float64]
NAME = "finger"

PRESSURE_RATE_PA_PER_S, LOAD_RATE_N_PER_S = 20e3, 0.05
"""Choices: halving them moves forces and deflections by 0.1 % at most, and the hysteresis loop's area by 2 %."""
STILL_RAD_PER_S, LONGEST_S = 1e-5, 30.0
"""Choice: 1e-5 rad/s over the time allowed is 0.02 degrees, less than any figure is quoted to."""
_SENSOR_RADIUS_M = 5e-4
_SENSOR = 2
# one bit of contact for wall and corner: the finger's own shapes, which are rounded, do not meet the wall


@dataclass(frozen=True, kw_only=True)
class Reading:
    """What the bench shows at rest; angles proximal to distal, (3,); the tip's place towards the palm side and along z.

    Both are of the end plate's outer centre.
    """

    pressure_pa_gauge: float
    tip_load_n: float
    joint_angle_rad: Vector
    elongation_m: float
    volume_m3: float
    tip_displacement_m: float
    tip_position_m: tuple[float, float]
    wall_force_n: float

    @property
    def tip_angle_deg(self) -> float:
        """Sum of the joint angles [deg]."""
        return float(np.degrees(self.joint_angle_rad.sum()))


class Bench:
    """One finger that points up and bends towards x; mutable, as it wraps the engine's own ``MjData``.

    Parameters
    ----------
    calibration
        The finger.
    wall_distance_m
        Distance of a frictionless wall from the palm side of the tip, parallel to the straight finger; None: no wall.
        What meets it is the tube's end, whose edge is the first thing of the finite-element finger to meet its own.
    gravity_m_per_s2
        Gravity's vector in the bench's frame (x: bending, z: along the straight finger), shape (3,).
    relaxation
        Branches of the wall's relaxation, none by default.
    relief
        Relief at the proximal joint, none by default.
    links
        Hinges of a chain (`softhand_sim.hand.chain`) in place of the three joints.
    timestep_s
        Time step of the engine [s].
    """

    def __init__(
        self,
        calibration: FingerCalibration,
        *,
        wall_distance_m: float | None = None,
        gravity_m_per_s2: tuple[float, float, float] = (0.0, 0.0, 0.0),
        relaxation: tuple[MaxwellBranch, ...] = (),
        relief: ProximalRelief | None = None,
        links: int | None = None,
        timestep_s: float = EngineSettings.timestep_s,
    ) -> None:
        self.calibration = calibration
        self.model = _model(calibration, wall_distance_m, links, timestep_s)
        self.model.opt.gravity[:] = gravity_m_per_s2
        self.data = mujoco.MjData(self.model)
        self.losses = Losses.of(calibration, relaxation, relief)
        model, names = self.model, chain_joints(self.model, NAME)
        self._chain = hinges(calibration, links)
        self.qpos = np.array([model.joint(name).qposadr[0] for name in names])
        self.tendon = model.tendon(f"{NAME}_actuator").id
        self._pressure_ctrl = model.actuator(f"{NAME}_pressure").id
        self._loss_ctrl = model.actuator(f"{NAME}_loss").id
        self._tip, self._distal = model.site(f"{NAME}_tip").id, model.body(f"{NAME}_distal").id
        self._pressure, self._load = 0.0, 0.0
        self._losses = self.losses.rest(np.zeros(1))
        mujoco.mj_forward(self.model, self.data)
        self._tip_at_rest = self.data.site_xpos[self._tip].copy()

    @property
    def elongation_m(self) -> float:
        """Elongation of the actuator at the start of the last step [m], where its forces act as well."""
        return float(self.model.tendon_length0[self.tendon] - self.data.ten_length[self.tendon])

    @property
    def bulge_m(self) -> float:
        """What the relief has let out of the actuator [m], which is longer by it than the joints ask for."""
        return float(self._losses.bulge_m[0])

    @property
    def pressure_force_n(self) -> float:
        """Force of the pressure along the elongation in the last step [N]."""
        return float(self.data.actuator_force[self._pressure_ctrl])

    @property
    def loss_force_n(self) -> float:
        """Force of friction, relaxation and relief along the elongation in the last step [N]."""
        return float(self.data.actuator_force[self._loss_ctrl])

    def step(self, pressure_pa_gauge: float, tip_load_n: float = 0.0, *, nstep: int = 1) -> None:
        """Advance by time steps under a pressure and a load on the tip towards the back of the hand [N].

        Losses and the load's place are those of the first of them.
        """
        data = self.data
        data.ctrl[self._pressure_ctrl] = pressure_pa_gauge
        angle, dt = data.qpos[self.qpos][None], nstep * self.model.opt.timestep
        elongation, bend = self._elongations_m(angle), np.abs(angle).sum(axis=1)
        self._losses, force = self.losses.step(self._losses, elongation, bend, np.array([pressure_pa_gauge]), dt)
        data.ctrl[self._loss_ctrl] = force[0]
        if tip_load_n or self._load:
            data.qfrc_applied[:] = 0.0
            push, place = np.array([-tip_load_n, 0.0, 0.0]), data.site_xpos[self._tip]
            mujoco.mj_applyFT(self.model, data, push, np.zeros(3), place, self._distal, data.qfrc_applied)
        mujoco.mj_step(self.model, data, nstep=nstep)
        self._pressure, self._load = pressure_pa_gauge, tip_load_n

    def go_to(self, pressure_pa_gauge: float, tip_load_n: float = 0.0) -> Reading:
        """Move pressure and load slowly, wait for rest and read.

        Raises
        ------
        ValueError
            If the pressure lies outside the calibration's curve.
        RuntimeError
            If the finger does not come to rest.
        """
        self.calibration.angle_for_pressure(pressure_pa_gauge)
        start, load = self._pressure, self._load
        time = max(abs(pressure_pa_gauge - start) / PRESSURE_RATE_PA_PER_S, abs(tip_load_n - load) / LOAD_RATE_N_PER_S)
        steps = int(np.ceil(time / self.model.opt.timestep))
        for k in range(1, steps + 1):
            share = k / steps
            self.step(start + share * (pressure_pa_gauge - start), load + share * (tip_load_n - load))
        end = self.data.time + LONGEST_S
        while self.data.time < end:
            for _ in range(25):
                self.step(pressure_pa_gauge, tip_load_n)
            if float(np.abs(self.data.qvel).max()) < STILL_RAD_PER_S:
                return self.read()
        raise RuntimeError(f"finger still moves at {float(np.abs(self.data.qvel).max()):g} rad/s after {LONGEST_S} s")

    def read(self) -> Reading:
        """Return what the bench shows now."""
        mujoco.mj_forward(self.model, self.data)
        chamber, elongation = self.calibration.chamber, self.elongation_m
        return Reading(
            pressure_pa_gauge=self._pressure,
            tip_load_n=self._load,
            joint_angle_rad=joint_angles(self.data.qpos[self.qpos], len(self.qpos) // len(JOINTS)),
            elongation_m=elongation,
            volume_m3=chamber.volume_m3_at(elongation + self.bulge_m) + chamber.bulging_m3_per_pa * self._pressure,
            tip_displacement_m=float(np.linalg.norm(self.data.site_xpos[self._tip] - self._tip_at_rest)),
            tip_position_m=(float(self.data.site_xpos[self._tip][0]), float(self.data.site_xpos[self._tip][2])),
            wall_force_n=self._wall_force_n(),
        )

    def _elongations_m(self, angle_rad: Vector) -> Vector:
        if len(self._chain) == len(JOINTS):
            return self.calibration.elongations_m(angle_rad)
        each = [h.law.elongation_m_at(q) for h, q in zip(self._chain, angle_rad[0].tolist(), strict=True)]
        return np.array([sum(each)])

    def _wall_force_n(self) -> float:
        total, force = 0.0, np.zeros(6)
        for k in range(self.data.ncon):
            mujoco.mj_contactForce(self.model, self.data, k, force)
            total += float(force[0])
        return total


def _model(
    calibration: FingerCalibration, wall_distance_m: float | None, links: int | None, timestep_s: float
) -> mujoco.MjModel:
    """Return the bench's model: the finger of the hand on a body that does not move."""
    root = empty_root("bench", EngineSettings(timestep_s=timestep_s, gravity_m_per_s2=0.0))
    add_defaults(root, ContactSettings())
    base = root.worldbody.add("body", name=f"{NAME}_base")
    distal = add_finger(base, NAME, calibration, links)[-1]
    finger = calibration.finger
    for geom in root.find_all("geom"):
        geom.contype, geom.conaffinity = 0, 0
    if wall_distance_m is not None:
        touch = {"contype": _SENSOR, "conaffinity": _SENSOR, "condim": 1, "mass": 0.0}
        last = hinges(calibration, links)[-1].position_m
        edge = (finger.outer_radius_m - finger.hinge_offset_m, 0.0, finger.length_m - last)
        distal.add("geom", name="edge", type="sphere", size=(_SENSOR_RADIUS_M,), pos=edge, **touch)
        place = (finger.outer_radius_m + wall_distance_m + _SENSOR_RADIUS_M, 0.0, 0.0)
        base.add("geom", name="wall", type="plane", size=(1, 1, 0.1), pos=place, zaxis=(-1, 0, 0), **touch)
    return compile_scene(root).model
