"""A picture of each object at the verdict and a short film of the trial, small enough to put in a web page."""

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from PIL import Image

from softhand_sim.benchmark.pictures import shown_trial
from softhand_sim.benchmark.plan import BenchmarkPlan, prepare_for
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.trial import run_trial
from softhand_sim.render import Camera, Picture, around
from softhand_sim.simulation import HandSimulation

FRAME_S = 0.16
"""Choice: simulated time from one frame to the next; some 50 frames a trial of the paper's protocol."""
SPEED = 2.0
"""Choice: films run at twice the speed of the trial."""
SIZE = (320, 240)
QUALITY = 60


@dataclass(frozen=True, kw_only=True)
class Film:
    """One trial in pictures, both WebP: `picture` at its end, `film` of the whole."""

    result: TrialResult
    picture: bytes
    film: bytes


def film_all(plan: BenchmarkPlan, results: Sequence[TrialResult]) -> Iterator[Film]:
    """Run a trial of each object once more and film it: a held one where there is one, none where all crashed.

    Raises
    ------
    RenderUnavailableError
        If this machine cannot draw.
    """
    for model in plan.objects:
        shown = shown_trial(results, model.name)
        if shown is None:
            continue
        setup = prepare_for(plan, model)
        frames, end_s = list[Picture](), shown.simulated_s
        with Camera(setup.scene.model, width=SIZE[0], height=SIZE[1]) as camera:

            def watch(simulation: HandSimulation) -> None:
                last = simulation.data.time >= end_s - 1e-6  # noqa: B023 - called within this turn of the loop
                if last or simulation.data.time >= FRAME_S * len(frames):  # noqa: B023
                    view = around(simulation.data.site("grasp").xpos)
                    frames.append(camera.picture(simulation.data, view))  # noqa: B023

            run_trial(setup, shown.seed, watch)
        if not frames:  # it diverged at once
            continue
        yield Film(result=shown, picture=_webp(frames[-1:]), film=_webp(frames))


def _webp(frames: Sequence[Picture]) -> bytes:
    first, *rest = [Image.fromarray(frame) for frame in frames]
    out = io.BytesIO()
    duration_ms = round(1e3 * FRAME_S / SPEED)
    first.save(out, format="WEBP", save_all=True, append_images=rest, duration=duration_ms, loop=0, quality=QUALITY)
    return out.getvalue()
