"""Gymnasium environments of the soft hand; importing this package registers them."""

import gymnasium

# 200 steps of 50 ms: the scripted grasp needs about 8 s
gymnasium.register(id="SoftHandGrasp-v0", entry_point="envs.grasp:SoftHandGraspEnv", max_episode_steps=200)

GRASP_ENV_ID = "SoftHandGrasp-v0"
