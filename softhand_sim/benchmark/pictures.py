"""One picture of each object in the hand: the trial of a seed, repeated and drawn in the middle of its hold."""

from pathlib import Path

import numpy as np

from softhand_sim.calibration import load_calibration
from softhand_sim.benchmark.runner import BenchmarkPlan
from softhand_sim.grasp.trial import TrialResult, prepare, run_trial
from softhand_sim.render import Camera, Picture, around, save_png
from softhand_sim.simulation import HandSimulation

# choice: far enough before the end that the hand has come to rest, and still within the hold
BEFORE_END_S = 1.0


def draw(plan: BenchmarkPlan, results: list[TrialResult], folder: Path) -> list[Path]:
    """Draw one picture per object into `folder` and return the files; a held trial where there is one.

    Raises
    ------
    RenderUnavailableError
        If this machine cannot draw.
    """
    calibration = load_calibration(plan.calibration)
    files = []
    for model in plan.objects:
        own = [result for result in results if result.object == model.name]
        shown = next((result for result in own if result.outcome == "HELD"), own[0])
        setup = prepare(model, calibration, protocol=plan.protocol)
        at_s = shown.simulated_s - BEFORE_END_S
        taken: list[Picture] = []
        with Camera(setup.scene.model) as camera:

            def watch(simulation: HandSimulation) -> None:
                if not taken and simulation.data.time >= at_s:  # noqa: B023 - called within this turn of the loop
                    palm = simulation.data.xpos[simulation.index.palm_body] - np.array([0, 0, 0.06])
                    taken.append(camera.picture(simulation.data, around(palm)))  # noqa: B023

            run_trial(setup, shown.seed, watch)
        if taken:
            files.append(folder / f"{model.name}.png")
            save_png(files[-1], taken[0])
    return files
