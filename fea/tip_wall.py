"""A rigid plane in front of the fingertip that it pushes against: the force sensor of the blocked test."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fea.arrays import F64, I64
from fea.contact_interface import ContactState
from fea.geometry import FingerGeometry
from fea.lattice import SolidMesh

SENSOR_DISTANCE_M = 40e-3
"""Distance of finger and force sensor: Alves et al., section 3.2. Choice: measured from the palm side of the tip to the
sensor's plane, parallel to the straight finger; the figure is not available."""
STIFFNESS_N_PER_M = 2e3
"""Choice: of a node of the half model; 0.3 N on a single one press it 0.08 mm into the plane, of 40 mm of way."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TipWall:
    """Plane x = ``position_m``, frictionless, with a spring on each node that passes it.

    Attributes
    ----------
    points_m : array [n_nodes, 3]
        Undeformed nodes of the mesh.
    nodes : array
        Those that may touch.
    position_m, stiffness_n_per_m : float
    """

    points_m: F64
    nodes: I64
    position_m: float
    stiffness_n_per_m: float = STIFFNESS_N_PER_M

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:  # noqa: ARG002 - never indefinite
        """Return forces and Hessian at displacements [n_nodes, 3]."""
        touched = 3 * self.nodes[self._depth(u_m) > 0.0]
        values = np.full(len(touched), self.stiffness_n_per_m)
        hessian = sp.csr_array((values, (touched, touched)), shape=(u_m.size,) * 2)
        return ContactState(force_n=self.force_n(u_m), hessian=hessian)

    def force_n(self, u_m: F64) -> F64:
        """Return the forces alone [n_nodes, 3]."""
        force = np.zeros_like(u_m)
        force[self.nodes, 0] = -self.stiffness_n_per_m * self._depth(u_m)
        return force

    def energy(self, u_m: F64) -> float:
        """Return the springs' energy [J]."""
        return 0.5 * self.stiffness_n_per_m * float((self._depth(u_m) ** 2).sum())

    def held(self, _u_m: F64, /) -> "TipWall":
        """Return itself: its forces have an energy."""
        return self

    def following(self, _u_m: F64, /) -> "TipWall":
        """Return itself."""
        return self

    def step_bound(self, u_m: F64, trial_m: F64) -> float:  # noqa: ARG002 - springs may be passed
        """Return 1: any step may be tried."""
        return 1.0

    def push_n(self, u_m: F64) -> float:
        """Return the force on the wall by the modelled half [N]."""
        return self.stiffness_n_per_m * float(self._depth(u_m).sum())

    def _depth(self, u_m: F64) -> F64:
        x = self.points_m[self.nodes, 0] + u_m[self.nodes, 0]
        return np.asarray(np.maximum(0.0, x - self.position_m))


def tip_wall(mesh: SolidMesh, geometry: FingerGeometry, *, distance_m: float = SENSOR_DISTANCE_M) -> TipWall:
    """Return the sensor's plane at a distance from the palm side of the last phalanx.

    Raises
    ------
    ValueError
        If the distance is not positive.
    """
    if not distance_m > 0.0:
        raise ValueError(f"distance_m = {distance_m} must be positive")
    last = geometry.gap_start_m[-1] + geometry.gap_length_m
    nodes = np.flatnonzero(mesh.cylindrical[:, 2] >= last - 1e-9)
    return TipWall(points_m=mesh.points_m, nodes=nodes, position_m=geometry.tube_outer_radius_m + distance_m)
