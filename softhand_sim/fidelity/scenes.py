"""Short scenes on which settings are compared: grasps of random objects, bare hands; what each shows at rest."""

import time
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt

from softhand_sim.calibration import FingerCalibration
from softhand_sim.effects import Effects
from softhand_sim.effects.auto import choose
from softhand_sim.effects.bare import BareHand
from softhand_sim.effects.scene import SceneFacts
from softhand_sim.fidelity.fidelity import Fidelity
from softhand_sim.fidelity.shapes import with_shapes
from softhand_sim.grasp.choice.shipped import default_grasp, shipped_grasps
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.trial import TrialSetup, prepare, run_trial
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]

LIFT_M, HOLD_S = 0.06, 1.0
"""Choices: as short as a trial can be that still closes for the paper protocol's time, lifts and comes to rest."""
SETTLED_S = 0.5
"""Choice: the end of the hold over which angles are averaged; the valves redraw them every 20 ms."""
BARE_SHARE = 0.25
"""Choice: one scene in four has no object."""
RATIO_RANGE = (0.8, 1.2)
"""Choice: of mass and friction, drawn evenly; a fifth either way, as far as one may be wrong about an object."""


def short_protocol() -> GraspProtocol:
    """Return the paper's protocol with a low lift and a short hold."""
    phases = (Lift(height_m=LIFT_M), Hold(duration_s=HOLD_S))
    return replace(load_protocol(), name="ladder", phases=phases)


@dataclass(frozen=True, kw_only=True)
class SceneFigures:
    """What a scene shows.

    Attributes
    ----------
    tip_angle_deg: mean of each fingertip's angle over the last ``SETTLED_S`` [deg], (5,).
    slip_m: of the object in the hand, at most the lift; 0 without one. creep_m_per_s: its drift in the hold.
    verdict: of the trial; empty without an object.
    processor_s, simulated_s: processor time of this thread, and the time that passed in the scene [s].
    """

    tip_angle_deg: Vector
    slip_m: float
    creep_m_per_s: float
    verdict: str
    processor_s: float
    simulated_s: float


@dataclass(frozen=True, kw_only=True)
class SceneError:
    """How far a run is from that of the finest setting: largest of the tips' angles [deg], slip [m], creep, verdict."""

    angle_deg: float
    slip_m: float
    creep_m_per_s: float
    flipped: bool


def error(found: SceneFigures, finest: SceneFigures) -> SceneError:
    """Compare two runs of one scene; figures that are not finite count as infinitely far."""
    angle = float(np.abs(found.tip_angle_deg - finest.tip_angle_deg).max())
    slip = abs(found.slip_m - finest.slip_m)
    return SceneError(
        angle_deg=angle if np.isfinite(angle) else np.inf,
        slip_m=slip if np.isfinite(slip) else np.inf,
        creep_m_per_s=abs(found.creep_m_per_s - finest.creep_m_per_s),
        flipped=found.verdict != finest.verdict,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class GraspScene:
    """One grasp of one object by the short protocol, its default grasp and the offset of a seed."""

    model: ObjectModel
    seed: int

    @property
    def name(self) -> str:
        """Object, mass, friction and seed."""
        return f"{self.model.name} {1e3 * self.model.mass_kg:.0f} g mu {self.model.friction:.2f} seed {self.seed}"

    def prepare(self, calibration: FingerCalibration, fidelity: Fidelity, effects: Effects | None = None) -> TrialSetup:
        """Return what is run; the grasp is that of the object's own shapes."""
        return prepare(
            with_shapes(self.model, fidelity.shapes),
            calibration,
            protocol=short_protocol(),
            engine=fidelity.engine,
            effects=fidelity.scene_effects if effects is None else effects,
            tolerance=fidelity.auto_effects,
            plan=default_grasp(self.model),
            links=fidelity.links,
        )

    def run(self, calibration: FingerCalibration, fidelity: Fidelity, effects: Effects | None = None) -> SceneFigures:
        """Run the trial; building the scene is no part of its time."""
        setup = self.prepare(calibration, fidelity, effects)
        times: list[float] = []
        rows: list[Vector] = []

        def watch(simulation: HandSimulation) -> None:
            times.append(float(simulation.data.time))
            rows.append(np.degrees(simulation.tip_angles_rad()))

        began = time.thread_time()
        result = run_trial(setup, self.seed, watch)
        took = time.thread_time() - began
        settled = np.array(times) > result.simulated_s - SETTLED_S
        return SceneFigures(
            tip_angle_deg=np.array(rows)[settled].mean(axis=0),
            slip_m=min(result.slip_m, LIFT_M),
            creep_m_per_s=result.creep_m_per_s,
            verdict=str(result.outcome),
            processor_s=took,
            simulated_s=result.simulated_s,
        )


@dataclass(frozen=True, kw_only=True)
class BareScene:
    """A hand without an object that closes and holds."""

    hand: BareHand
    seed: int

    @property
    def name(self) -> str:
        """Set angles and seed."""
        angles = ", ".join(f"{angle:.0f}" for angle in self.hand.set_angle_deg)
        return f"bare hand {angles} degrees seed {self.seed}"

    def run(self, calibration: FingerCalibration, fidelity: Fidelity, effects: Effects | None = None) -> SceneFigures:
        """Close and hold."""
        offered = fidelity.scene_effects if effects is None else effects
        if fidelity.auto_effects is not None:
            offered, _ = choose(SceneFacts.bare(self.hand, calibration, offered), fidelity.auto_effects)
        angles, took = self.hand.run(calibration, offered, self.seed, engine=fidelity.engine, links=fidelity.links)
        rows = max(1, round(len(angles) * SETTLED_S / self.hand.hold_s))
        return SceneFigures(
            tip_angle_deg=angles[-rows:].mean(axis=0),
            slip_m=0.0,
            creep_m_per_s=0.0,
            verdict="",
            processor_s=took,
            simulated_s=self.hand.close_s + self.hand.hold_s,
        )


LadderScene = GraspScene | BareScene


def firm_objects() -> tuple[str, ...]:
    """Return the catalogue's objects whose shipped grasp carries their weight: the others are lost either way."""
    return tuple(name for name, kept in shipped_grasps().grasps.items() if kept.score is not None and kept.score >= 1.0)


def draw_scenes(count: int, seed: int) -> tuple[LadderScene, ...]:
    """Draw scenes: a bare hand, or a grasp of one of `firm_objects` with mass, friction and offset drawn as well.

    Scenes of two seeds have nothing in common but the objects' shapes.
    """
    rng, scenes = np.random.default_rng(seed), list[LadderScene]()
    names, made = firm_objects(), cache(make_object)
    for _ in range(count):
        trial = int(rng.integers(1 << 30))
        if rng.random() < BARE_SHARE:
            thumb, index, rest = rng.uniform(20.0, 95.0, size=3).tolist()
            scenes.append(BareScene(hand=BareHand(set_angle_deg=(thumb, index, rest), hold_s=HOLD_S), seed=trial))
            continue
        model = made(str(rng.choice(names)))
        mass, friction = rng.uniform(*RATIO_RANGE, size=2).tolist()
        model = model.with_overrides(mass_kg=mass * model.mass_kg, friction=friction * model.friction)
        scenes.append(GraspScene(model=model, seed=trial))
    return tuple(scenes)
