"""Printable surfaces of the finger's parts and of the actuator's moulds, from the same dimensions as the analyses."""

from dataclasses import dataclass

import numpy as np
import trimesh

from fea.arrays import F64, I64, Bool
from fea.exoskeleton import TPU, ExoskeletonMesh, exoskeleton_lattice
from fea.geometry import FingerGeometry

SECTORS = 96
"""Facets of a full turn. Choice: the chord leaves the finger's outer circle by 5 micrometres."""
MOULD_WALL_M = 3e-3
"""Choice: stiff enough to be clamped, above the 2 mm minimum."""
MOULD_FIT_M = 0.2e-3
"""Choice: radial play of the printed collar on the shell."""
COLLAR_HEIGHT_M = 6e-3
"""Choice: centres the core without hiding the pouring slots."""
POURING_SLOTS = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Ring:
    """Cells of a full turn in cylindrical coordinates.

    Attributes
    ----------
    r_m, z_m : arrays [nr + 1], [nz + 1]
        Increasing cell edges; ``r_m[0]`` may be 0.
    theta_rad : array [nt]
        Increasing angles within one turn; the last cell closes it.
    filled : boolean array [nr, nt, nz]
        Where there is material.
    """

    r_m: F64
    theta_rad: F64
    z_m: F64
    filled: Bool

    def surface(self) -> trimesh.Trimesh:
        """Return the boundary, normals outwards, base on z = 0 [m]."""
        quads = np.concatenate([self._faces(axis, side) for axis in range(3) for side in (0, 1)])
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (a != c)]
        r, t, z = np.meshgrid(self.r_m, self.theta_rad, self.z_m, indexing="ij")
        points = np.stack([r * np.cos(t), r * np.sin(t), z], axis=-1).reshape(-1, 3)
        used, compact = np.unique(triangles, return_inverse=True)
        points = points[used] - [0.0, 0.0, points[used, 2].min()]
        return trimesh.Trimesh(vertices=points, faces=compact.reshape(-1, 3), process=False)

    def _faces(self, axis: int, side: int) -> I64:
        """Corner indices [n, 4] of the faces on one side of the cells towards an empty neighbour."""
        shift = 1 if side else -1
        neighbour = np.roll(self.filled, -shift, axis=axis)
        if axis != 1:  # only the angle is periodic
            edge: list[slice | int] = [slice(None)] * 3
            edge[axis] = -1 if side else 0
            neighbour[tuple(edge)] = False
        cells = np.argwhere(self.filled & ~neighbour)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        corners = np.repeat(cells[:, None, :], 4, axis=1)
        corners[:, :, axis] += side
        corners[:, [1, 2], first] += 1
        corners[:, [2, 3], second] += 1
        shape = (len(self.r_m), len(self.theta_rad), len(self.z_m))
        corners[..., 1] %= shape[1]
        on_axis = self.r_m[corners[..., 0]] == 0.0
        corners[..., 1] = np.where(on_axis, 0, corners[..., 1])
        index = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), shape)
        return np.asarray(index if side else index[:, ::-1], dtype=np.int64)


def exoskeleton_surface(geometry: FingerGeometry) -> trimesh.Trimesh:
    """Return the exoskeleton: the lattice of the analysis with finer angles, mirrored to the full turn."""
    sector = max(4, round(SECTORS * geometry.sector_half_angle_rad / (2.0 * np.pi)))
    mesh = ExoskeletonMesh(
        sector_cells=sector, rest_cells=SECTORS // 2 - sector, wall_cells=1, gap_cells=1, segment_cells=1
    )
    half = exoskeleton_lattice(geometry, mesh)
    filled = half.material == TPU
    theta = np.concatenate([half.theta_rad, 2.0 * np.pi - half.theta_rad[-2:0:-1]])
    whole = np.concatenate([filled, filled[:, ::-1]], axis=1)
    return Ring(r_m=half.r_m, theta_rad=theta, z_m=half.z_m, filled=whole).surface()


def actuator_surface(geometry: FingerGeometry) -> trimesh.Trimesh:
    """Return the actuator's silicone body (thread included), open at its base."""
    g = geometry
    r = np.array([0.0, g.actuator_inner_radius_m, g.actuator_outer_radius_m])
    z = np.array([0.0, g.chamber_length_m, g.actuator_length_m])
    return _axisymmetric(r, z, np.array([[False, True], [True, True]]))


