"""Objects to grasp: the catalogue's generated shapes and any mesh file, as one kind of model."""

from softhand_sim.objects.catalogue import CatalogueEntry, load_catalogue, make_object
from softhand_sim.objects.loader import load_mesh_object
from softhand_sim.objects.mjcf import ContactSettings, attach_object
from softhand_sim.objects.model import DEFAULT_FRICTION, ObjectModel

__all__ = [
    "DEFAULT_FRICTION",
    "CatalogueEntry",
    "ContactSettings",
    "ObjectModel",
    "attach_object",
    "load_catalogue",
    "load_mesh_object",
    "make_object",
]
