"""Gymnasium environments of the soft hand; importing this package registers them."""

import gymnasium

from envs.grasp import SoftHandGraspEnv, SoftHandGraspVectorEnv
from envs.reorient import SoftHandReorientEnv, SoftHandReorientVectorEnv

GRASP_ENV_ID = "SoftHandGrasp-v0"
"""Reach, close, lift, hold."""

REORIENT_ENV_ID = "SoftHandReorient-v0"
"""Turn a bar on the table by pressing its ends with different fingers."""

# 250 steps of 40 ms: a grasp needs about 8 s
gymnasium.register(
    id=GRASP_ENV_ID,
    entry_point="envs.grasp:SoftHandGraspEnv",
    vector_entry_point="envs.grasp:SoftHandGraspVectorEnv",
    max_episode_steps=250,
)
gymnasium.register(
    id=REORIENT_ENV_ID,
    entry_point="envs.reorient:SoftHandReorientEnv",
    vector_entry_point="envs.reorient:SoftHandReorientVectorEnv",
    max_episode_steps=250,
)

__all__ = [
    "GRASP_ENV_ID",
    "REORIENT_ENV_ID",
    "SoftHandGraspEnv",
    "SoftHandGraspVectorEnv",
    "SoftHandReorientEnv",
    "SoftHandReorientVectorEnv",
]
