"""How cost grows with the finite elements' unknowns, a finger's links, contacts and worlds: exponents of power laws."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import mujoco
import numpy as np

from scripts.accuracy_fea import read_runs
from softhand_sim.batch import HandBatch
from softhand_sim.calibration import FingerCalibration
from softhand_sim.contact import ContactSettings
from softhand_sim.hand.hand import WRIST
from softhand_sim.hand.scene import EngineSettings, build_root, compile_scene, empty_root
from softhand_sim.simulation import HandSimulation, default_pneumatics

LINKS, CONTACTS, WORLDS = (6, 12, 24, 48), (4, 8, 16, 32, 64), (1, 4, 16, 64)
STEPS = 250
PRESSURE_PA_GAUGE = 40e3
Row = dict[str, Any]


def growth(calibration: FingerCalibration, fea_file: Path, repeats: int, tick: Callable[[], None]) -> list[Row]:
    """Return a row a quantity: sizes, processor time of each [s], exponent and its standard error."""
    rows = []
    runs = [run for run in read_runs(fea_file) if run["test"] == "free" and run["status"] == "converged"]
    for kind in ("P1", "P2"):
        of_kind = sorted(
            (run["dofs"], run["processor_s"] / run["newton_iterations"]) for run in runs if run["formulation"] == kind
        )
        if len(of_kind) > 1:
            sizes, times = zip(*of_kind, strict=True)
            rows.append(
                _row(f"finite elements {kind}: an iteration against unknowns", sizes, times, "scripts/accuracy_fea.py")
            )
    for name, sizes, job in (
        ("a hand's step against links a finger", LINKS, lambda n: _hand(calibration, n)),
        ("a body's step against contacts", CONTACTS, _contacts),
        ("a batch's step against worlds", WORLDS, lambda n: _worlds(calibration, n)),
    ):
        steppers = [job(n) for n in sizes]
        spent: list[list[float]] = [[] for _ in sizes]
        # interleaved: other work on the machine disturbs all sizes alike
        for _ in range(repeats):
            for k, step in enumerate(steppers):
                began = time.process_time()
                step()
                spent[k].append((time.process_time() - began) / STEPS)
        rows.append(_row(name, sizes, [median(s) for s in spent], "scripts/accuracy_vs_time.py growth"))
        tick()
    return rows


def _row(name: str, sizes: Sequence[float], times: Sequence[float], command: str) -> Row:
    """Fit log t = a + n log N by least squares; the standard error is that of the slope, 0 for two points."""
    x, y = np.log(np.asarray(sizes, dtype=np.float64)), np.log(np.asarray(times, dtype=np.float64))
    slope, level = np.polyfit(x, y, 1)
    left = y - slope * x - level
    spread = float(np.sqrt((left @ left) / max(1, len(x) - 2) / ((x - x.mean()) @ (x - x.mean()))))
    return {
        "name": name,
        "size": list(sizes),
        "processor_s": list(times),
        "exponent": float(slope),
        "exponent_standard_error": spread,
        "command": command,
    }


def _hand(calibration: FingerCalibration, links: int) -> Callable[[], None]:
    model = compile_scene(build_root(calibration, links=links)).model
    simulation = HandSimulation(model=model, calibration=calibration, pneumatics=default_pneumatics(calibration))
    simulation.reset(np.random.default_rng(0), np.zeros(len(WRIST)))
    simulation.set_pressure_pa_gauge = np.full(3, PRESSURE_PA_GAUGE)
    return lambda: simulation.advance(STEPS)


def _contacts(count: int) -> Callable[[], None]:
    """Return the step of a plate on small spheres on a plane, with the hand's contact and engine settings."""
    root = empty_root("plate", EngineSettings())
    settings = ContactSettings()
    touch = {"condim": settings.condim, "solref": settings.solref, "friction": settings.friction(settings.pad_friction)}
    root.worldbody.add("geom", name="floor", type="plane", size=(1, 1, 0.1), **touch)
    body = root.worldbody.add("body", name="plate", pos=(0, 0, 0.005))
    body.add("freejoint")
    body.add("inertial", mass=0.1, pos=(0, 0, 0.01), diaginertia=(1e-4, 1e-4, 1e-4))
    for k in range(count):
        turn = 2.0 * np.pi * k / count
        body.add(
            "geom", type="sphere", size=(0.005,), pos=(0.05 * np.cos(turn), 0.05 * np.sin(turn), 0.0), mass=0.0, **touch
        )
    model = compile_scene(root).model
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, STEPS)
    if data.ncon != count:
        raise RuntimeError(f"{data.ncon} contacts instead of {count}")
    return lambda: mujoco.mj_step(model, data, STEPS)


def _worlds(calibration: FingerCalibration, worlds: int) -> Callable[[], None]:
    model = compile_scene(build_root(calibration)).model
    batch = HandBatch(
        model=model, calibration=calibration, pneumatics=default_pneumatics(calibration), worlds=worlds, threads=1
    )
    batch.reset(range(worlds), [np.random.default_rng(k) for k in range(worlds)], np.zeros(len(WRIST)))
    batch.set_pressure_pa_gauge[:] = PRESSURE_PA_GAUGE

    def step() -> None:
        for _ in range(STEPS):
            batch.step()

    return step
