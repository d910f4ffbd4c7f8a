"""Grasp trials: scripted grasp, protocol, metrics, verdict."""
