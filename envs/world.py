"""Compiled scenes of an environment's objects and fingers, and the simulation that runs in them."""

from collections import OrderedDict
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from envs.draw import Draw
from softhand_sim.calibration import JOINTS, FingerCalibration
from softhand_sim.contact import ContactSettings
from softhand_sim.control.protocol import Controller
from softhand_sim.effects import Effects
from softhand_sim.effects.auto import choose
from softhand_sim.effects.build import apply_to_contacts, apply_to_model, build_losses, build_pneumatics
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.elements import FINGERS
from softhand_sim.grasp.contacts import IN_HAND, PALM, ContactMap
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.scene import EngineSettings, build_scene
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]

MOST_SCENES = 64
"""Compiled scenes, and idle worlds, that are kept. Choice: all objects of the catalogue with one finger fit in."""
THUMB_OR_PALM, OTHER_FINGERS = 1 | 1 << PALM, (1 << PALM) - 2
"""Bits of `World.touching`."""


@dataclass(frozen=True, kw_only=True)
class SceneSettings:
    """What all scenes of an environment share.

    Attributes
    ----------
    objects, calibrations
        What may lie there, and the fingers (material pairs) that the hand may have.
    effects, tolerance
        Effects of every scene; with a tolerance each scene leaves out what it does not call for.
    engine
        Time step and solver.
    controller
        Law of the valves; None: the ON-OFF law.
    anatomy
        The wrist's speed stands there.
    """

    objects: tuple[ObjectModel, ...]
    calibrations: tuple[FingerCalibration, ...]
    effects: Effects
    tolerance: Tolerance | None
    engine: EngineSettings
    controller: Controller | None
    anatomy: HandAnatomy


@dataclass(kw_only=True)
class World:
    """One scene, its simulation, and where things are in it. The model is the world's own: draws are written to it."""

    index: tuple[int, int]
    settings: SceneSettings
    model: mujoco.MjModel
    effects: Effects
    simulation: HandSimulation = field(init=False)
    _drawn: tuple[object, ...] = field(init=False)

    def __post_init__(self) -> None:
        self.object = self.settings.objects[self.index[0]]
        self.calibration = self.settings.calibrations[self.index[1]]
        self.rest_height_m = self.object.rest_height_m
        self.body = int(self.model.body("object").id)
        self.grasp_site = int(self.model.site("grasp").id)
        self.object_qpos = int(self.model.joint("object_joint").qposadr[0])
        self.contacts = ContactMap.of(self.model)
        # one look-up for all contacts: a bit for the finger, or the palm, in a contact of hand and object
        members = np.maximum(self.contacts.member[:, None], self.contacts.member)
        self._touch = np.where(self.contacts.kind == IN_HAND, 1 << np.maximum(members, 0), 0)
        self._geoms = np.flatnonzero((self.model.geom_bodyid == self.body) & (self.model.geom_contype != 0))
        mine = np.isin(self.model.pair_geom1, self._geoms) | np.isin(self.model.pair_geom2, self._geoms)
        self._pairs = np.flatnonzero(mine)
        self._inertia = self.model.body_inertia[self.body] / self.object.mass_kg
        self.simulation = self._simulate(self.effects)
        index, free = self.simulation.index, int(self.model.joint("object_joint").dofadr[0])
        self.wrist_and_joint_qpos = np.concatenate([index.wrist_qpos, index.joint_qpos.ravel()])
        joints = [self.model.joint(f"{f}_{j}").dofadr[0] for f in FINGERS for j in JOINTS]
        self.joint_and_object_dof = np.array([*joints, *range(free, free + 6)])
        self._drawn = self._gas_of(Draw())

    def _simulate(self, effects: Effects) -> HandSimulation:
        return HandSimulation(
            model=self.model,
            calibration=self.calibration,
            pneumatics=build_pneumatics(effects, self.calibration, self.settings.controller),
            anatomy=self.settings.anatomy,
            losses=build_losses(effects, self.calibration),
        )

    @staticmethod
    def _gas_of(draw: Draw) -> tuple[object, ...]:
        return draw.leak, draw.valve_flow_ratio, draw.sensor_offset_pa

    def mass_kg(self, draw: Draw) -> float:
        """Return the object's mass in an episode [kg]."""
        return self.object.mass_kg * draw.mass_ratio if draw.mass_kg is None else draw.mass_kg

    def friction(self, draw: Draw) -> float:
        """Return the object's friction coefficient in an episode."""
        return self.object.friction if draw.friction is None else draw.friction

    def apply(self, draw: Draw) -> None:
        """Take over an episode's mass, friction, leak, valves and sensors; the simulation wants a reset after it."""
        model, mass = self.model, self.mass_kg(draw)
        if mass != model.body_mass[self.body]:
            model.body_mass[self.body] = mass
            model.body_inertia[self.body] = mass * self._inertia
            # a data of its own: what follows from the masses is computed in the reference pose
            mujoco.mj_setConst(model, mujoco.MjData(model))
        sliding, torsion, rolling = ContactSettings().friction(self.friction(draw))
        model.geom_friction[self._geoms] = (sliding, torsion, rolling)
        # soft pads have pairs of their own; their stiffness stays that for the object's own mass
        model.pair_friction[self._pairs] = (sliding, sliding, torsion, rolling, rolling)
        if self._gas_of(draw) != self._drawn:
            self.simulation = self._simulate(draw.on(self.effects))
            self._drawn = self._gas_of(draw)

    def touching(self) -> int:
        """Return a bit for each finger that touches the object, thumb first, and one for the palm."""
        data = self.simulation.data
        if not data.ncon:
            return 0
        first, second = data.contact.geom.T
        return int(np.bitwise_or.reduce(self._touch[first, second]))


