"""One picture of each object in the hand: the trial of a seed, repeated and drawn in the middle of its hold."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from softhand_sim.benchmark.plan import BenchmarkPlan, prepare_for
from softhand_sim.benchmark.sheet import sheet
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.trial import run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.render import Camera, Picture, around, save_png
from softhand_sim.simulation import HandSimulation

# choice: far enough before the end that the hand has come to rest, and still within the hold
BEFORE_END_S = 1.0
# on the sheet of all objects, at half size
COLUMNS = 3


def shown_trial(results: Sequence[TrialResult], name: str) -> TrialResult | None:
    """Return the trial of an object that stands for all: the first held one, or the first.

    None if all have crashed: one that killed its process twice is not run again in this one.
    """
    own = [result for result in results if result.object == name and result.outcome is not Outcome.CRASHED]
    return next((result for result in own if result.outcome is Outcome.HELD), own[0] if own else None)


def draw(plan: BenchmarkPlan, results: list[TrialResult], folder: Path) -> list[Path]:
    """Draw one picture per object into `folder`, and all of them on one sheet; return the files.

    A held trial is drawn where there is one.

    Raises
    ------
    RenderUnavailableError
        If this machine cannot draw.
    """
    files = []
    for model in plan.objects:
        shown = shown_trial(results, model.name)
        if shown is None:
            continue
        setup = prepare_for(plan, model)
        at_s = shown.simulated_s - BEFORE_END_S
        taken: list[Picture] = []
        with Camera(setup.scene.model) as camera:

            def watch(simulation: HandSimulation) -> None:
                if not taken and simulation.data.time >= at_s:  # noqa: B023 - called within this turn of the loop
                    centre = simulation.data.site("grasp").xpos
                    taken.append(camera.picture(simulation.data, around(centre)))  # noqa: B023

            run_trial(setup, shown.seed, watch)
        if taken:
            files.append(folder / f"{model.name}.png")
            save_png(files[-1], taken[0])
    if len(files) > 1:
        files.append(folder / "all.png")
        save_png(files[-1], sheet([np.asarray(Image.open(file))[::2, ::2] for file in files[:-1]], COLUMNS))
    return files
