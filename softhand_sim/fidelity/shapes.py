"""Collision shapes of an object, coarser or finer than those that it comes with."""

import dataclasses
from enum import StrEnum

import numpy as np

from softhand_sim.objects.decompose import reduced_hull
from softhand_sim.objects.geometry import hull
from softhand_sim.objects.model import ObjectModel


class Shapes(StrEnum):
    """What an object collides with.

    HULL: one convex hull around everything, of at most 256 corners.
    SHIPPED: its own convex parts, or the engine's primitive where it is one.
    FINE: every convex part with all corners of its surface, no primitive.
    """

    HULL = "hull"
    SHIPPED = "shipped"
    FINE = "fine"


def with_shapes(model: ObjectModel, shapes: Shapes) -> ObjectModel:
    """Return the object with other collision shapes; mass and pose stay.

    A convex object's own surface is finer than its reduced hull; a part of a decomposed one is a hull already.
    """
    if shapes is Shapes.SHIPPED:
        return model
    corners = np.asarray(model.mesh.vertices)
    if shapes is Shapes.HULL:
        return dataclasses.replace(model, convex_parts=(reduced_hull(corners),), primitive=None)
    parts = (hull(corners),) if len(model.convex_parts) == 1 else model.convex_parts
    return dataclasses.replace(model, convex_parts=parts, primitive=None)
