"""How a body comes to lie on a table."""

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from softhand_sim.objects.geometry import FloatArray, ShapeGeometry, hull
from softhand_sim.objects.mass import mass_properties

ALIKE = 0.01
"""Resting poses whose probabilities differ by less than this share count as equally probable (choice)."""


def resting_rotation(points: FloatArray, centre: FloatArray, keep_upright: bool) -> FloatArray:
    """Return the smallest rotation, shape (3, 3), that lays a body down in a most probable resting pose.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Of the surface that touches the table.
    centre : ndarray, shape (3,)
        Mass centre.
    keep_upright : bool
        Take the stable pose with the smallest rotation instead of the most probable one.

    Raises
    ------
    ValueError
        If the mass centre is outside the hull of the points.

    Notes
    -----
    Quasi-static drop probabilities over the hull's facets, K. Goldberg et al., IJRR 18(5), 1999, as
    implemented in trimesh; without sampling, so the same on every call.
    """
    outer = hull(points)
    gaps = np.einsum("ij,ij->i", outer.face_normals, centre - outer.triangles_center)
    if np.any(gaps >= 0.0):
        raise ValueError("the mass centre lies outside the hull of the convex parts")
    poses, chances = trimesh.poses.compute_stable_poses(outer, center_mass=centre, sigma=0.0, n_samples=1, seed=0)
    ups = np.asarray(poses, dtype=np.float64)[:, 2, :3]
    if not keep_upright:
        # a body of revolution has many alike: the last bits must not choose between them
        ups = ups[np.asarray(chances) >= (1.0 - ALIKE) * np.max(chances)]
    up = ups[int(np.argmax(ups[:, 2]))]
    return np.asarray(Rotation.align_vectors([[0.0, 0.0, 1.0]], [up])[0].as_matrix(), dtype=np.float64)


def laid_down(geometry: ShapeGeometry) -> ShapeGeometry:
    """Return a geometry of several convex parts turned into the most probable resting pose of its solid.

    Raises
    ------
    ValueError
        If the mesh encloses no volume.
    """
    points = np.vstack([part.vertices for part in geometry.convex_parts])
    rotation = resting_rotation(points, mass_properties(geometry.mesh).centre_m, keep_upright=False)
    return ShapeGeometry(
        mesh=turned(geometry.mesh, rotation),
        convex_parts=tuple(turned(part, rotation) for part in geometry.convex_parts),
    )


def turned(mesh: trimesh.Trimesh, rotation: FloatArray) -> trimesh.Trimesh:
    """Return a copy of a mesh turned about the origin by a rotation, shape (3, 3)."""
    return trimesh.Trimesh(vertices=np.asarray(mesh.vertices) @ rotation.T, faces=np.asarray(mesh.faces), process=False)
