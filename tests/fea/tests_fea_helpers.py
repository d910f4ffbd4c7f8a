"""Models shared by the tests of the finite-element lab."""

import numpy as np

from fea.assembly import SolidModel
from fea.cavity import Cavity
from fea.lattice import Lattice, build_mesh, free_faces, symmetry_nodes


def tube_model(lattice: Lattice, laws: dict) -> SolidModel:
    """A tube between two planes that slide in themselves: both ends keep their u_z, the lower one at 0."""
    mesh = build_mesh(lattice)
    fixed = np.zeros((len(mesh.points_m), 3), dtype=bool)
    fixed[symmetry_nodes(mesh), 1] = True
    z = mesh.cylindrical[:, 2]
    fixed[(z == z.min()) | (z == z.max()), 2] = True
    inner = lattice.r_m[0]
    cavity = Cavity(free_faces(mesh, lambda c: np.isclose(c[..., 0], inner)), len(mesh.points_m))
    # by symmetry a point above the axis stays above it: this keeps the tube from sliding along x
    pin = int(np.flatnonzero((z == z.min()) & np.isclose(mesh.cylindrical[:, 1], np.pi / 2))[0])
    fixed[pin, 0] = True
    return SolidModel(mesh=mesh, laws=laws, fixed=fixed, cavity=cavity)
