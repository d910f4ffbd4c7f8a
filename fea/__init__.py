"""Offline finite-element lab: material sheet and geometry in, finger calibration out."""
