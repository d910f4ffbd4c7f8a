"""The scene: engine settings, table, light, camera, the hand, and at most one object."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import mujoco
from dm_control import mjcf

from softhand_sim.calibration import FingerCalibration
from softhand_sim.contact import ContactSettings
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.hand.hand import add_hand

INTEGRATORS, CONES = ("Euler", "implicit", "implicitfast", "RK4"), ("pyramidal", "elliptic")
"""The engine's integrators and friction cones by their names in MJCF."""
JACOBIANS = ("dense", "sparse")
"""Storage of the solver's matrices; the results are the same but for rounding."""


@dataclass(frozen=True, kw_only=True)
class EngineSettings:
    """Time step and solver settings (choices, by a stability study of 18 grasps; see docs/decisions.md).

    At 2 ms none of its verdicts differed from 0.5 ms, at 4 ms five did; pyramidal cones flipped eight and creep
    by design; three noslip iterations cut the creep of a held object to a third.

    ``jacobian``, ``islands`` (parts of the scene that do not touch are solved apart) and ``tolerance`` (MJCF's, of the
    solver's end) change time and rounding only.

    Raises
    ------
    ValueError
        If a name is unknown or a number out of range; the message names it.
    """

    timestep_s: float = 0.002
    impratio: float = 10.0
    noslip_iterations: int = 3
    gravity_m_per_s2: float = 9.81
    integrator: str = "implicitfast"
    cone: str = "elliptic"
    jacobian: str = "dense"
    islands: bool = True
    tolerance: float = 1e-8

    def __post_init__(self) -> None:
        for name, allowed in (("integrator", INTEGRATORS), ("cone", CONES), ("jacobian", JACOBIANS)):
            if getattr(self, name) not in allowed:
                raise ValueError(f"{name}: {getattr(self, name)!r} must be one of {', '.join(allowed)}")
        if not 1e-4 <= self.timestep_s <= 8e-3:
            raise ValueError(f"timestep_s: {self.timestep_s} must lie in [0.0001, 0.008]")
        if not 0.0 <= self.tolerance <= 1e-3:
            raise ValueError(f"tolerance: {self.tolerance} must lie in [0, 0.001]")


STICKY_FRICTION, STICKY_NOSLIP_ITERATIONS = 1.0, 30
"""Choices: an apple of friction 2 creeps at 30 to 1800 um/s with 3 iterations, depending on step and seed, at 20 to 40
with 30 (`scripts/hard_cases.py --cases "sticky apple"`); a trial costs a quarter more."""


def for_friction(settings: EngineSettings, friction: float) -> EngineSettings:
    """Return engine settings under which a thing of a friction coefficient sticks: more noslip iterations above 1."""
    if friction <= STICKY_FRICTION:
        return settings
    return replace(settings, noslip_iterations=max(settings.noslip_iterations, STICKY_NOSLIP_ITERATIONS))


def build_root(
    calibration: FingerCalibration,
    *,
    anatomy: HandAnatomy | None = None,
    contact: ContactSettings | None = None,
    engine: EngineSettings | None = None,
    links: int | None = None,
) -> mjcf.RootElement:
    """MJCF of the hand alone in an empty world, with the engine's settings; ``links`` as in `add_hand`."""
    root = empty_root("softhand", engine or EngineSettings())
    add_hand(root, calibration, anatomy or HandAnatomy(), contact or ContactSettings(), links)
    return root


def empty_root(name: str, settings: EngineSettings) -> mjcf.RootElement:
    """MJCF of an empty world with the engine's settings."""
    root = mjcf.RootElement(model=name)
    root.compiler.set_attributes(angle="radian", autolimits=True)
    root.option.set_attributes(
        timestep=settings.timestep_s,
        integrator=settings.integrator,
        cone=settings.cone,
        impratio=settings.impratio,
        noslip_iterations=settings.noslip_iterations,
        jacobian=settings.jacobian,
        gravity=(0.0, 0.0, -settings.gravity_m_per_s2),
    )
    # what is the engine's own default stands in no file
    if settings.tolerance != EngineSettings.tolerance:
        root.option.tolerance = settings.tolerance
    if not settings.islands:
        root.option.flag.island = "disable"
    return root


def add_surroundings(root: mjcf.RootElement, contact: ContactSettings | None = None) -> None:
    """Add table (plane z = 0), light, sky and camera."""
    settings = contact or ContactSettings()
    root.visual.headlight.set_attributes(ambient=(0.35, 0.35, 0.35), diffuse=(0.45, 0.45, 0.45))
    # "global" is a Python keyword
    getattr(root.visual, "global").set_attributes(offwidth=960, offheight=720)
    root.visual.map.set_attributes(znear=0.01, zfar=20)
    root.asset.add(
        "texture", name="sky", type="skybox", builtin="gradient",
        rgb1=(0.93, 0.95, 0.97), rgb2=(0.70, 0.76, 0.82), width=64, height=64,
    )  # fmt: skip
    root.worldbody.add(
        "geom", name="table", type="plane", size=(1, 1, 0.05), rgba=(0.78, 0.74, 0.68, 1),
        friction=settings.friction(settings.pad_friction), solref=settings.solref,
    )  # fmt: skip
    root.worldbody.add("light", name="lamp", pos=(0.4, -0.6, 1.2), dir=(-0.3, 0.45, -0.9), castshadow=True)
    root.worldbody.add(
        "camera", name="front", pos=(0.36, -0.45, 0.28), xyaxes=(0.781, 0.625, 0.0, -0.167, 0.209, 0.964), fovy=38
    )


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A compiled scene. `model` is shared and never written to by its users; `xml` rebuilds it."""

    model: mujoco.MjModel
    xml: str


def compile_scene(root: mjcf.RootElement) -> Scene:
    """Compile MJCF to a model."""
    xml = root.to_xml_string(filename_with_hash=False)
    return Scene(model=mujoco.MjModel.from_xml_string(xml, root.get_assets()), xml=xml)


def build_scene(
    calibration: FingerCalibration,
    *,
    add_object: Callable[[mjcf.RootElement], Any] | None = None,
    engine: EngineSettings | None = None,
    contact: ContactSettings | None = None,
    links: int | None = None,
) -> Scene:
    """Hand over a table, with the object that `add_object` adds to the MJCF (none without).

    ``links`` as in `add_hand`.
    """
    root = build_root(calibration, engine=engine, contact=contact, links=links)
    add_surroundings(root, contact)
    if add_object is not None:
        add_object(root)
    return compile_scene(root)
