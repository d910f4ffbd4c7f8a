"""The bodies of a surface: one object is one body, with cavities and with pieces that touch."""

import numpy as np
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from softhand_sim.objects.geometry import FloatArray, IntArray
from softhand_sim.objects.mass import is_closed, signed_volume_m3

TOUCHING_M = 0.003
"""Pieces nearer than this belong together; choice: less than a fingertip, more than the joints of an assembly."""
CRUMB = 0.01
"""Pieces whose box has a diagonal below this share of the largest one's are dropped (choice: flying bits of a scan)."""
MOST_SCRAPS = 5000
"""Pieces together with crumbs (choice: each costs a pass over the triangles)."""
MOST_PIECES = 50
"""A surface of more pieces than this is no object but a heap of triangles (choice: an assembly of a pair of pliers)."""
SAMPLES = 4000
"""Points on each piece; choice: 2 mm apart on a mug."""


def one_body(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, tuple[str, ...]]:
    """Return the mesh without crumbs, closed pieces turned outward, cavities inward, and notes on what was done.

    Raises
    ------
    ValueError
        If it holds bodies that do not touch.
    """
    count, label = _pieces(mesh)
    if count == 1:
        return mesh, ()
    if count > MOST_SCRAPS:
        raise ValueError(f"falls into {count} pieces, allowed {MOST_SCRAPS} with scraps")
    pieces = _split(mesh, count, label)
    sizes = np.array([np.linalg.norm(piece.extents) for piece in pieces])
    kept = [piece for piece, size in zip(pieces, sizes, strict=True) if size >= CRUMB * sizes.max()]
    if len(kept) > MOST_PIECES:
        raise ValueError(f"falls into {len(kept)} pieces, allowed {MOST_PIECES}")
    notes = [] if len(kept) == count else [f"{count - len(kept)} loose bits dropped"]
    inside = [_is_cavity(piece, kept) for piece in kept]
    outer = [piece for piece, cavity in zip(kept, inside, strict=True) if not cavity]
    cavities = [piece for piece, cavity in zip(kept, inside, strict=True) if cavity]
    turned = 0
    for piece in outer:
        if is_closed(piece) and signed_volume_m3(piece) < 0.0:
            piece.invert()
            turned += 1
    if turned:
        notes.append(f"{turned} pieces turned outward")
    gap = _widest_gap_m(outer)
    if gap > TOUCHING_M:
        raise ValueError(
            f"holds separate bodies, up to {1e3 * gap:.1f} mm apart; an object is one body: split the file"
        )
    return _joined([*outer, *cavities]), tuple(notes)


def without_cavities(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Return the surface that can be touched from outside."""
    count, label = _pieces(mesh)
    if count == 1:
        return mesh
    pieces = _split(mesh, count, label)
    return _joined([piece for piece in pieces if not _is_cavity(piece, pieces)])


def _split(mesh: trimesh.Trimesh, count: int, label: IntArray) -> list[trimesh.Trimesh]:
    faces = np.asarray(mesh.faces)
    pieces = [trimesh.Trimesh(mesh.vertices, faces[label == i], process=False) for i in range(count)]
    for piece in pieces:
        piece.remove_unreferenced_vertices()
    return pieces


def _joined(pieces: list[trimesh.Trimesh]) -> trimesh.Trimesh:
    whole = trimesh.util.concatenate(pieces)
    return trimesh.Trimesh(whole.vertices, whole.faces, process=False)


def _pieces(mesh: trimesh.Trimesh) -> tuple[int, IntArray]:
    """Return the number of pieces that share no vertex, and each triangle's piece, shape (n,)."""
    a, b, c = np.asarray(mesh.faces).T
    rows, columns = np.concatenate([a, b]), np.concatenate([b, c])
    size = len(mesh.vertices)
    graph = coo_matrix((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(size, size))
    _, of_vertex = connected_components(graph, directed=False)
    names, of_face = np.unique(of_vertex[a], return_inverse=True)
    return len(names), np.asarray(of_face, dtype=np.int64)


def _is_cavity(piece: trimesh.Trimesh, pieces: list[trimesh.Trimesh]) -> bool:
    """Return whether a piece is closed, turned inward, and inside the box of a closed piece turned outward."""
    if not (is_closed(piece) and signed_volume_m3(piece) < 0.0):
        return False
    low, high = piece.bounds
    return any(
        other is not piece
        and is_closed(other)
        and signed_volume_m3(other) > -signed_volume_m3(piece)
        and bool(np.all(other.bounds[0] < low) and np.all(high < other.bounds[1]))
        for other in pieces
    )


def _widest_gap_m(pieces: list[trimesh.Trimesh]) -> float:
    """Return the longest of the shortest ways (m) that link all pieces."""
    clouds = [_points(piece) for piece in pieces]
    linked, gap = [0], 0.0
    left = set(range(1, len(pieces)))
    # Prim's minimum spanning tree
    near = {i: _distance_m(clouds[0], clouds[i]) for i in left}
    while left:
        nearest = min(left, key=lambda i: near[i])
        gap = max(gap, near[nearest])
        left.remove(nearest)
        linked.append(nearest)
        for i in left:
            near[i] = min(near[i], _distance_m(clouds[nearest], clouds[i]))
    return gap


def _points(piece: trimesh.Trimesh) -> FloatArray:
    spread, _ = trimesh.sample.sample_surface(piece, SAMPLES, seed=0)
    return np.vstack([piece.vertices, spread])


def _distance_m(first: FloatArray, second: FloatArray) -> float:
    return float(np.min(cKDTree(first).query(second)[0]))
