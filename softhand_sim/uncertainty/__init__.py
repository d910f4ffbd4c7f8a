"""How far the finger's calibration can be off, and what that means for stiffness, angle, tip force and grasps."""

from softhand_sim.uncertainty.bands import Band, combined_band, scenario_band, tolerance_band
from softhand_sim.uncertainty.blend import blended, drawn_coordinates
from softhand_sim.uncertainty.ensemble import Ensemble, Member, Source, load_ensemble
from softhand_sim.uncertainty.figures import FingerFigures, measure
from softhand_sim.uncertainty.grasps import GraspRow, UncertaintyPlan, grasp_rows
from softhand_sim.uncertainty.success import SuccessBand, success_band, success_interval

__all__ = [
    "Band",
    "Ensemble",
    "FingerFigures",
    "GraspRow",
    "Member",
    "Source",
    "SuccessBand",
    "UncertaintyPlan",
    "blended",
    "combined_band",
    "drawn_coordinates",
    "grasp_rows",
    "load_ensemble",
    "measure",
    "scenario_band",
    "success_band",
    "success_interval",
    "tolerance_band",
]
