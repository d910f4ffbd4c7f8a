"""``SoftHandGrasp-v0``: reach, close, lift, hold."""

from typing import Any

from gymnasium.vector import AutoresetMode

from envs.config import EnvConfig
from envs.grasp_task import GraspTask
from envs.hand_env import SoftHandEnv
from envs.vector import SoftHandVectorEnv


class SoftHandGraspEnv(SoftHandEnv):
    """Grasp an object that stands on a table, lift it and hold it.

    ## Action space: one action every 40 ms, two ticks of the valves' controller, ten steps of the engine

    ``action_mode="pressure"`` (default) or ``"angle"``: ``Box(-1, 1, (9,), float32)``, or ``(3,)`` with
    ``wrist=False``.

    | index | meaning | MJCF name | -1 | +1 (pressure) | +1 (angle) |
    |---|---|---|---|---|---|
    | 0 | thumb | `thumb_pressure` | 0 | 80 kPa gauge | 104 degrees |
    | 1 | index | `index_pressure` | 0 | 80 kPa gauge | 104 degrees |
    | 2 | middle, ring, little together | `middle_pressure` ... | 0 | 80 kPa gauge | 104 degrees |
    | 3, 4, 5 | wrist velocity along x, y, z | `wrist_x`, `wrist_y`, `wrist_z` | -0.1 m/s | 0.1 m/s | 0.1 m/s |
    | 6, 7, 8 | turning rate in yaw, pitch, roll | `wrist_yaw` ... | -1 rad/s | 1 rad/s | 1 rad/s |

    Both are set values of the ON-OFF controller, which switches the valves at 50 Hz; an angle is turned to a
    pressure by the controller's table. Upper ends are those of the finger calibration's curve (the first
    calibration's, if there are several). The wrist's path is limited to ``wrist_speed_m_per_s`` in all.

    ``action_mode="valve"``: the six valves themselves, ``MultiBinary(6)`` with ``wrist=False``; else ``Box(-1, 1,
    (12,), float32)``, where a valve is open while its value is above 0.

    | index | meaning | |
    |---|---|---|
    | 0, 1 | inlet, outlet of the thumb | open or shut from the next tick on |
    | 2, 3 | inlet, outlet of the index | |
    | 4, 5 | inlet, outlet of middle, ring, little | |
    | 6 - 11 | wrist, as 3 - 8 above | |

    Nothing then keeps a pressure from rising to the supply's 150 kPa; a finger is pushed by at most its calibrated
    80 kPa, and ``info["beyond_calibration"]`` tells. With ``wrist=False`` the wrist goes the paper protocol's way:
    50 mm to the object, a stop of 2.8 s in which the fingers may close, 150 mm up, and stays.

    ## Observation space

    ``observation_mode="state"`` (default): ``Box(67,)``; ``"hardware"``: its first 15; float64, clipped to the
    bounds.

    | index | meaning | MJCF name | unit | range |
    |---|---|---|---|---|
    | 0 - 2 | sensor reading of each element, quantised, of the last tick | - | kPa gauge | -82 to 150 |
    | 3 - 8 | valve open: inlet and outlet of each element | - | 1 | 0 or 1 |
    | 9 - 11 | wrist position x, y, z | `wrist_x` ... | m | -1 to 1 |
    | 12 - 14 | wrist yaw, pitch, roll | `wrist_yaw` ... | rad | -4.5 to 4.5 |
    | 15 - 17 | set pressure of each element (in valve mode a code over 1000) | - | kPa gauge | 0 to 150 |
    | 18 - 20 | true pressure of each element at its sensor | - | kPa gauge | -101 to 150 |
    | 21 - 35 | joint angles, thumb to little, proximal to distal each | `thumb_proximal` ... | rad | -2 to 3 |
    | 36 - 50 | joint velocities, likewise | `thumb_proximal` ... | rad/s | -100 to 100 |
    | 51 - 53 | object's mass centre in the palm's frame | `object` | m | -3 to 3 |
    | 54 - 57 | object's orientation in the palm's frame, quaternion w, x, y, z with w >= 0 | `object` | 1 | -1 to 1 |
    | 58 - 60 | object's velocity in the world | `object_joint` | m/s | -10 to 10 |
    | 61 - 63 | object's angular velocity in its own frame | `object_joint` | rad/s | -100 to 100 |
    | 64 | object's height above its rest on the table | `object` | m | -3 to 3 |
    | 65, 66 | object's mass; its friction coefficient | `object` | kg; 1 | 0 to 100; 0 to 10 |

    The real hand and arm have sensors for 0 - 14 alone. Elements are thumb; index; middle + ring + little.

    ``observation_mode="goal"``: a dict with the 67 values as ``observation``, and ``achieved_goal`` and
    ``desired_goal``: the object's position and the one wanted [m], (3,) each, for hindsight (`compute_reward`).
    ``camera=(h, w)`` adds a picture ``camera``, uint8 (h, w, 3), from MJCF camera `front`, and makes a dict of the
    other modes too.

    ## Reward, each step

    | term in ``info`` | value |
    |---|---|
    | ``reward_reach`` | 1 - tanh(10 d), d the distance [m] from the object's centre to the site `grasp` |
    | ``reward_touch`` | 0.25 while thumb or palm touch the object, and 0.25 while another finger does |
    | ``reward_lift`` | 3 clip(h / 0.1, 0, 1), h the object's height [m] |
    | ``reward_hold`` | 1 while the task is solved |

    The reward is their sum; the weights are choices. In goal mode it is 0 while the object is within 20 mm of the
    goal, else -1; the goal lies 50 to 150 mm above the object's place and up to 50 mm beside it along x and y.

    ## Success, termination, truncation

    ``info["is_success"]``: the object has been at least 0.1 m above its rest for 1 s without a break, with its
    centre within 0.15 m of `grasp`; in goal mode, it is at the goal. The episode terminates when the object is more
    than 0.5 m from its start, or when the simulation can't be trusted any more, as ``info["outcome"]`` tells by name,
    which is empty else, and ``info["alarm"]`` with figures:

    | ``outcome`` | by default |
    |---|---|
    | ``DIVERGED`` | not finite, or the engine says so; also ``info["diverged"]``; the observation is then zero |
    | ``UNBALANCED`` | 100 mJ of energy from nowhere (10 mJ with ``wrist=False``) |
    | ``PENETRATED`` | the object in anything, or a finger in another, by 5 mm |
    | ``EXTRAPOLATED`` | a joint 0.5 rad past its stop, or a pressure 10 kPa past the calibrated one (bare valves!) |

    Guards look every 40 ms at the latest, and ``guards`` changes their limits. In goal mode nothing but divergence ends
    an episode: with -1 a step, an early end would be a reward. It is truncated after 250 steps (10 s).
    ``info["engine_warnings"]`` holds the engine's warnings by name, with their number.

    ## Start and randomisation

    The hand stands open 50 mm before the default grasp of the object as it would lie without displacement, or farther
    back in steps of 10 mm where it would overlap the displaced one.

    | quantity | ``place`` (default) | ``domain`` | option of ``reset`` that fixes it |
    |---|---|---|---|
    | object | any of ``objects`` | same | ``object``: name |
    | material pair (finger) | any of ``calibrations`` | same | ``calibration``: index |
    | object's displacement x, y | 10 mm each | same | ``object_offset_m``: (x, y) |
    | object's turn | 10 degrees | same | ``object_yaw_rad`` |
    | object's mass | its own | 0.8 to 1.25 of it | ``mass_kg`` |
    | object's friction | its own | 0.5 to 1 | ``friction`` |
    | leak of one finger | none | in a tenth of the episodes | ``leak``: None or finger and sonic conductance |
    | valves' flow | their own | half to twice | ``valve_flow_ratio`` |
    | sensors' error | none | +-3.45 kPa | ``sensor_offset_pa`` |
    | goal | see above | same | ``goal_position_m``: (x, y, z) |

    ``randomization="none"`` leaves all as it is; an `envs.randomization.Randomization` sets ranges. ``info`` of
    ``reset`` tells what was drawn. Everything comes from the seed: equal seeds give equal episodes, bit for bit, in
    any process.

    ## Arguments

    ``render_mode`` (None, ``human``, ``rgb_array``, ``depth_array``), ``approach_m`` (distance of the start from the
    grasp [m], 0.05 by default; 0.13 is clear of objects that lie 30 mm off) and those of `envs.config.EnvConfig`, all
    keywords: ``objects``, ``action_mode``, ``wrist``, ``wrist_speed_m_per_s``, ``observation_mode``, ``camera``,
    ``randomization``, ``effects``, ``tolerance``, ``engine``, ``calibrations``, ``control_period_s``, ``guards``.

    ## Version history

    v0: first version. Its engine has steps of 4 ms with ten noslip iterations (`envs.config.DEFAULT_ENGINE`); before
    the first release it had a trial's 2 ms with three, ``engine=EngineSettings()``.
    """

    def __init__(self, *, render_mode: str | None = None, approach_m: float | None = None, **config: Any) -> None:
        super().__init__(GraspTask(approach_m=approach_m), EnvConfig(**config), render_mode)


class SoftHandGraspVectorEnv(SoftHandVectorEnv):
    """Many of `SoftHandGraspEnv` on the engine's threads; arguments of both it and `SoftHandVectorEnv`."""

    def __init__(
        self,
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        threads: int = 0,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        approach_m: float | None = None,
        **config: Any,
    ) -> None:
        tasks = [GraspTask(approach_m=approach_m) for _ in range(num_envs)]
        super().__init__(
            tasks, EnvConfig(**config), max_episode_steps=max_episode_steps, threads=threads,
            autoreset_mode=autoreset_mode,
        )  # fmt: skip
