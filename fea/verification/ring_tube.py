"""Closed tube whose wall holds a sheet of inextensible rings at radius r_w: pressure lengthens it.

The rings keep r(r_w) = r_w; the incompressible wall then has the hoop stretch t(R) with
R^2 t^2 = r_w^2 - (r_w^2 - R^2) / l at axial stretch l. Virtual work of the closed ends gives, as the pressure acts on
the ring radius,
    p pi r_w^2 = d/dl integral from r_i to r_o of 2 pi R W(l, t, 1 / (l t)) dR.
"""

import numpy as np
from scipy.integrate import quad

from fea.assembly import SolidModel
from fea.cavity import Cavity
from fea.lattice import free_faces
from fea.laws import IsochoricOgden
from fea.load import Load
from fea.meshes import rectangle, sweep
from fea.newton import NewtonOptions, solve_equilibrium
from fea.verification.common import Row, symmetry_planes
from fea.verification.inflation import LAWS
from fea.workspace import workspace

INNER_M, RING_M, OUTER_M = 4e-3, 5e-3, 6e-3  # the fact sheet's first example


def closed_form_pressure(law: IsochoricOgden, stretch: float) -> float:
    """Return p [Pa] at the axial stretch."""

    def energy(axial: float) -> float:
        def ring(radius: float) -> float:
            hoop = np.sqrt(RING_M**2 - (RING_M**2 - radius**2) / axial) / radius
            F = np.diag([axial, hoop, 1.0 / (axial * hoop)])
            return float(2.0 * np.pi * radius * law.energy(F))

        return float(quad(ring, INNER_M, OUTER_M, epsabs=0.0, epsrel=1e-12)[0])

    h = 1e-4
    return (energy(stretch + h) - energy(stretch - h)) / (2.0 * h) / (np.pi * RING_M**2)


def ring_tube(law_name: str = "Ogden", *, stretch: float = 1.3, cells: int = 2) -> Row:
    """Find the pressure at which the ends of the stretched tube are in balance (P2/P0, ``cells`` in either layer)."""
    r = np.linspace(INNER_M, OUTER_M, 2 * cells + 1)
    height = 1e-3

    def position(x: np.ndarray) -> np.ndarray:
        flat = x[:, 0] * np.stack([np.cos(x[:, 1]), np.sin(x[:, 1])])
        return np.column_stack([*np.where(np.abs(flat) < 1e-14, 0.0, flat), x[:, 2]])

    mesh = sweep(rectangle(r, np.linspace(0.0, 0.5 * np.pi, 2 * cells + 2)), np.array([0.0, height]), position)
    fixed = symmetry_planes(mesh)
    z = mesh.cylindrical[:, 2]
    fixed[np.isclose(mesh.cylindrical[:, 0], RING_M), :2] = True
    top = np.isclose(z, height)
    fixed[top, 2] = True
    cavity = Cavity(free_faces(mesh, lambda c: np.isclose(c[..., 0], INNER_M)), len(z))
    model = SolidModel(mesh=mesh, laws={0: LAWS[law_name]}, fixed=fixed, cavity=cavity)
    options, work = NewtonOptions(relative_tolerance=1e-7, step_cap_m=height), workspace(model)
    # the shape of the incompressible wall is known and no function of p: what is looked for are the forces
    radius = np.hypot(*mesh.points_m[:, :2].T)
    growth = np.sqrt(RING_M**2 - (RING_M**2 - radius**2) / stretch) / radius - 1.0
    u = mesh.points_m * np.column_stack([growth, growth, np.full(len(z), stretch - 1.0)])

    def end_force(pressure: float) -> float:
        nonlocal u
        outcome = solve_equilibrium(work, u, Load(pressure_pa_gauge=pressure), options)
        if not outcome.converged:
            raise RuntimeError(f"ring tube: {outcome.status.value}")
        u = outcome.u_m
        state = model.evaluate(u, Load(pressure_pa_gauge=pressure), tangent=False)
        assert state is not None
        return float(state.reaction_n[top, 2].sum())

    pressure, other = 0.0, 1e4
    force, next_force = end_force(pressure), end_force(other)
    for _ in range(4):
        pressure, other, force = other, other - next_force * (other - pressure) / (next_force - force), next_force
        next_force = end_force(other)
        if abs(other - pressure) < 1e-6 * abs(other):
            break
    work.close()
    return Row(
        problem=f"ring-reinforced tube, {law_name}",
        formulation="P2/P0",
        dofs=len(model.free),
        quantity=f"pressure [Pa] at axial stretch {stretch:g}",
        figure=other,
        exact=closed_form_pressure(LAWS[law_name], stretch),
    )
