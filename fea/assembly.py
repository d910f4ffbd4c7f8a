"""Finite-strain assembly: residual and tangent of 10- or 4-node tetrahedra with batched matrix products.

Potential: Pi(u) = sum over elements of [ integral W(F) + V kappa/2 (mean(det F) - 1)^2 ] - p V_cavity(u) - f . u.
The volumetric energy acts on each element's mean dilatation (P2 displacement, P0 pressure), which does not lock. In a
4-node element det F is uniform, so the mean changes nothing: P1 has the plain penalty and locks as kappa/mu grows, a
cheap rung for compressible parts and first looks. The referee with pressures of its own is :mod:`fea.mixed`. Every
term derives from a potential, so the tangent is symmetric and only its upper triangle is kept.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementTetP1, ElementTetP2

from fea.arrays import F64, I64
from fea.cavity import Cavity
from fea.compiled import compiled_law, kernel_name
from fea.gather import Gather
from fea.lattice import SolidMesh
from fea.laws import Law, cofactor_derivative
from fea.load import Load
from fea.ranges import map_ranges

_CHUNK = 1024  # elements per batch: keeps the batches in the processor's cache


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """Out-of-balance force and tangent at a displacement.

    Attributes
    ----------
    internal_n, external_n : arrays [n_free]
        Internal force and load at the free degrees of freedom; equilibrium where they agree.
    tangent : csr_array [n_free, n_free] or None
        Upper triangle of the tangent; None when only forces were asked for.
    reaction_n : array [n_nodes, 3]
        Internal force minus load at every node: the supports' reactions where displacements are prescribed.
    rank_one : array [n_free] or None
        h: the tangent still lacks h h'. With a supply, the pressure's force times the root of its stiffness.
    """

    internal_n: F64
    external_n: F64
    tangent: sp.csr_array | None
    reaction_n: F64
    rank_one: F64 | None = None


class SolidModel:
    """A mesh with laws, supports and one cavity, ready to be evaluated at displacements u [n_nodes, 3].

    Parameters
    ----------
    mesh : SolidMesh
    laws : mapping of material index to law
    fixed : boolean array [n_nodes, 3]
        Degrees of freedom whose displacement is prescribed.
    cavity : Cavity, optional
        Pressurised surface.
    quadrature_order : int
        Order of the rule in 10-node elements (2: four points, the usual one). Linear ones need one point.
    compiled : bool
        False: everything in NumPy, the reference of the compiled kernels (:mod:`fea.compiled`).
    """

    def __init__(
        self,
        *,
        mesh: SolidMesh,
        laws: dict[int, Law],
        fixed: np.ndarray,
        cavity: Cavity | None = None,
        quadrature_order: int = 2,
        compiled: bool = True,
    ) -> None:
        missing = set(np.unique(mesh.material)) - set(laws)
        if missing:
            raise ValueError(f"laws: no law for material index {sorted(int(m) for m in missing)}")
        self.mesh = mesh
        self.laws = laws
        self.cavity = cavity
        self.gradients, self.weights = element_gradients(mesh, quadrature_order if mesh.elements.shape[1] == 10 else 1)
        self._compiled = compiled and kernel_name() == "numba"
        self.free: I64 = np.flatnonzero(~fixed.ravel())
        number = np.full(fixed.size, -1, dtype=np.int64)
        number[self.free] = np.arange(len(self.free))
        self._build_pattern(number)

    def evaluate(self, u_m: F64, load: Load, *, tangent: bool = True) -> Evaluation | None:
        """Return forces and tangent at u [n_nodes, 3], or None if an element is inverted (det F <= 0)."""
        n, m = self.mesh.elements.shape
        size = 3 * m * (3 * m + 1) // 2
        force, entries = np.empty((n, m, 3)), np.empty(self._n_entries if tangent else 0)
        upper = entries[: n * size].reshape(n, size) if tangent else None
        for index, law in self.laws.items():
            if not self._fill(law, np.flatnonzero(self.mesh.material == index), u_m, force, upper):
                return None
        internal = np.zeros((len(self.mesh.points_m), 3))
        internal.reshape(-1)[self._nodal.places] = self._nodal.sum(force.reshape(-1), compiled=self._compiled)
        external = np.zeros_like(internal) if load.force_n is None else load.force_n.copy()
        rank_one: F64 | None = None
        if self.cavity is not None:
            gradient, hessian = self.cavity.derivatives(self.mesh.points_m + u_m)
            pressure = self.pressure_pa_gauge(u_m, load)
            external += pressure * gradient
            if tangent:
                r, c = np.triu_indices(hessian.shape[1])
                entries[n * size :] = (-pressure * hessian[:, r, c]).ravel()
            if load.supply is not None:
                rank_one = np.sqrt(load.supply.stiffness_pa_per_m3) * gradient.ravel()[self.free]
        matrix: sp.csr_array | None = None
        if tangent:
            data = self._matrix.sum(entries, compiled=self._compiled)
            matrix = sp.csr_array((data, *self._structure), shape=(len(self.free), len(self.free)))
        return Evaluation(
            internal_n=internal.ravel()[self.free],
            external_n=external.ravel()[self.free],
            tangent=matrix,
            reaction_n=internal - external,
            rank_one=rank_one,
        )

    def pressure_pa_gauge(self, u_m: F64, load: Load) -> float:
        """Return the gauge pressure in the cavity at displacements u."""
        if load.supply is None or self.cavity is None:
            return load.pressure_pa_gauge
        return load.pressure_at(self.cavity.volume_m3(self.mesh.points_m + u_m))

    def external(self, u_m: F64, load: Load) -> F64:
        """Return the load's nodal forces [n_nodes, 3] at displacements u."""
        force = np.zeros_like(u_m) if load.force_n is None else load.force_n.copy()
        if self.cavity is not None:
            force += self.pressure_pa_gauge(u_m, load) * self.cavity.gradient(self.mesh.points_m + u_m)
        return force

    def energy(self, u_m: F64, load: Load) -> float | None:
        """Return the total potential of the half model [J], or None if an element is inverted."""
        total = 0.0
        for index, law in self.laws.items():
            stored = self._stored(law, np.flatnonzero(self.mesh.material == index), u_m)
            if stored is None:
                return None
            total += stored
        if load.force_n is not None:
            total -= float((load.force_n * u_m).sum())
        if self.cavity is not None:
            volume = self.cavity.volume_m3(self.mesh.points_m + u_m)
            total -= load.pressure_pa_gauge * volume
            if load.supply is not None:
                total += 0.5 * load.supply.stiffness_pa_per_m3 * (volume - load.supply.volume_m3) ** 2
        return total

    def max_stretch(self, u_m: F64, material: int) -> float:
        """Return the largest principal stretch at the integration points of one material."""
        members = np.flatnonzero(self.mesh.material == material)
        F = deformation(u_m[self.mesh.elements[members]], self.gradients[members])
        return float(np.linalg.svd(F, compute_uv=False).max())

    def gravity_force(self, density_kg_m3: dict[int, float], acceleration_m_s2: F64) -> F64:
        """Return consistent nodal forces [n_nodes, 3] of a uniform acceleration."""
        shape = element_shapes(self.weights.shape[1], self.mesh.elements.shape[1])
        force = np.zeros((len(self.mesh.points_m), 3))
        density = np.array([density_kg_m3[int(m)] for m in self.mesh.material])
        lumped = np.einsum("e,eq,qa->ea", density, self.weights, shape)
        np.add.at(force, self.mesh.elements, lumped[:, :, None] * acceleration_m_s2)
        return force

    def _stored(self, law: Law, members: I64, u_m: F64) -> float | None:
        """Return the strain energy of some elements of one law [J], or None if one is inverted."""

        def part(start: int, stop: int) -> float | None:
            chunk = members[start:stop]
            F = deformation(u_m[self.mesh.elements[chunk]], self.gradients[chunk])
            J = np.linalg.det(F)
            if not (J > 0.0).all():
                return None
            weights = self.weights[chunk]
            sizes = weights.sum(axis=1)
            mean = (J * weights).sum(axis=1) / sizes
            volumetric = 0.5 * law.bulk_modulus_pa * (sizes * (mean - 1.0) ** 2).sum()
            return float((law.energy(F) * weights).sum() + volumetric)

        total = 0.0
        for energy in map_ranges(part, len(members), _CHUNK):
            if energy is None:
                return None
            total += energy
        return total

    def _fill(self, law: Law, members: I64, u_m: F64, force: F64, upper: F64 | None) -> bool:
        """Fill the members' rows of forces and upper triangles; False where an element is inverted."""
        elements = self.mesh.elements
        kernel = compiled_law(law) if self._compiled else None
        if kernel is not None:
            return kernel.fill(u_m, elements, members, (self.gradients, self.weights), force, upper)
        for start in range(0, len(members), _CHUNK):
            chunk = members[start : start + _CHUNK]
            result = element_forces(law, u_m[elements[chunk]], self.gradients[chunk], self.weights[chunk])
            if result is None:
                return False
            force[chunk] = result[0]
            if upper is not None:
                upper[chunk] = result[1]
        return True

    def _build_pattern(self, number: I64) -> None:
        """Build the upper triangle's numbering once: element entries first, then those of cavity faces."""
        n = len(self.mesh.elements)
        places = (3 * self.mesh.elements[:, :, None] + np.arange(3)).reshape(n, -1)
        self._nodal = Gather.of(places.ravel())
        dofs = number[places]
        r, c = np.triu_indices(dofs.shape[1])
        rows, columns = [dofs[:, r].ravel()], [dofs[:, c].ravel()]
        if self.cavity is not None:
            face = number[(3 * self.cavity.faces[:, :, None] + np.arange(3)).reshape(len(self.cavity.faces), -1)]
            r, c = np.triu_indices(face.shape[1])
            rows.append(face[:, r].ravel())
            columns.append(face[:, c].ravel())
        row, column = np.concatenate(rows), np.concatenate(columns)
        low, high = np.minimum(row, column), np.maximum(row, column)
        size = len(self.free)
        self._n_entries = len(low)
        self._matrix = Gather.of(np.where(low >= 0, low * size + high, -1))
        pointer = np.searchsorted(self._matrix.places, np.arange(size + 1) * np.int64(size))
        self._structure = (self._matrix.places % size, pointer)


