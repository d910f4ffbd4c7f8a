"""``SoftHandGrasp-v0``: reach, close, lift, hold."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from scipy.spatial.transform import Rotation

from envs.spaces import ACTION_SIZE, Vector, checked_action, observation_bounds, pack
from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.hand import HINGE_RANGE_RAD, SLIDE_RANGE_M
from softhand_sim.hand.scene import build_scene
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.render import Camera
from softhand_sim.simulation import HandSimulation, default_pneumatics

CONTROL_S = 0.05
LIFTED_M = 0.10
HELD_S = 1.0
OUT_OF_REACH_M = 0.5
RESET_OPTIONS = ("object_offset_m", "object_yaw_rad")


class SoftHandGraspEnv(gymnasium.Env[Vector, Vector]):
    """Grasp an object that stands on a table, lift it and hold it.

    ## Action space: ``Box(-1, 1, (9,), float64)``, one every 50 ms

    | index | meaning | MJCF name | -1 | +1 |
    |---|---|---|---|---|
    | 0 | set pressure, thumb | `thumb_pressure` | 0 Pa | 80 kPa gauge |
    | 1 | set pressure, index | `index_pressure` | 0 Pa | 80 kPa gauge |
    | 2 | set pressure, middle + ring + little | `middle_pressure` ... | 0 Pa | 80 kPa gauge |
    | 3, 4, 5 | wrist velocity along x, y, z | `wrist_x`, `wrist_y`, `wrist_z` | -0.1 m/s | 0.1 m/s |
    | 6, 7, 8 | turning rate in yaw, pitch, roll | `wrist_yaw`, `wrist_pitch`, `wrist_roll` | -1 rad/s | 1 rad/s |

    Set pressures go to the ON-OFF controller, which switches valves at 50 Hz; the highest is the end of the finger
    calibration's curve. The wrist's path is limited to 0.1 m/s in all, as in the paper.

    ## Observation space: ``Box(35,), float64``, clipped to its bounds

    | index | meaning | MJCF name | unit | range |
    |---|---|---|---|---|
    | 0 - 2 | sensor reading per element (thumb; index; middle + ring + little) | - | kPa gauge | -82 to 150 |
    | 3 - 5 | set pressure per element | - | kPa gauge | 0 to 150 |
    | 6 - 8 | wrist position x, y, z | `wrist_x` ... | m | -1 to 1 |
    | 9 - 11 | wrist yaw, pitch, roll | `wrist_yaw` ... | rad | -4 to 4 |
    | 12 - 26 | joint angles, thumb to little, proximal to distal each | `thumb_proximal` ... | rad | -2 to 3 |
    | 27 - 29 | object's mass centre in the palm's frame | `object` | m | -3 to 3 |
    | 30 - 33 | object's orientation in the palm's frame, quaternion w, x, y, z with w >= 0 | `object` | 1 | -1 to 1 |
    | 34 | object's height above its rest on the table | `object` | m | -3 to 3 |

    Indices 12 to 34 are privileged: the real hand has no such sensors.

    ## Reward, each step

    ``reach + lift + success``: ``reach = 1 - tanh(10 d)``, d the distance (m) from the object's centre to the point
    between the fingers (site `grasp`); ``lift = 3 clip(h / 0.1, 0, 1)``, h the object's height (m);
    ``success = 1`` while the object is held. All weights are choices.

    ## Success, termination, truncation

    ``info["is_success"]``: the object has been at least 0.1 m above its rest for 1 s without a break, and its mass
    centre within 0.15 m of that point. The episode terminates when the object is more than 0.5 m from its start or
    the simulation diverges (``info["diverged"]``), and is truncated after 200 steps (10 s).

    ``info["beyond_calibration"]`` tells that a joint angle or a pressure has left the range that the finger was
    calibrated in since the start, so that its torque is extrapolated (a pressure: cut).

    ## Start

    The hand stands open above the scripted grasp pose; the object lies up to 10 mm and 10 degrees off its place
    (uniform, from the seed). ``reset(options=...)`` takes ``object_offset_m`` (x, y) and ``object_yaw_rad``.

    ## Arguments

    ``object_name`` (catalogue name, default ``apple``) or ``object_model`` (any `ObjectModel`, e.g. from
    `load_mesh_object`); ``calibration`` (path, default the shipped one); ``render_mode`` (None or ``rgb_array``).

    ## Version history

    v0: first version.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium declares it so
        "render_modes": ["rgb_array"],
        "render_fps": round(1.0 / CONTROL_S),
    }

    def __init__(
        self,
        *,
        render_mode: str | None = None,
        object_name: str = "apple",
        object_model: ObjectModel | None = None,
        calibration: Path | None = None,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode: {render_mode!r} must be None or one of {self.metadata['render_modes']}")
        self.render_mode = render_mode
        self._object = make_object(object_name) if object_model is None else object_model
        finger = load_calibration(calibration)
        scene = build_scene(finger, add_object=lambda root: attach_object(root, self._object))
        self._simulation = HandSimulation(model=scene.model, calibration=finger, pneumatics=default_pneumatics(finger))
        self._protocol = load_protocol()
        self._start = plan_grasp(self._object).standoff(self._protocol.approach_m)
        self._highest_pa = float(finger.curve.pressure_pa_gauge[-1])
        self._body = int(scene.model.body("object").id)
        self._site = int(scene.model.site("grasp").id)
        self._substeps = round(CONTROL_S / self._simulation.dt)
        self._camera: Camera | None = None
        self._lifted_s = 0.0
        low, high = observation_bounds()
        self.observation_space = spaces.Box(low, high, dtype=np.float64)
        self.action_space = spaces.Box(-1.0, 1.0, (ACTION_SIZE,), dtype=np.float64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Vector, dict[str, Any]]:
        """Start a new episode; see the class for `options`.

        Raises
        ------
        ValueError
            If an option is unknown or not finite.
        """
        super().reset(seed=seed)
        x, y, yaw = self._offset(options or {})
        self._simulation.reset(self.np_random, self._start)
        place_object(self._simulation, self._object.rest_height_m, (x, y, yaw))
        self._home = self._simulation.data.xpos[self._body].copy()
        self._lifted_s = 0.0
        return self._observation(), self._info()

    def step(self, action: npt.ArrayLike) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """Advance by 50 ms.

        Raises
        ------
        ValueError
            If the action has a wrong shape or a value that is no number in [-1, 1]; nothing was advanced.
        """
        values = checked_action(action)
        simulation = self._simulation
        simulation.set_pressure_pa_gauge = 0.5 * (values[:3] + 1.0) * self._highest_pa
        rates = np.repeat([simulation.anatomy.wrist_speed_m_per_s, simulation.anatomy.wrist_rate_rad_per_s], 3)
        limits = np.array([*SLIDE_RANGE_M, *[HINGE_RANGE_RAD] * 3])
        target = simulation.wrist_reference + values[3:] * rates * CONTROL_S
        simulation.wrist_target = np.clip(target, limits[:, 0], limits[:, 1])
        for _ in range(self._substeps):
            simulation.step()
        if simulation.diverged:
            return self._lost()
        self._lifted_s = self._lifted_s + CONTROL_S if self._in_hand() else 0.0
        away = float(np.linalg.norm(simulation.data.xpos[self._body] - self._home))
        return self._observation(), self._reward(), away > OUT_OF_REACH_M, False, self._info()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return an RGB picture, shape (480, 640, 3), uint8; None without ``render_mode="rgb_array"``.

        Raises
        ------
        RenderUnavailableError
            If this machine has no OpenGL library; the message says what to install.
        """
        if self.render_mode is None:
            return None
        if self._camera is None:
            self._camera = Camera(self._simulation.model)
        return self._camera.picture(self._simulation.data, "front")

    def close(self) -> None:
        """Free the GL context."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _offset(self, options: dict[str, Any]) -> tuple[float, float, float]:
        unknown = sorted(set(options) - set(RESET_OPTIONS))
        if unknown:
            raise ValueError(f"options: {unknown} unknown, must be among {list(RESET_OPTIONS)}")
        # drawn in any case, so that fixing one quantity leaves the others as the seed has them
        x, y, yaw = self._protocol.draw_offset(self.np_random)
        x, y = options.get("object_offset_m", (x, y))
        yaw = options.get("object_yaw_rad", yaw)
        if not np.isfinite([x, y, yaw]).all():
            raise ValueError(f"options: offset {(x, y)} m and yaw {yaw} rad must be finite")
        return float(x), float(y), float(yaw)

    def _height_m(self) -> float:
        return float(self._simulation.data.xpos[self._body, 2]) - self._object.rest_height_m

    def _distance_m(self) -> float:
        data = self._simulation.data
        return float(np.linalg.norm(data.xpos[self._body] - data.site_xpos[self._site]))

    def _in_hand(self) -> bool:
        return self._height_m() >= LIFTED_M and self._distance_m() <= 0.15

    def _reward(self) -> float:
        reach = 1.0 - np.tanh(10.0 * self._distance_m())
        lift = 3.0 * float(np.clip(self._height_m() / LIFTED_M, 0.0, 1.0))
        return float(reach + lift + float(self._lifted_s >= HELD_S))

    def _info(self) -> dict[str, Any]:
        return {
            "is_success": self._lifted_s >= HELD_S,
            "object_height_m": self._height_m(),
            "diverged": False,
            "beyond_calibration": bool(self._simulation.range_watch.beyond()),
        }

    def _lost(self) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        low, high = observation_bounds()
        beyond = bool(self._simulation.range_watch.beyond())
        info = {"is_success": False, "object_height_m": 0.0, "diverged": True, "beyond_calibration": beyond}
        return np.clip(np.zeros_like(low), low, high), 0.0, True, False, info

    def _observation(self) -> Vector:
        simulation = self._simulation
        position, rotation = simulation.in_palm_frame(self._body)
        return pack(
            {
                "pressure_reading_kpa_gauge": simulation.reading_pa_gauge() / 1e3,
                "set_pressure_kpa_gauge": simulation.set_pressure_pa_gauge / 1e3,
                "wrist_position_m": simulation.data.qpos[simulation.index.wrist_qpos[:3]],
                "wrist_angle_rad": simulation.data.qpos[simulation.index.wrist_qpos[3:]],
                "joint_angle_rad": simulation.data.qpos[simulation.index.joint_qpos],
                "object_position_in_palm_m": position,
                "object_quaternion_in_palm": canonical_quaternion(rotation),
                "object_height_m": self._height_m(),
            }
        )


def canonical_quaternion(rotation: Vector) -> Vector:
    """Return the unit quaternion w, x, y, z with w >= 0 of a rotation matrix, shape (4,)."""
    return np.asarray(Rotation.from_matrix(rotation).as_quat(canonical=True, scalar_first=True))
