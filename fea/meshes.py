"""Meshes of simple bodies: a triangulated plane figure swept through layers and mapped into space.

In each :class:`~fea.lattice.SolidMesh` made here ``cylindrical`` holds the reference coordinates (s, t, w) of the nodes
before the map, so that surfaces are chosen by ``free_faces`` as in the finger's lattice.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from skfem import MeshTet1, MeshTet2

from fea.arrays import F64, I64
from fea.lattice import SolidMesh


def rectangle(s: F64, t: F64) -> tuple[F64, I64]:
    """Return points [n, 2] and triangles [m, 3] of a grid with edges ``s`` and ``t``."""
    points = np.stack(np.meshgrid(s, t, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(points)).reshape(len(s), len(t))
    a, b, c, d = (x.ravel() for x in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def triangle(n: int) -> tuple[F64, I64]:
    """Return points [p, 2] and triangles [n^2, 3] of the figure s, t >= 0, s + t <= 1 with n cells an edge."""
    number: dict[tuple[int, int], int] = {}
    for i in range(n + 1):
        for j in range(n + 1 - i):
            number[i, j] = len(number)
    up = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in number if i + j < n]
    down = [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in number if i + j < n - 1]
    return np.array(list(number), dtype=np.float64) / n, np.array(up + down, dtype=np.int64)


def sweep(figure: tuple[F64, I64], heights: F64, position: Callable[[F64], F64] = lambda x: x) -> SolidMesh:
    """Sweep a triangulated figure through layers, split the prisms into tetrahedra and curve them with a map.

    Parameters
    ----------
    figure : points [n, 2] and triangles [m, 3]
    heights : array [k + 1]
        Increasing third reference coordinate w of the layers' faces.
    position : callable
        Maps reference coordinates [n_nodes, 3] to positions [n_nodes, 3] in metres; applied to mid-edge nodes too.

    Returns
    -------
    SolidMesh
        Ten-node tetrahedra of material 0. A prism is cut along the diagonals that leave each side's vertex of lower
        number at the bottom, so cuts of neighbours match.
    """
    points, triangles = figure
    i, j, k = np.sort(triangles, axis=1).T
    up = len(points)
    layer = np.concatenate(
        [np.stack(tet, axis=1) for tet in ((i, j, k, k + up), (i, j, j + up, k + up), (i, i + up, j + up, k + up))]
    )
    tets = np.concatenate([layer + up * n for n in range(len(heights) - 1)])
    vertices = np.concatenate([np.column_stack([points, np.full(up, w)]) for w in heights])
    straight = MeshTet1(vertices.T.copy(), tets.T.astype(np.int64).copy())
    edges = np.asarray(MeshTet2.from_mesh(straight).edges).T
    reference = np.vstack([vertices, vertices[edges].mean(axis=1)])
    return _quadratic(position(reference), reference, straight)


def straight_sided(mesh: SolidMesh, vertices_m: F64) -> SolidMesh:
    """Return the mesh with its vertices moved to [n_vertices, 3] and each mid-edge node halfway."""
    straight = MeshTet1(vertices_m.T.copy(), np.asarray(mesh.skfem_mesh.t))
    edges = np.asarray(MeshTet2.from_mesh(straight).edges).T
    return _quadratic(np.vstack([vertices_m, vertices_m[edges].mean(axis=1)]), mesh.cylindrical, straight)


def union(*meshes: SolidMesh) -> SolidMesh:
    """Return several meshes of straight ten-node tetrahedra as one, unconnected; material i in the i-th of them.

    The reference coordinates are the positions: those of the parts need not share a map.
    """
    counts = [int(mesh.elements[:, :4].max()) + 1 for mesh in meshes]
    starts = np.cumsum([0, *counts[:-1]])
    vertices = np.vstack([mesh.points_m[:n] for mesh, n in zip(meshes, counts, strict=True)])
    tets = np.vstack([mesh.elements[:, :4] + start for mesh, start in zip(meshes, starts, strict=True)])
    straight = MeshTet1(vertices.T.copy(), tets.T.copy())
    edges = np.asarray(MeshTet2.from_mesh(straight).edges).T
    points = np.vstack([vertices, vertices[edges].mean(axis=1)])
    material = np.repeat(np.arange(len(meshes)), [len(mesh.elements) for mesh in meshes])
    return replace(_quadratic(points, points, straight), material=material)


def linear_mesh(mesh: SolidMesh) -> SolidMesh:
    """Return the four-node tetrahedra over the vertices of a ten-node mesh (P1, chords instead of curves)."""
    n = int(mesh.elements[:, :4].max()) + 1
    points = mesh.points_m[:n].copy()
    return replace(
        mesh,
        points_m=points,
        cylindrical=mesh.cylindrical[:n],
        elements=mesh.elements[:, :4].copy(),
        skfem_mesh=MeshTet1(points.T.copy(), mesh.elements[:, :4].T.copy()),
    )


def surface_force(mesh: SolidMesh, faces: I64, traction_pa: F64) -> F64:
    """Return nodal forces [n_nodes, 3] of a uniform dead traction [3] on flat faces [n_faces, 6] or [n_faces, 3]."""
    corner = mesh.points_m[faces[:, :3]]
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    force = np.zeros_like(mesh.points_m)
    # the integral of a quadratic shape function is zero at a vertex and a third of the area at a mid-edge node
    nodes = faces[:, 3:] if faces.shape[1] == 6 else faces
    np.add.at(force, nodes, area[:, None, None] / 3.0 * traction_pa)
    return force


def _quadratic(points_m: F64, reference: F64, straight: MeshTet1) -> SolidMesh:
    mesh = MeshTet2(points_m.T.copy(), np.asarray(straight.t))
    elements = np.asarray(mesh.dofs.element_dofs.T, dtype=np.int64)
    material = np.zeros(len(elements), dtype=np.int64)
    return SolidMesh(points_m=points_m, cylindrical=reference, elements=elements, material=material, skfem_mesh=mesh)
