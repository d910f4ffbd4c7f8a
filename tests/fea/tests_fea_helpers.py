"""Models and made-up results shared by the tests of the finite-element lab."""

from collections.abc import Callable

import numpy as np

from fea.assembly import SolidModel
from fea.cavity import Cavity
from fea.finger import FingerResult
from fea.lattice import Lattice, build_mesh, free_faces, symmetry_nodes
from fea.newton import Status
from fea.surrogate import Surrogate

TURNED = 0.3
"""How far down the way back goes, as a share of the last pressure."""


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


def finger_like(surrogate: Surrogate, pressures: list[float], bulging: Callable[[float], float]) -> FingerResult:
    """What analysis (iii) would return if the finger were a surrogate: bulging(lengthening) is volume per pressure.

    With friction also the way back, whose slip has turned from its first state on (a very stiff friction).
    """
    way_back = (
        [p for p in pressures[-2::-1] if p >= TURNED * pressures[-1]] if surrogate.sliding.stiffness_n_per_m else []
    )
    pressure = np.array([0.0, *pressures, *way_back])
    up = [surrogate.angles(p) for p in (0.0, *pressures)]
    angle = np.array([*up, *(surrogate.unloading_angles(p) for p in way_back)])
    lengthening = [surrogate.lengthening_m(q) for q in angle]
    volume = [surrogate.chamber.volume(d, 0.0) + p * bulging(d) for p, d in zip(pressure, lengthening, strict=True)]
    return finger_result(pressure, angle, np.array(volume))


def finger_result(pressure, angle, volume) -> FingerResult:
    """A result of analysis (iii) of which only angles and volume matter."""
    zero = np.zeros_like(pressure)
    top = int(np.argmax(pressure))
    return FingerResult(
        branch=tuple("loading" if k <= top else "unloading" for k in range(len(pressure))),
        pressure_pa_gauge=pressure,
        tip_load_n=zero,
        tip_angle_rad=angle.sum(axis=1),
        joint_angle_rad=angle,
        tip_displacement_m=zero,
        volume_m3=volume,
        minimum_gap_m=zero,
        contact_force_n=zero,
        contact_pressure_pa=zero,
        slip_m=zero,
        tip_force_n=zero,
        u_m=np.zeros((1, 3)),
        status=Status.CONVERGED,
        iterations=0,
        dofs=1,
        elements=1,
    )
