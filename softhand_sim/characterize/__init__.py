"""Bench tests of the simulated finger and of its pressure control, held against the paper's words."""

from softhand_sim.characterize.pressure_angle import PressureAngle, pressure_angle

__all__ = ["PressureAngle", "pressure_angle"]