def mould_shell(geometry: FingerGeometry, *, first_layer: bool = False) -> trimesh.Trimesh:
    """Return the outer half of the mould, a cup standing on its bottom.

    The silicone is cast in two layers with the thread between them, so there is a shell for each: the first layer ends
    at the rings' inner face, the second at the actuator's outer radius. Both fit the same core.
    """
    bore = first_layer_radius_m(geometry) if first_layer else geometry.actuator_outer_radius_m
    r = np.array([0.0, bore, shell_outer_radius_m(geometry)])
    z = np.array([0.0, MOULD_WALL_M, MOULD_WALL_M + geometry.actuator_length_m])
    return _axisymmetric(r, z, np.array([[True, False], [True, True]]))


def mould_core(geometry: FingerGeometry) -> trimesh.Trimesh:
    """Return the inner half of the mould: rod of the chamber on a flange with a collar that centres the shell.

    The flange is open at four slots between rod and shell, through which silicone is poured and air leaves.
    """
    g, outer = geometry, shell_outer_radius_m(geometry)
    collar = outer + MOULD_FIT_M
    inner = g.actuator_inner_radius_m
    r = np.array([0.0, inner, first_layer_radius_m(g), collar, collar + MOULD_WALL_M])
    flange, top = MOULD_WALL_M, MOULD_WALL_M + g.chamber_length_m
    z = np.array([0.0, flange, flange + COLLAR_HEIGHT_M, top])
    filled = np.zeros((4, SECTORS, 3), dtype=bool)
    filled[0] = True
    filled[:, :, 0] = True
    filled[3, :, :2] = True
    sector = SECTORS // POURING_SLOTS
    slot = np.arange(SECTORS) % sector < sector // 2
    filled[1, slot, 0] = False
    return Ring(r_m=r, theta_rad=_turn(), z_m=z, filled=filled).surface()


def first_layer_radius_m(geometry: FingerGeometry) -> float:
    """Outer radius of the silicone's first layer: the rings are wound on it [m]."""
    return geometry.ring_radius_m - 0.5 * geometry.ring_height_m


def shell_outer_radius_m(geometry: FingerGeometry) -> float:
    """Outer radius of both mould shells [m]."""
    return geometry.actuator_outer_radius_m + MOULD_WALL_M


def thinnest_wall_m(surface: trimesh.Trimesh) -> float:
    """Return the shortest way through the material, straight in from the middle of a facet [m].

    Facets that are turned copies of each other are measured once.
    """
    centre, normal = np.asarray(surface.triangles_center), np.asarray(surface.face_normals)
    radius = np.hypot(centre[:, 0], centre[:, 1])
    radial = (normal[:, :2] * centre[:, :2]).sum(axis=1) / np.maximum(radius, 1e-12)
    kind = np.round(np.stack([1e6 * radius, 1e6 * centre[:, 2], 1e3 * radial, 1e3 * normal[:, 2]], axis=1))
    _, chosen = np.unique(kind, axis=0, return_index=True)
    return min(_way_through(surface, centre[i], -normal[i]) for i in chosen)


def _way_through(surface: trimesh.Trimesh, start: F64, direction: F64) -> float:
    """Distance to the next facet (Moeller & Trumbore, Fast, minimum storage ray/triangle intersection, 1997)."""
    a, b, c = np.moveaxis(np.asarray(surface.triangles), 1, 0)
    u, v = b - a, c - a
    p = np.cross(direction, v)
    determinant = (u * p).sum(axis=1)
    safe = np.where(np.abs(determinant) < 1e-18, np.inf, determinant)
    s = start - a
    q = np.cross(s, u)
    first, second = (s * p).sum(axis=1) / safe, (q @ direction) / safe
    distance = (v * q).sum(axis=1) / safe
    tolerance = 1e-9
    hit = (first >= -tolerance) & (second >= -tolerance) & (first + second <= 1.0 + tolerance) & (distance > 1e-6)
    return float(distance[hit].min()) if hit.any() else np.inf


def _axisymmetric(r: F64, z: F64, filled: Bool) -> trimesh.Trimesh:
    whole = np.repeat(filled[:, None, :], SECTORS, axis=1)
    return Ring(r_m=r, theta_rad=_turn(), z_m=z, filled=whole).surface()


def _turn() -> F64:
    return np.linspace(0.0, 2.0 * np.pi, SECTORS, endpoint=False)
