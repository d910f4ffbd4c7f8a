"""Arguments of the environments, checked together before anything is built."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from envs.actions import ActionMode, ActionSpec
from envs.draw import Drawer
from envs.episode import EpisodeSpec
from envs.observations import ObservationMode, layout_of
from envs.randomization import PRESETS as RANDOMIZATIONS
from envs.randomization import Randomization
from envs.task import Task
from envs.valves import ValveRelay
from envs.world import Scenes, SceneSettings, names_of
from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.checks import require_in
from softhand_sim.effects import FULL, PRESETS, Effects
from softhand_sim.effects.build import TICK_S
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity
from softhand_sim.guards.limits import Guards
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.uncertainty.ensemble import load_ensemble

Objects = str | ObjectModel | Sequence[str | ObjectModel]
Calibration = Path | str | FingerCalibration | None

AUTO, ENSEMBLE, DEFAULT = "auto", "ensemble", "default"
AUTO_TOLERANCE = Tolerance(angle_deg=5.0, slip_m=0.010)
"""Choice: what ``scripts/explain_scene.py`` takes by default."""
DEFAULT_ENGINE = EngineSettings(
    timestep_s=0.004, noslip_iterations=10, jacobian="sparse", islands=False, tolerance=1e-6
)
"""Choice: twice the step of a trial (`EngineSettings`) and no less accurate: bounds of 3.62 degrees and 1.45 mm over
the 208 scenes of docs/accuracy.md, where 2 ms with three noslip iterations has 3.63 and 1.56. How the solver stores its
matrices and where it ends takes 10 to 15 % off an action that explores (docs/decisions.md)."""
ARM_M = 0.1
"""Choice: the wrist turns as fast as it moves at this arm, as in `HandAnatomy`."""
ENERGY_J, PAPERS_SPEED_M_PER_S = 0.1, 0.1
"""Choice: energy from nowhere [J] that is allowed to a wrist at that speed (paper), and more by the speed's square. Its
force swings within the time between two looks, which the energy book's rule does not foresee: random actions every
40 ms leave up to 29 mJ in ten seconds, and once 56 with a finger bent backward on the table (220 episodes of three
objects); without the wrist it is 0.3 mJ."""


@dataclass(frozen=True, kw_only=True)
class EnvConfig:
    """Arguments that all environments have.

    Attributes
    ----------
    objects
        A catalogue name or an `ObjectModel` (of `load_mesh_object`, say), or several; one is drawn an episode.
    action_mode
        ``pressure``, ``angle`` or ``valve``.
    wrist
        Whether actions move the wrist; else it goes the task's own way.
    wrist_speed_m_per_s
        Its largest speed [m/s], at most 0.5 (paper: 0.1); it turns by as much at an arm of 0.1 m.
    observation_mode
        ``hardware``, ``state`` or ``goal``.
    camera
        Height and width of a picture in the observation [pixels]; None for none.
    randomization
        ``none``, ``place``, ``domain``, or a `Randomization`, or a mapping of some of its fields.
    effects, tolerance
        ``ideal``, ``bench``, ``full``, `Effects`, or ``auto``: all effects but those that each scene does not call for,
        by a `Tolerance`. A tolerance without an ``engine`` also picks that, the cheapest measured one within half of
        it (`Fidelity.for_tolerance`); the effects that are left out have the other half. ``info`` of a reset tells.
    engine
        Time step and solver; None for what a tolerance picks, without one `DEFAULT_ENGINE`.
    calibrations
        Finger calibrations (material pairs), as paths or loaded, None for the shipped one; one is drawn an episode.
        ``ensemble``: the shipped one and the members of the shipped ensemble (`softhand_sim.uncertainty`).
        The controller's table and the highest set pressure are those of the first: it does not know the draw.
    control_period_s
        Time of one action [s]: a whole number of the controller's 20 ms.
    guards
        What ends an episode whose simulation can't be trusted, with ``info["outcome"]``: limits as a trial has them
        (`softhand_sim.guards.limits.Guards`), None for divergence alone. ``default``: a trial's, but for more energy
        where the wrist moves as actions say (`ENERGY_J`).

    Raises
    ------
    ValueError
        If an argument is unknown or out of range; the message names it.
    """

    objects: Objects = "apple"
    action_mode: str = "pressure"
    wrist: bool = True
    wrist_speed_m_per_s: float = 0.1
    observation_mode: str = "state"
    camera: tuple[int, int] | None = None
    randomization: str | Randomization | Mapping[str, Any] = "place"
    effects: str | Effects = "bench"
    tolerance: Tolerance | None = None
    engine: EngineSettings | None = None
    calibrations: Calibration | Sequence[Calibration] = None
    control_period_s: float = 0.04
    guards: str | Guards | None = DEFAULT

    def __post_init__(self) -> None:
        _ = self.ranges, self.limits
        _one_of("action_mode", self.action_mode, tuple(ActionMode))
        _one_of("observation_mode", self.observation_mode, tuple(ObservationMode))
        require_in("wrist_speed_m_per_s", self.wrist_speed_m_per_s, 1e-3, 0.5)
        require_in("control_period_s", self.control_period_s, TICK_S, 1.0)
        for name, period in (("controller's period", TICK_S), ("engine's time step", self._engine.timestep_s)):
            if not math.isclose(self.control_period_s / period, round(self.control_period_s / period), abs_tol=1e-6):
                raise ValueError(
                    f"control_period_s = {self.control_period_s}: must be a multiple of the {name} {period}"
                )
        if self.camera is not None and not (
            len(self.camera) == 2 and all(isinstance(n, int) and 1 <= n <= 960 for n in self.camera)
        ):
            raise ValueError(f"camera = {self.camera!r}: must be None or height and width from 1 to 960")
        if self._effects.gas is None and (self.action_mode == ActionMode.VALVE or self.ranges.of_gas):
            raise ValueError(f"effects = {self.effects!r}: valves, leaks and sensors need gas dynamics")

    @property
    def mode(self) -> ObservationMode:
        """The observation mode."""
        return ObservationMode(self.observation_mode)

    @property
    def fidelity(self) -> Fidelity | None:
        """What the tolerance picked; None without a tolerance, or with an engine of one's own."""
        if self.tolerance is None or self.engine is not None:
            return None
        return Fidelity.within(self.tolerance, effects_too=True)

    @property
    def _engine(self) -> EngineSettings:
        picked = self.fidelity
        return self.engine or (DEFAULT_ENGINE if picked is None else picked.engine)

    @property
    def _effects(self) -> Effects:
        if isinstance(self.effects, Effects):
            return self.effects
        _one_of("effects", self.effects, (*PRESETS, AUTO))
        return FULL if self.effects == AUTO else PRESETS[self.effects]

    @property
    def ranges(self) -> Randomization:
        """The ranges of what is drawn."""
        if isinstance(self.randomization, Randomization):
            return self.randomization
        if isinstance(self.randomization, Mapping):
            return Randomization.from_fields(self.randomization)
        _one_of("randomization", self.randomization, tuple(RANDOMIZATIONS))
        return RANDOMIZATIONS[self.randomization]

    @property
    def limits(self) -> Guards | None:
        """The guards' limits."""
        if self.guards is None or isinstance(self.guards, Guards):
            return self.guards
        _one_of("guards", self.guards, (DEFAULT,))
        if not self.wrist:
            return Guards()
        return Guards(energy_j=ENERGY_J * max(1.0, self.wrist_speed_m_per_s / PAPERS_SPEED_M_PER_S) ** 2)

    def scenes(self) -> Scenes:
        """Return the scenes; nothing is compiled yet.

        Raises
        ------
        ValueError
            If the catalogue has no such object, two share a name, or there is no calibration.
        FileNotFoundError
            If there is no such calibration file.
        """
        given = [self.objects] if isinstance(self.objects, str | ObjectModel) else list(self.objects)
        objects = tuple(make_object(o) if isinstance(o, str) else o for o in given)
        names_of(objects)
        wanted = _all_of(self.calibrations)
        if not wanted:
            raise ValueError("calibrations = []: must be one or more")
        picked = self.fidelity
        tolerance = self.tolerance if picked is None else picked.auto_effects
        if tolerance is None and self.effects == AUTO:
            tolerance = AUTO_TOLERANCE
        speed = self.wrist_speed_m_per_s
        return Scenes(
            SceneSettings(
                objects=objects,
                calibrations=tuple(_loaded(c) for c in wanted),
                effects=self._effects,
                tolerance=tolerance,
                engine=self._engine,
                controller=ValveRelay() if self.action_mode == ActionMode.VALVE else None,
                anatomy=HandAnatomy(wrist_speed_m_per_s=speed, wrist_rate_rad_per_s=speed / ARM_M),
            )
        )

    def spec(self, scenes: Scenes, task: Task) -> EpisodeSpec:
        """Return what an episode of a task is made from."""
        settings = scenes.settings
        action = ActionSpec.of(
            settings.calibrations[0],
            ActionMode(self.action_mode),
            wrist_axes=task.wrist_axes if self.wrist else 0,
            speed_m_per_s=settings.anatomy.wrist_speed_m_per_s,
            rate=settings.anatomy.wrist_rate_rad_per_s,
        )
        return EpisodeSpec(
            action=action,
            layout=layout_of(self.mode, task.target),
            drawer=Drawer(ranges=self.ranges, objects=len(settings.objects), calibrations=len(settings.calibrations)),
            names=names_of(settings.objects),
            control_period_s=self.control_period_s,
            sparse=self.mode is ObservationMode.GOAL,
            has_gas=settings.effects.gas is not None,
            guards=self.limits,
            fidelity=self.fidelity,
        )


def _one_of(name: str, value: object, allowed: Sequence[str]) -> None:
    if value not in allowed:
        raise ValueError(f"{name} = {value!r}: must be one of {', '.join(allowed)}")


def _all_of(calibrations: Calibration | Sequence[Calibration]) -> list[Calibration]:
    if calibrations == ENSEMBLE:
        solved = [member for source in load_ensemble().sources for member in source.solved]
        return [None, *(member.calibration for member in solved)]
    if calibrations is None or isinstance(calibrations, Path | str | FingerCalibration):
        return [calibrations]
    return list(calibrations)


def _loaded(calibration: Calibration) -> FingerCalibration:
    if isinstance(calibration, FingerCalibration):
        return calibration
    return load_calibration(None if calibration is None else Path(calibration))
