"""Runtime of softhand-sim: calibration, hand, pneumatics, control, objects, grasp trials."""