def element_gradients(mesh: SolidMesh, order: int) -> tuple[F64, F64]:
    """Return shape-function gradients [n_elements, n_points, 10 or 4, 3] and weights [n_elements, n_points] [m^3].

    Raises
    ------
    ValueError
        If an undeformed element is inverted.
    """
    element = ElementTetP2() if mesh.elements.shape[1] == 10 else ElementTetP1()
    basis = Basis(mesh.skfem_mesh, element, intorder=order)
    gradients = np.stack([np.moveaxis(np.asarray(f[0].grad), 0, -1) for f in basis.basis], axis=2)
    jacobian = np.linalg.det(np.asarray(basis.mapping.DF(basis.X)).transpose(2, 3, 0, 1))
    if not (np.abs(np.sign(jacobian).sum(axis=1)) == jacobian.shape[1]).all():
        raise ValueError("mesh: an undeformed element is inverted")
    return np.ascontiguousarray(gradients), np.ascontiguousarray(basis.dx)


def element_shapes(n_points: int, n_nodes: int = 10) -> F64:
    """Return shape functions [n_points, n_nodes] at the points of the four-point rule (P2) or the centroid (P1)."""
    if (n_points, n_nodes) == (1, 4):
        return np.full((1, 4), 0.25)
    from skfem.quadrature import get_quadrature  # noqa: PLC0415

    points, _ = get_quadrature(ElementTetP2, 2)
    if points.shape[1] != n_points:
        raise ValueError(f"n_points = {n_points}; only the rule of order 2 ({points.shape[1]} points) is supported")
    element = ElementTetP2()
    return np.stack([element.lbasis(points, a)[0] for a in range(10)], axis=1)