class Scenes:
    """Compiles scenes as they are first wanted, and keeps the latest; worlds get copies of them."""

    def __init__(self, settings: SceneSettings) -> None:
        self.settings = settings
        self._compiled: OrderedDict[tuple[int, int], tuple[mujoco.MjModel, Effects]] = OrderedDict()

    def world(self, index: tuple[int, int]) -> World:
        """Return a new world of an object and a calibration, by their indices."""
        if index not in self._compiled:
            self._compiled[index] = self._compile(index)
            if len(self._compiled) > MOST_SCENES:
                self._compiled.popitem(last=False)
        self._compiled.move_to_end(index)
        model, effects = self._compiled[index]
        return World(index=index, settings=self.settings, model=copy(model), effects=effects)

    def _compile(self, index: tuple[int, int]) -> tuple[mujoco.MjModel, Effects]:
        s = self.settings
        model, calibration, effects = s.objects[index[0]], s.calibrations[index[1]], s.effects
        if s.tolerance is not None:
            effects, _ = choose(SceneFacts.of(model, calibration, effects), s.tolerance)

        def add_object(root: Any) -> None:
            apply_to_model(effects, root)
            attach_object(root, model, first=True)
            apply_to_contacts(effects, root)

        return build_scene(calibration, engine=s.engine, add_object=add_object).model, effects


class WorldPool:
    """Worlds of environments that share scenes: each belongs to one episode at a time, the latest idle ones are kept.

    A draw and a reset leave nothing of the episode before, so it does not matter whose a world was.
    """

    def __init__(self, scenes: Scenes) -> None:
        self._scenes = scenes
        self._idle: list[World] = []

    def exchange(self, left: World | None, draw: Draw) -> World:
        """Take back the world that an episode leaves, and return one for its draw, with the draw taken over."""
        index = (draw.object, draw.calibration)
        if left is not None and left.index == index:
            left.apply(draw)
            return left
        k = next((k for k, idle in enumerate(self._idle) if idle.index == index), None)
        world = self._scenes.world(index) if k is None else self._idle.pop(k)
        world.apply(draw)
        # last: whatever fails, the episode keeps a world of its own
        if left is not None:
            self._idle.append(left)
            del self._idle[:-MOST_SCENES]
        return world


def names_of(objects: Sequence[ObjectModel]) -> tuple[str, ...]:
    """Return the objects' names.

    Raises
    ------
    ValueError
        If there is none, or two share a name.
    """
    names = tuple(model.name for model in objects)
    if not names or len(set(names)) < len(names):
        raise ValueError(f"objects = {list(names)}: must be one or more, with different names")
    return names
