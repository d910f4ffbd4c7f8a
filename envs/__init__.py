"""Gymnasium environments of the soft hand; importing this package registers them."""

import gymnasium

from envs.grasp import SoftHandGraspEnv

GRASP_ENV_ID = "SoftHandGrasp-v0"
"""Reach, close, lift, hold."""

# 250 steps of 40 ms: the scripted grasp needs about 8 s
gymnasium.register(id=GRASP_ENV_ID, entry_point="envs.grasp:SoftHandGraspEnv", max_episode_steps=250)

__all__ = ["GRASP_ENV_ID", "SoftHandGraspEnv"]
