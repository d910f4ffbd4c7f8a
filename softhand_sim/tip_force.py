"""Force of one simulated fingertip on a fixed plate: the paper's tip-force test in MuJoCo."""

from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene
from softhand_sim.simulation import HandIndex

SENSOR_DISTANCE_M = 0.040
"""Distance of finger and force sensor: Alves et al., section 3.2. Choice: from the palm side of the straight finger to
the plate, which is parallel to it; the figure is not available."""
FINGER = "index"
"""All fingers are identical; the index stands for them."""
# choice: far below what any figure is quoted to
_STILL_RAD_PER_S, _LONGEST_S = 1e-4, 30.0


def tip_force(
    calibration: FingerCalibration, pressures_pa_gauge: Sequence[float], *, distance_m: float = SENSOR_DISTANCE_M
) -> npt.NDArray[np.float64]:
    """Return the normal force [N] of the last phalanx on the plate at rest, shape (n,), at pressures of shape (n,).

    Gravity is off, the plate has no friction and only the last phalanx touches it, as in the finite elements
    (:mod:`fea.tip_wall`). Zero where the tip does not reach the plate.

    Raises
    ------
    ValueError
        If a pressure is outside the calibration's curve, or the distance is not positive.
    RuntimeError
        If the finger does not come to rest.
    """
    for pressure in pressures_pa_gauge:
        calibration.angle_for_pressure(pressure)
    if not 0.0 < distance_m < 0.2:
        raise ValueError(f"distance_m = {distance_m!r}: must lie in (0, 0.2) m")
    model = _with_plate(calibration, distance_m)
    data, index = mujoco.MjData(model), HandIndex.of(model)
    actuator = model.actuator(f"{FINGER}_pressure").id
    forces = []
    for pressure in pressures_pa_gauge:
        data.ctrl[actuator] = pressure
        _come_to_rest(model, data, index.joint_qpos)
        forces.append(_plate_force_n(model, data))
    return np.array(forces)


def _with_plate(calibration: FingerCalibration, distance_m: float) -> mujoco.MjModel:
    """Compile the hand without gravity, a plate fixed to the finger's base; nothing else collides."""
    root = build_root(calibration, engine=EngineSettings(gravity_m_per_s2=0.0))
    half = 0.5 * calibration.finger.length_m
    thickness = 0.005
    # the base's frame: x to where the finger curls, z along it
    root.find("body", f"{FINGER}_base").add(
        "geom",
        name="plate",
        type="box",
        size=(thickness, 2.0 * half, 2.0 * half),
        pos=(calibration.finger.outer_radius_m + distance_m + thickness, 0.0, half),
        mass=0,
    )
    model = compile_scene(root).model
    model.geom_contype[:] = 0
    model.geom_conaffinity[:] = 0
    plate, phalanx = model.geom("plate").id, model.body(f"{FINGER}_distal").id
    touching = np.flatnonzero(model.geom_bodyid == phalanx)
    model.geom_contype[plate] = 1
    model.geom_conaffinity[touching] = 1
    model.geom_condim[[plate, *touching]] = 1
    return model


def _come_to_rest(model: mujoco.MjModel, data: mujoco.MjData, joints: npt.NDArray[np.float64]) -> None:
    end_s = data.time + _LONGEST_S
    before = data.qpos[joints].copy()
    span_s = 50 * float(model.opt.timestep)
    while data.time < end_s:
        mujoco.mj_step(model, data, nstep=50)
        now = data.qpos[joints].copy()
        if float(np.abs(now - before).max()) < _STILL_RAD_PER_S * span_s:
            return
        before = now
    raise RuntimeError(f"the finger still moves after {_LONGEST_S:g} s")


def _plate_force_n(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    total, wrench = 0.0, np.zeros(6)
    for contact in range(data.ncon):
        mujoco.mj_contactForce(model, data, contact, wrench)
        total += float(wrench[0])
    return total
