"""The graspable object as the rest of the simulator sees it."""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import trimesh

from softhand_sim.objects.geometry import FloatArray, Primitive, ShapeGeometry
from softhand_sim.objects.mass import MassProperties, mass_properties

DEFAULT_FRICTION = 0.8
"""Static coefficient against TPU or silicone; choice: see the head of assets/objects/catalogue.toml."""

GREY = (0.6, 0.6, 0.65, 1.0)


def check_mass(mass_kg: float) -> None:
    """Raise ValueError unless the mass is finite and positive."""
    if not (np.isfinite(mass_kg) and mass_kg > 0.0):
        raise ValueError(f"mass_kg is {mass_kg}, needs a finite number > 0")


def check_friction(friction: float) -> None:
    """Raise ValueError unless the friction coefficient is finite and not negative."""
    if not (np.isfinite(friction) and friction >= 0.0):
        raise ValueError(f"friction is {friction}, needs a finite number >= 0")


@dataclass(frozen=True, kw_only=True, eq=False)
class ObjectModel:
    """A rigid object in its canonical frame: origin at the mass centre, z up, as it rests on a table.

    Attributes
    ----------
    name : str
    kind : str
        The catalogue's shape kind, or "mesh" for a user's file.
    mesh : trimesh.Trimesh
        Surface to look at (metres).
    convex_parts : tuple of trimesh.Trimesh
        Convex solids to collide with (metres, same frame).
    mass_kg : float
    inertia_kg_m2 : ndarray, shape (3, 3)
        About the mass centre, along the axes of the object's frame.
    friction : float
        Sliding friction coefficient against the hand and the table.
    primitive : Primitive, optional
        The same solid as one engine primitive; cheaper to collide with than its hull.
    rgba : tuple of float
        Colour in pictures.
    notes : tuple of str
        What was repaired or assumed on loading, for the user to read.

    Raises
    ------
    ValueError
        If mass, friction or inertia is impossible, or there is nothing to collide with.
    """

    name: str
    kind: str
    mesh: trimesh.Trimesh
    convex_parts: tuple[trimesh.Trimesh, ...]
    mass_kg: float
    inertia_kg_m2: FloatArray
    friction: float = DEFAULT_FRICTION
    primitive: Primitive | None = None
    rgba: tuple[float, float, float, float] = GREY
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_mass(self.mass_kg)
        check_friction(self.friction)
        if not self.convex_parts:
            raise ValueError(f"convex_parts of {self.name} is empty, needs at least one")
        if self.inertia_kg_m2.shape != (3, 3) or not np.isfinite(self.inertia_kg_m2).all():
            raise ValueError(f"inertia_kg_m2 of {self.name} needs shape (3, 3) and finite values")
        small, middle, large = np.linalg.eigvalsh(self.inertia_kg_m2)
        if not (small > 0.0 and small + middle >= large * (1.0 - 1e-9)):
            raise ValueError(f"inertia_kg_m2 of {self.name} has principal values {small}, {middle}, {large}: no solid")

    @property
    def rest_height_m(self) -> float:
        """Height of the mass centre above the table when the object rests on it."""
        return -min(float(part.bounds[0, 2]) for part in self.convex_parts)

    @property
    def extents_m(self) -> FloatArray:
        """Sides of the bounding box along x, y, z, shape (3,)."""
        return np.asarray(self.mesh.extents, dtype=np.float64)

    def with_overrides(self, *, mass_kg: float | None = None, friction: float | None = None) -> "ObjectModel":
        """Return the object with another mass (inertia scales along) or friction; None keeps the value.

        Raises
        ------
        ValueError
            If the new mass or friction is impossible.
        """
        mass = self.mass_kg if mass_kg is None else mass_kg
        check_mass(mass)
        return dataclasses.replace(
            self,
            mass_kg=mass,
            inertia_kg_m2=self.inertia_kg_m2 * (mass / self.mass_kg),
            friction=self.friction if friction is None else friction,
        )


def build_object(
    geometry: ShapeGeometry,
    *,
    name: str,
    kind: str,
    mass_kg: float,
    friction: float,
    properties: MassProperties | None = None,
    rgba: tuple[float, float, float, float] = GREY,
    notes: tuple[str, ...] = (),
) -> ObjectModel:
    """Move a geometry in its resting pose to its mass centre and give it mass and inertia.

    Parameters
    ----------
    geometry : ShapeGeometry
    properties : MassProperties, optional
        In the geometry's frame; by default those of the solid inside the mesh.

    Raises
    ------
    ValueError
        If mass or friction is impossible, or the mesh encloses no volume.
    """
    check_mass(mass_kg)
    props = mass_properties(geometry.mesh) if properties is None else properties
    move = shifted(-props.centre_m)
    return ObjectModel(
        name=name,
        kind=kind,
        mesh=move(geometry.mesh),
        convex_parts=tuple(move(part) for part in geometry.convex_parts),
        mass_kg=mass_kg,
        inertia_kg_m2=props.inertia_m5 * (mass_kg / props.volume_m3),
        friction=friction,
        primitive=geometry.primitive,
        rgba=rgba,
        notes=notes,
    )


def shifted(offset_m: FloatArray) -> Callable[[trimesh.Trimesh], trimesh.Trimesh]:
    """Return a function that gives a copy of a mesh moved by an offset, shape (3,)."""

    def move(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
        return trimesh.Trimesh(
            vertices=np.asarray(mesh.vertices) + offset_m, faces=np.asarray(mesh.faces), process=False
        )

    return move
