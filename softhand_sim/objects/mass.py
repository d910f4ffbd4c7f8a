"""Volume, mass centre and inertia of closed triangle surfaces at uniform density."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh

from softhand_sim.objects.geometry import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class MassProperties:
    """Mass properties at density 1 kg/m3.

    Attributes
    ----------
    volume_m3 : float
    centre_m : ndarray, shape (3,)
    inertia_m5 : ndarray, shape (3, 3)
        About the mass centre; multiply by mass / volume for kg m2.
    """

    volume_m3: float
    centre_m: FloatArray
    inertia_m5: FloatArray


def is_closed(mesh: trimesh.Trimesh) -> bool:
    """Return whether every directed edge is cancelled by its opposite.

    This is what the volume integrals need. It is weaker than watertight: edges shared by four triangles are
    allowed.
    """
    edges = np.asarray(mesh.edges, dtype=np.int64)
    count = len(mesh.vertices)
    forward, backward = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    return bool(len(edges)) and np.array_equal(np.sort(forward), np.sort(backward))


def signed_volume_m3(mesh: trimesh.Trimesh) -> float:
    """Return the volume a closed surface encloses, negative if its triangles are turned inward."""
    corners = np.asarray(mesh.vertices, dtype=np.float64)[np.asarray(mesh.faces)] - np.asarray(mesh.vertices).mean(
        axis=0
    )
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)


def mass_properties(mesh: trimesh.Trimesh) -> MassProperties:
    """Return the mass properties of the solid inside a closed surface.

    Sums signed tetrahedra from a point inside the bounding box; for a tetrahedron (0, a, b, c) of volume V
    the second moment is V/20 (aa' + bb' + cc' + ss') with s = a + b + c (exact for polynomials of degree
    two).

    Raises
    ------
    ValueError
        If the enclosed volume is not positive.
    """
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    origin = vertices.mean(axis=0)
    corners = (vertices - origin)[np.asarray(mesh.faces)]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    volume = float(volumes.sum())
    if not volume > 0.0:
        raise ValueError(f"the surface encloses a volume of {volume:.3g} m3, needs > 0")
    total = a + b + c
    centre = volumes @ total / 4.0 / volume
    second = sum(np.einsum("i,ij,ik->jk", volumes, x, x) for x in (a, b, c, total)) / 20.0
    second = second - volume * np.outer(centre, centre)
    inertia = np.trace(second) * np.eye(3) - second
    return MassProperties(volume_m3=volume, centre_m=origin + centre, inertia_m5=(inertia + inertia.T) / 2.0)


def combined(parts: Sequence[trimesh.Trimesh]) -> MassProperties:
    """Return the mass properties of several solids together (parallel-axis theorem; overlaps count twice)."""
    each = [mass_properties(part) for part in parts]
    volume = sum(p.volume_m3 for p in each)
    centre = sum((p.volume_m3 * p.centre_m for p in each), np.zeros(3)) / volume
    inertia = np.zeros((3, 3))
    for p in each:
        d = p.centre_m - centre
        inertia += p.inertia_m5 + p.volume_m3 * (d @ d * np.eye(3) - np.outer(d, d))
    return MassProperties(volume_m3=volume, centre_m=centre, inertia_m5=inertia)
