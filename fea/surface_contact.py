"""Contact of two surfaces by either method, chosen by the type of its settings."""

from fea.arrays import I64
from fea.contact import ContactOptions, SurfaceContact
from fea.lattice import SolidMesh
from fea.segment_contact import SegmentContact, SegmentOptions, segment_contact

AnyOptions = ContactOptions | SegmentOptions
AnySurfaces = SurfaceContact | SegmentContact


def surface_contact(mesh: SolidMesh, first: I64, second: I64, options: AnyOptions) -> AnySurfaces:
    """Return the contact between two surfaces of a mesh (faces as of :func:`fea.lattice.free_faces`)."""
    if isinstance(options, SegmentOptions):
        return segment_contact(mesh, first, second, options)
    return SurfaceContact(mesh, first, second, options)
