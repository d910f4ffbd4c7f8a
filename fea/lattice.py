"""Structured (r, theta, z) half lattice with a material per cell, split into curved 10-node tetrahedra.

Half geometry: 0 <= theta <= pi, symmetry plane y = 0, palm side theta = 0 on +x. Rings and gaps are exact layers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from skfem import MeshTet1, MeshTet2

from fea.arrays import F64, I64

VOID = -1
# vertices, then the mid-edge nodes between (0,1), (1,2), (0,2) of each face of the 10-node tetrahedron
_LOCAL_FACES = ((0, 1, 2, 4, 5, 6, 3), (0, 1, 3, 4, 8, 7, 2), (0, 2, 3, 6, 9, 7, 1), (1, 2, 3, 5, 9, 8, 0))


@dataclass(frozen=True, kw_only=True, eq=False)
class Lattice:
    """Cell edges and the material of each cell.

    Attributes
    ----------
    r_m, theta_rad, z_m : arrays [nr + 1], [nt + 1], [nz + 1]
        Increasing cell edges; ``r_m[0]`` may be 0 (solid parts), theta from 0 to pi.
    material : array [nr, nt, nz]
        Material index of each cell, ``VOID`` where there is none.
    """

    r_m: F64
    theta_rad: F64
    z_m: F64
    material: I64

    def __post_init__(self) -> None:
        for name in ("r_m", "theta_rad", "z_m"):
            edges = getattr(self, name)
            if len(edges) < 2 or not np.all(np.diff(edges) > 1e-7):
                raise ValueError(f"{name} must increase by more than 1e-7 from edge to edge")
        shape = (len(self.r_m) - 1, len(self.theta_rad) - 1, len(self.z_m) - 1)
        if self.material.shape != shape:
            raise ValueError(f"material has shape {self.material.shape}, must be {shape}")
        if self.r_m[0] < 0.0 or not (self.material != VOID).any():
            raise ValueError("r_m must not be negative and at least one cell must have a material")


@dataclass(frozen=True, kw_only=True, eq=False)
class SolidMesh:
    """Quadratic tetrahedra (or linear ones: four nodes an element, see :func:`fea.meshes.linear_mesh`).

    Attributes
    ----------
    points_m : array [n_nodes, 3]
        Node positions; vertices first, then mid-edge nodes.
    cylindrical : array [n_nodes, 3]
        (r, theta, z) of each node in the undeformed lattice.
    elements : array [n_elements, 10]
        Nodes of each element in scikit-fem's ``ElementTetP2`` order.
    material : array [n_elements]
        Material index.
    skfem_mesh : MeshTet2
        The same mesh for scikit-fem.
    """

    points_m: F64
    cylindrical: F64
    elements: I64
    material: I64
    skfem_mesh: MeshTet2


def build_mesh(*lattices: Lattice) -> SolidMesh:
    """Split every cell into six tetrahedra along its main diagonal (Kuhn) and curve them with the cylindrical map.

    Equal splits of neighbouring cells match on shared faces. On the axis the vertices of all angles are one, and
    tetrahedra that collapse there are dropped. Several lattices are bonded where their vertices coincide (1 nm), which
    takes equal edges in the interface.
    """
    parts = [_tetrahedra(lattice) for lattice in lattices]
    vertices, tets, material = parts[0]
    if len(parts) > 1:
        offsets = np.cumsum([0, *(len(part[0]) for part in parts[:-1])])
        vertices = np.concatenate([part[0] for part in parts])
        tets = np.concatenate([part[1] + offset for part, offset in zip(parts, offsets, strict=True)])
        material = np.concatenate([part[2] for part in parts])
        _, first, merged = np.unique(np.round(vertices, 9), axis=0, return_index=True, return_inverse=True)
        vertices, tets = vertices[first], merged.ravel()[tets]

    straight = MeshTet1(_cartesian(vertices).T.copy(), tets.T.astype(np.int64).copy())
    quadratic = MeshTet2.from_mesh(straight)
    ends = vertices[np.asarray(quadratic.edges).T]
    # a node on the axis has no angle of its own: it takes that of the other end
    ends[:, 0, 1] = np.where(ends[:, 0, 0] == 0.0, ends[:, 1, 1], ends[:, 0, 1])
    ends[:, 1, 1] = np.where(ends[:, 1, 0] == 0.0, ends[:, 0, 1], ends[:, 1, 1])
    cylindrical = np.vstack([vertices, ends.mean(axis=1)])
    points = _cartesian(cylindrical)
    curved = MeshTet2(points.T.copy(), np.asarray(straight.t))
    elements = np.asarray(curved.dofs.element_dofs.T, dtype=np.int64)
    return SolidMesh(points_m=points, cylindrical=cylindrical, elements=elements, material=material, skfem_mesh=curved)


def free_faces(mesh: SolidMesh, where: Callable[[F64], np.ndarray]) -> I64:
    """Return the nodes of boundary faces all of whose vertices satisfy a condition.

    Parameters
    ----------
    mesh : SolidMesh
    where : callable
        Maps (r, theta, z) of nodes, shape [..., 3], to booleans, shape [...].

    Returns
    -------
    array [n_faces, 6] or [n_faces, 3]
        Vertices and, on 10-node elements, mid-edge nodes; normals *into* the solid, that is out of a cavity.
    """
    local_faces, turned = np.array(_LOCAL_FACES), [0, 2, 1, 5, 4, 3]
    if mesh.elements.shape[1] == 4:
        local_faces, turned = local_faces[:, [0, 1, 2, 6]], turned[:3]
    faces = np.concatenate([mesh.elements[:, local] for local in local_faces])
    keys = np.sort(faces[:, :3], axis=1)
    _, first, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    faces = faces[first[counts == 1]]
    faces = faces[where(mesh.cylindrical[faces[:, :3]]).all(axis=1)]
    p = mesh.points_m[faces[:, [0, 1, 2, -1]]]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    inward = np.einsum("fi,fi->f", normal, p[:, 3] - p[:, 0]) > 0.0
    return np.asarray(np.where(inward[:, None], faces[:, :-1], faces[:, turned]), dtype=np.int64)


def symmetry_nodes(mesh: SolidMesh) -> I64:
    """Return the nodes in the symmetry plane y = 0."""
    r, theta, _ = mesh.cylindrical.T
    return np.flatnonzero((r == 0.0) | (theta == 0.0) | np.isclose(theta, np.pi))


def split(edges: list[float], cells: list[int]) -> F64:
    """Subdivide each interval of ``edges`` into the given number of equal cells."""
    parts = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(edges[:-1], edges[1:], cells, strict=True)]
    return np.concatenate([*parts, [edges[-1]]])


def _tetrahedra(lattice: Lattice) -> tuple[F64, I64, I64]:
    """Return the used vertices (r, theta, z) [n, 3], the tetrahedra [m, 4] and their material [m] of one lattice."""
    shape = (len(lattice.r_m), len(lattice.theta_rad), len(lattice.z_m))
    corners = _kuhn_corners(lattice.material)
    grid = np.stack(np.meshgrid(lattice.r_m, lattice.theta_rad, lattice.z_m, indexing="ij"), axis=-1).reshape(-1, 3)
    index = np.moveaxis(corners, -1, 0).copy()
    if lattice.r_m[0] == 0.0:
        index[1] = np.where(index[0] == 0, 0, index[1])
    tets = np.ravel_multi_index(tuple(index), shape)
    material = np.repeat(lattice.material[lattice.material != VOID], 6)
    ordered = np.sort(tets, axis=1)
    whole = (np.diff(ordered, axis=1) > 0).all(axis=1)
    tets, material = tets[whole], material[whole]
    used, compact = np.unique(tets, return_inverse=True)
    return grid[used], compact.reshape(tets.shape).astype(np.int64), material


def _kuhn_corners(material: I64) -> I64:
    """Return lattice indices [6 * n_cells, 4, 3] of the tetrahedra's vertices, six of a cell together."""
    cells = np.argwhere(material != VOID)
    paths = np.zeros((6, 4, 3), dtype=np.int64)
    for path, order in enumerate(permutations(range(3))):
        for step, axis in enumerate(order):
            paths[path, step + 1 :, axis] = 1
    return (cells[:, None, None, :] + paths[None]).reshape(-1, 4, 3)


def _cartesian(cylindrical: F64) -> F64:
    r, theta, z = np.moveaxis(cylindrical, -1, 0)
    y = np.where(np.isclose(theta, np.pi), 0.0, r * np.sin(theta))
    return np.stack([r * np.cos(theta), y, z], axis=-1)


def is_conforming(mesh: SolidMesh) -> bool:
    """Tell whether no face belongs to more than two elements and every face inside the body to exactly two."""
    faces = np.sort(np.concatenate([mesh.elements[:, local[:3]] for local in _LOCAL_FACES]), axis=1)
    _, counts = np.unique(faces, axis=0, return_counts=True)
    return bool(counts.max() == 2)
