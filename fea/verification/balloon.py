"""Neo-Hookean balloon inflated past its limit point by volume control.

Thick incompressible sphere (Beatty, 1987, Appl. Mech. Rev. 40): with l = r/R at the inner and outer surface,
    p = mu [2 / l_b + 1 / (2 l_b^4) - 2 / l_a - 1 / (2 l_a^4)],      l_b^3 = 1 + (l_a^3 - 1) (A/B)^3,
which rises to a maximum and falls. The cavity's volume is V0 l_a^3.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from fea.arrays import F64
from fea.assembly import SolidModel
from fea.cavity import Cavity
from fea.lattice import free_faces
from fea.newton import NewtonOptions
from fea.rubber import neo_hookean
from fea.verification.common import Row, symmetry_planes
from fea.verification.inflation import INNER_M, sphere_mesh
from fea.volume_control import VolumePath, inflate_by_volume

SHEAR_MODULUS_PA, RATIO = 1e5, 1.4


def closed_form_pressure(volume_ratio: F64) -> F64:
    """Return p [Pa] at V/V0."""
    inner = volume_ratio ** (1.0 / 3.0)
    outer = (1.0 + (volume_ratio - 1.0) / RATIO**3) ** (1.0 / 3.0)
    bracket = 2.0 / outer + 0.5 / outer**4 - 2.0 / inner - 0.5 / inner**4
    return np.asarray(SHEAR_MODULUS_PA * bracket)


def balloon(volume_ratios: list[float], *, cells: int = 3, stop_at_limit: bool = False) -> tuple[VolumePath, F64, int]:
    """Return the path, the closed form's pressures at its volumes, and the number of unknowns (P2/P0)."""
    mesh = sphere_mesh(cells, 2, RATIO * INNER_M)
    cavity = Cavity(free_faces(mesh, lambda c: np.isclose(c[..., 2], INNER_M)), len(mesh.points_m))
    law = neo_hookean(SHEAR_MODULUS_PA, 5e3 * SHEAR_MODULUS_PA)
    model = SolidModel(mesh=mesh, laws={0: law}, fixed=symmetry_planes(mesh), cavity=cavity)
    rest = cavity.volume_m3(mesh.points_m)
    options = NewtonOptions(step_cap_m=INNER_M, relative_tolerance=1e-7)
    path = inflate_by_volume(model, [rest * v for v in volume_ratios], options, stop_at_limit=stop_at_limit)
    return path, closed_form_pressure(path.volume_m3 / rest), len(model.free)


def balloon_rows() -> list[Row]:
    """Return the greatest pressure, and the pressure well beyond it."""
    path, closed, dofs = balloon([1.2, 1.6, 2.0, 2.6, 3.2, 4.0, 5.0, 6.5, 8.0])
    if path.limit is None:
        raise RuntimeError(f"balloon: no limit point found, {path.status.value}")
    found = minimize_scalar(lambda v: -float(closed_form_pressure(np.array(v))), bounds=(1.1, 8.0), method="bounded")
    pairs = (
        ("greatest pressure [Pa]", path.limit.pressure_pa_gauge, -float(found.fun)),
        ("pressure [Pa] at 8 V0", float(path.pressure_pa_gauge[-1]), float(closed[-1])),
    )
    name = "balloon past its limit point, neo-Hookean"
    return [
        Row(problem=name, formulation="P2/P0", dofs=dofs, quantity=quantity, figure=figure, exact=exact)
        for quantity, figure, exact in pairs
    ]
