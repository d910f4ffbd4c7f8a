"""Fields derived from a displacement: von Mises strain and stress, per integration point, element and node."""

from dataclasses import dataclass

import numpy as np
from skfem import ElementTetP2
from skfem.quadrature import get_quadrature

from fea.arrays import F64
from fea.assembly import SolidModel, deformation, element_shapes

_EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])  # of the 10-node tetrahedron's mid-edge nodes


@dataclass(frozen=True, kw_only=True, eq=False)
class Fields:
    """Von Mises measures at the integration points, arrays [n_elements, n_points].

    Attributes
    ----------
    strain : array
        sqrt(2/3 e:e) of the deviator e of the logarithmic (Hencky) strain; equals |ln(stretch)| in uniaxial tension
        of an incompressible material.
    stress_pa : array
        sqrt(3/2 s:s) of the deviator s of the Cauchy stress.
    """

    strain: F64
    stress_pa: F64

    def element_strain(self) -> F64:
        """Return each element's mean strain [n_elements]."""
        return np.asarray(self.strain.mean(axis=1))

    def element_stress_pa(self) -> F64:
        """Return each element's mean stress [n_elements]."""
        return np.asarray(self.stress_pa.mean(axis=1))


def von_mises_fields(model: SolidModel, u_m: F64) -> Fields:
    """Return von Mises strain and stress at a displacement [n_nodes, 3].

    The element-mean pressure of the formulation is spherical and leaves the von Mises stress alone.
    """
    shape = model.weights.shape
    strain, stress = np.zeros(shape), np.zeros(shape)
    for index, law in model.laws.items():
        members = np.flatnonzero(model.mesh.material == index)
        for chunk in np.array_split(members, max(1, len(members) // 4096)):
            F = deformation(u_m[model.mesh.elements[chunk]], model.gradients[chunk])
            strain[chunk] = hencky_strain(F)
            P, _ = law.stress_and_tangent(F)
            cauchy = P @ np.swapaxes(F, -1, -2) / np.linalg.det(F)[..., None, None]
            mean = np.trace(cauchy, axis1=-2, axis2=-1) / 3.0
            deviator = cauchy - mean[..., None, None] * np.eye(3)
            stress[chunk] = np.sqrt(1.5 * (deviator**2).sum(axis=(-1, -2)))
    return Fields(strain=strain, stress_pa=stress)


def point_positions(model: SolidModel) -> F64:
    """Return undeformed (r, theta, z) of the integration points [n_elements, n_points, 3]."""
    shapes = element_shapes(model.weights.shape[1])
    x = np.einsum("qa,eai->eqi", shapes, model.mesh.points_m[model.mesh.elements])
    return np.stack([np.hypot(x[..., 0], x[..., 1]), np.arctan2(x[..., 1], x[..., 0]), x[..., 2]], axis=-1)


def node_strain(model: SolidModel, u_m: F64, material: int | None = None) -> F64:
    """Return the von Mises strain at the nodes [n_nodes], averaged over the elements around each; 0 elsewhere.

    F varies almost linearly in a 10-node tetrahedron, so it is extrapolated from the four integration points to the
    vertices; a mid-edge node takes the mean of its edge's ends. With ``material`` only that material's elements count.
    """
    mesh = model.mesh
    members = np.arange(len(mesh.elements)) if material is None else np.flatnonzero(mesh.material == material)
    points, _ = get_quadrature(ElementTetP2, 2)
    to_vertices = np.linalg.inv(np.vstack([1.0 - points.sum(axis=0), points]).T)
    total, count = np.zeros(len(mesh.points_m)), np.zeros(len(mesh.points_m))
    for chunk in np.array_split(members, max(1, len(members) // 4096)):
        elements = mesh.elements[chunk]
        F = deformation(u_m[elements], model.gradients[chunk])
        at_vertices = hencky_strain(np.einsum("vq,eqij->evij", to_vertices, F))
        ends = at_vertices[:, _EDGES].mean(axis=-1)
        values = np.concatenate([at_vertices, ends], axis=1)
        np.add.at(total, elements, values)
        np.add.at(count, elements, 1.0)
    return total / np.maximum(count, 1.0)


def hencky_strain(F: F64) -> F64:
    """Return the von Mises measure of the logarithmic strain, shape [...], of F, shape [..., 3, 3]."""
    squared = np.linalg.eigvalsh(np.swapaxes(F, -1, -2) @ F)
    hencky = 0.5 * np.log(np.maximum(squared, 1e-12))
    hencky -= hencky.mean(axis=-1, keepdims=True)
    return np.asarray(np.sqrt(2.0 / 3.0 * (hencky**2).sum(axis=-1)))
