"""Bench tests of the simulated finger, held against the finite elements behind it and against the paper's words."""

from softhand_sim.characterize.bench import Bench, Reading
from softhand_sim.characterize.five_fingers import PressureAngle, pressure_angle
from softhand_sim.characterize.report import Check, Curve, Panel, Report
from softhand_sim.characterize.studies import STUDIES

__all__ = ["STUDIES", "Bench", "Check", "Curve", "Panel", "PressureAngle", "Reading", "Report", "pressure_angle"]
