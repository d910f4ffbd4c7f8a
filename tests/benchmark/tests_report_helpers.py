"""A report without a simulation: three objects, one colour for every picture."""

import dataclasses
import io

from PIL import Image

from softhand_sim.benchmark.films import Film
from softhand_sim.benchmark.html_report import ReportContent
from softhand_sim.benchmark.report import wilson_interval
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import crashed
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

COLOUR = (255, 0, 255)
HELD = {"mug": 1, "apple": 4, "soup_can": 0}
TRIALS = 4


def results():
    found = []
    for name, held in HELD.items():
        for seed in range(TRIALS):
            outcome = Outcome.HELD if seed < held else Outcome.DROPPED
            blank = crashed(make_object(name), load_protocol(), seed)
            found.append(
                dataclasses.replace(blank, outcome=outcome, slip_m=1e-3 * seed, creep_m_per_s=1e-6 * (seed + 1))
            )
    return found


def moving(frames):
    """Pictures of one colour with a bar that moves, as WebP."""
    made = []
    for k in range(frames):
        picture = Image.new("RGB", (320, 240), COLOUR)
        picture.paste((0, 0, 0), (10 * k, 0, 10 * k + 10, 20))
        made.append(picture)
    out = io.BytesIO()
    made[0].save(out, format="WEBP", save_all=True, append_images=made[1:], duration=80, loop=0)
    return out.getvalue()


def sweep():
    def point(mass, held):
        low, high = wilson_interval(held, 20)
        row = {"trials": 20, "held": held, "success_rate": held / 20, "wilson_low": low, "wilson_high": high}
        return {"values": {"mass_kg": mass}, "objects": {"apple": row}}

    settings = {"axes": [{"name": "mass_kg", "values": [0.1, 0.2]}], "objects": ["apple"], "trials": 20}
    return {"settings": settings, "rows": [point(0.1, 20), point(0.2, 3)]}


def content(**changes):
    found = results()
    films = [
        Film(result=next(r for r in found if r.object == name), picture=moving(1), film=moving(3)) for name in HELD
    ]
    values = {
        "protocol": load_protocol(),
        "results": found,
        "provenance": {"versions": {"mujoco": "3.17.0"}, "effects": {"gas": "GasDynamics()"}},
        "not_tried": {"<b>wrench</b>": "no mass & no mesh"},
        "notes": {"mug": ["holes filled"]},
        "films": films,
        "sweeps": [sweep()],
        "step_check": "at a quarter of the time step 1 of 12 verdicts differ",
    }
    return ReportContent(**{**values, **changes})
