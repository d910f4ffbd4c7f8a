"""An object as part of a MuJoCo model, without any file on disk."""

from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh

from softhand_sim.contact import ContactSettings
from softhand_sim.objects.model import ObjectModel

if TYPE_CHECKING:
    from dm_control import mjcf

VISUAL_GROUP = 2
COLLISION_GROUP = 3


def attach_object(
    root: "mjcf.RootElement",
    model: ObjectModel,
    *,
    name: str = "object",
    contact: ContactSettings | None = None,
    first: bool = False,
) -> "mjcf.Element":
    """Add the object to a model as a free body at the origin, and return the body's element.

    The body's frame is the object's canonical frame; put it at z = table height + `model.rest_height_m` to
    rest. Its elements are called `<name>` (body), `<name>_joint`, `<name>_visual` (group 2, no contact, no
    mass) and `<name>_collision_<i>` (group 3). Geometry is written inline, so the model needs no files.

    With ``first`` it stands before all other bodies. The engine's sparse factors then fill in less: a contact of object
    and table leaves the hand's rows alone.

    Raises
    ------
    ValueError
        If the model has such a body already.
    """
    if root.find("body", name) is not None:
        raise ValueError(f"the model has a body {name!r} already")
    settings = ContactSettings() if contact is None else contact
    body = root.worldbody.insert("body", 0, name=name) if first else root.worldbody.add("body", name=name)
    body.add("freejoint", name=f"{name}_joint")
    full = model.inertia_kg_m2
    body.add(
        "inertial",
        pos=(0.0, 0.0, 0.0),
        mass=model.mass_kg,
        fullinertia=(full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2]),
    )
    body.add(
        "geom",
        name=f"{name}_visual",
        type="mesh",
        mesh=_add_mesh(root, f"{name}_visual", model.mesh),
        group=VISUAL_GROUP,
        contype=0,
        conaffinity=0,
        mass=0.0,
        rgba=model.rgba,
    )
    common = _contact_attributes(model, settings)
    if model.primitive is not None:
        size = model.primitive.size_m
        body.add("geom", name=f"{name}_collision_0", type=model.primitive.kind, size=size, **common)
        return body
    for i, part in enumerate(model.convex_parts):
        label = f"{name}_collision_{i}"
        body.add("geom", name=label, type="mesh", mesh=_add_mesh(root, label, part), **common)
    return body


def _contact_attributes(model: ObjectModel, settings: ContactSettings) -> dict[str, Any]:
    return {
        "group": COLLISION_GROUP,
        "mass": 0.0,
        "condim": settings.condim,
        "friction": settings.friction(model.friction),
        "solref": settings.solref,
        "priority": settings.object_priority,
        "rgba": model.rgba,
    }


def _add_mesh(root: "mjcf.RootElement", name: str, mesh: trimesh.Trimesh) -> "mjcf.Element":
    # "shell": the engine then needs an area only; its volume check would refuse thin or open visual meshes, and the
    # body's inertia is explicit anyway
    return root.asset.add(
        "mesh",
        name=name,
        inertia="shell",
        vertex=np.asarray(mesh.vertices, dtype=np.float64).ravel(),
        face=np.asarray(mesh.faces, dtype=np.int64).ravel(),
    )
