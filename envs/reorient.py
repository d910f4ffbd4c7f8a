"""``SoftHandReorient-v0``: turn a bar on the table by pressing its ends with different fingers."""

from typing import Any

from gymnasium.vector import AutoresetMode

from envs.config import EnvConfig
from envs.hand_env import SoftHandEnv
from envs.randomization import Randomization
from envs.reorient_task import ReorientTask, foam_bar
from envs.vector import SoftHandVectorEnv

PLACE = Randomization(position_m=0.004, yaw_rad=0.05)
"""Choice: a bar laid by hand, to 4 mm and 3 degrees; one 10 mm further off lies out of a finger's reach."""


class SoftHandReorientEnv(SoftHandEnv):
    """Turn a bar that lies on the table to a target angle, with the fingers alone.

    The hand hovers, palm down. The index presses one end of the bar towards the palm and turns it clockwise, seen from
    above; middle, ring and little press the other end. So the three elements must act apart from one another, which a
    grasp never asks of them, and a bar pressed too far tips over.

    ## Action space: one action every 40 ms, two ticks of the valves' controller, ten steps of the engine

    As in `envs.grasp.SoftHandGraspEnv` but for the wrist: ``action_mode`` ``"pressure"`` (default), ``"angle"`` or
    ``"valve"``. By default ``wrist=False``, and the hand stands still: ``Box(-1, 1, (3,), float32)``, or
    ``MultiBinary(6)`` for valves. With ``wrist=True`` three more entries move the wrist along x, y, z; it does not
    turn: a grasp that turns the wrist would be no use of the fingers.

    | index | meaning | MJCF name | -1 | +1 (pressure) | +1 (angle) |
    |---|---|---|---|---|---|
    | 0 | thumb | `thumb_pressure` | 0 | 80 kPa gauge | 104 degrees |
    | 1 | index | `index_pressure` | 0 | 80 kPa gauge | 104 degrees |
    | 2 | middle, ring, little together | `middle_pressure` ... | 0 | 80 kPa gauge | 104 degrees |
    | 3, 4, 5 | wrist velocity along x, y, z (``wrist=True``) | `wrist_x` ... | -0.1 m/s | 0.1 m/s | 0.1 m/s |

    ## Observation space

    The fields of `envs.grasp.SoftHandGraspEnv`, and one more at the end:

    | mode | index | meaning | MJCF name | unit | range |
    |---|---|---|---|---|---|
    | ``hardware`` (16,) | 15 | target turn about the vertical, 0 along the hand | - | rad | -pi to pi |
    | ``state`` (68,), default | 67 | the same | - | rad | -pi to pi |

    ``observation_mode="goal"``: a dict with the 67 values of the state as ``observation``, and ``achieved_goal`` and
    ``desired_goal``: cosine and sine of the object's turn and of the target, (2,) each.

    ## Reward, each step

    | term in ``info`` | value |
    |---|---|
    | ``reward_align`` | 1 - tanh(e / 0.1), e the size of the turn that is missing [rad], ``info["error_rad"]`` |
    | ``reward_hold`` | 1 while the task is solved |

    The reward is their sum. In goal mode it is 0 while the turn is within 3 degrees of the target, else -1.

    ## Success, termination, truncation

    ``info["is_success"]``: the turn has been within 3 degrees of the target for 0.5 s without a break; in goal mode, it
    is there. The episode terminates when the object has tipped by more than 30 degrees, is more than 0.1 m from its
    start, or a guard fires, and in goal mode when the simulation diverges, all as in `envs.grasp.SoftHandGraspEnv`; it
    is truncated after 250 steps (10 s).

    ## Start and randomisation

    The palm stands at rest 28 mm behind the place of the object and 100 mm (or the object's height and 30 mm) above the
    table, or farther forward in steps of 1 mm where a finger would overlap the displaced object. The target is even
    within 15 degrees either way, but at least 6 degrees from the start. By default the object lies up to 4 mm and
    3 degrees off its place; the rest is as in `envs.grasp.SoftHandGraspEnv`, with the options of ``reset`` given there,
    and ``target_yaw_rad`` in place of a goal's position.

    ## Arguments

    As `envs.grasp.SoftHandGraspEnv`; ``objects`` is by default a bar of foam, 30 x 120 x 50 mm and 28 g
    (`envs.reorient_task.foam_bar`).

    ## Version history

    v0: first version. Its engine has steps of 4 ms with ten noslip iterations (`envs.config.DEFAULT_ENGINE`); before
    the first release it had a trial's 2 ms with three, ``engine=EngineSettings()``.
    """

    def __init__(self, *, render_mode: str | None = None, **config: Any) -> None:
        super().__init__(ReorientTask(), _config(config), render_mode)


class SoftHandReorientVectorEnv(SoftHandVectorEnv):
    """Many of `SoftHandReorientEnv` on the engine's threads; arguments of both it and `SoftHandVectorEnv`."""

    def __init__(
        self,
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        threads: int = 0,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        **config: Any,
    ) -> None:
        tasks = [ReorientTask() for _ in range(num_envs)]
        super().__init__(
            tasks, _config(config), max_episode_steps=max_episode_steps, threads=threads,
            autoreset_mode=autoreset_mode,
        )  # fmt: skip


def _config(given: dict[str, Any]) -> EnvConfig:
    own: dict[str, Any] = {"objects": foam_bar(), "wrist": False, "randomization": PLACE}
    return EnvConfig(**(own | given))
