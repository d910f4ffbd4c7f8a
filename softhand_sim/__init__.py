"""Runtime of softhand-sim: calibration, hand, pneumatics, control, objects, grasp trials."""

from softhand_sim.gl import choose_backend

# has to happen before anything imports mujoco or dm_control, which read the choice at import
choose_backend()