def deformation(u_m: F64, gradients: F64) -> F64:
    """Return F = I + du/dX [n, n_points, 3, 3] of element displacements [n, 10, 3]."""
    F = np.swapaxes(u_m, -1, -2)[:, None] @ gradients
    F[..., np.arange(3), np.arange(3)] += 1.0
    return np.asarray(F)


def element_forces(law: Law, u_m: F64, gradients: F64, weights: F64) -> tuple[F64, F64] | None:
    """Return forces [n, m, 3] and the stiffness' upper triangles [n, 3m (3m + 1) / 2], or None where det F <= 0.

    ``u_m`` is [n, m, 3] and ``gradients`` [n, n_points, m, 3] with m nodes an element.

    With g = dJ/dF (cofactor), the mean dilatation adds kappa (J - 1) (g, d2J/dF2) pointwise and the rank-one term
    kappa / V (integral g)(integral g) per element.
    """
    n, points = weights.shape
    m = gradients.shape[2]
    row, column = np.triu_indices(3 * m)  # in (node, component) numbering
    F = deformation(u_m, gradients)
    J = np.linalg.det(F)
    if not (J > 0.0).all():
        return None
    P, A = law.stress_and_tangent(F)
    kappa = law.bulk_modulus_pa
    weighted = gradients * weights[..., None, None]
    rank_one: F64 | None = None
    if kappa > 0.0:
        cofactor = J[..., None, None] * np.swapaxes(np.linalg.inv(F), -1, -2)
        volume = weights.sum(axis=1)
        pressure = kappa * ((J * weights).sum(axis=1) / volume - 1.0)
        P = P + pressure[:, None, None, None] * cofactor
        A = A + pressure[:, None, None, None, None, None] * cofactor_derivative(F)
        rank_one = (weighted @ np.swapaxes(cofactor, -1, -2)).sum(axis=1).reshape(n, 3 * m)
        rank_one *= np.sqrt(kappa / volume)[:, None]
    force = (weighted @ np.swapaxes(P, -1, -2)).sum(axis=1)
    # K_aibj = sum_qJ w G_aJ (sum_L A_iJjL G_bL), the inner sum first
    inner = np.ascontiguousarray(np.swapaxes(A, 2, 3)).reshape(n, points, 27, 3) @ np.swapaxes(gradients, -1, -2)
    left = np.ascontiguousarray(weighted.transpose(0, 2, 1, 3)).reshape(n, m, 3 * points)
    K = (left @ inner.reshape(n, 3 * points, 9 * m)).reshape(n, 9 * m * m)
    # position of entry (3a + i, 3b + j) in the layout (a, i, j, b)
    a, i, b, j = row // 3, row % 3, column // 3, column % 3
    upper = K[:, ((a * 3 + i) * 3 + j) * m + b]
    if rank_one is not None:
        upper += rank_one[:, row] * rank_one[:, column]
    return force, upper
