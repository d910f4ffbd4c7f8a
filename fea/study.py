"""The analyses as studies: from a setup to figures for JSON and the states for fields and pictures."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from fea.actuator import SILICONE, actuator_model, analyse_actuator
from fea.arrays import F64
from fea.assembly import SolidModel
from fea.checkpoint import code_version
from fea.compiled import kernel_name
from fea.density import Density
from fea.exoskeleton import analyse_exoskeleton, exoskeleton_model
from fea.fields import node_strain, point_positions, von_mises_fields
from fea.finger import CONTACT, FRICTION, analyse_finger, finger_model, finger_weight
from fea.finger import MESHES as FINGER_MESHES
from fea.finger_path import FingerPath
from fea.geometry import JOINT_NAMES, FingerGeometry
from fea.linear_solver import solver_name
from fea.materials import Material
from fea.newton import Status
from fea.path import Step, Sweep
from fea.quality import mesh_quality
from fea.tip_wall import tip_wall

MOST_GRAVITY_M_PER_S2 = 100.0
"""Choice: ten times the earth's; a larger one is a mistake of units."""


@dataclass(frozen=True, kw_only=True)
class FingerCase:
    """What is done with the complete finger.

    Attributes
    ----------
    friction : float
        Coulomb's coefficient of silicone on TPU, 0 to 2.
    unload : bool
        Go back to zero pressure.
    tip_loads_n : tuple of float
        Increasing loads on the tip at the last pressure, instead of the way back.
    sensor_distance_m : float or None
        Distance of a wall in front of the tip; None: the tip is free.
    no_separation : bool
        The actuator does not leave the walls of the tube's sections.
    gravity_m_per_s2 : tuple of two floats or None
        The finger has its weight, under gravity in its plane of symmetry: towards the palm side, and along the straight
        finger to its tip. None: it has no weight.
    """

    friction: float = FRICTION
    unload: bool = True
    tip_loads_n: tuple[float, ...] = ()
    sensor_distance_m: float | None = None
    no_separation: bool = False
    gravity_m_per_s2: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        replace(CONTACT, friction=self.friction)
        gravity = self.gravity_m_per_s2
        if gravity is not None and not (len(gravity) == 2 and np.hypot(*gravity) <= MOST_GRAVITY_M_PER_S2):
            raise ValueError(
                f"gravity_m_per_s2 = {gravity} must be two numbers (palm side, tip) of at most "
                f"{MOST_GRAVITY_M_PER_S2:g} together"
            )
        if self.sensor_distance_m is not None and not 0.0 < self.sensor_distance_m < 0.2:
            raise ValueError(f"sensor_distance_m = {self.sensor_distance_m} must lie in (0, 0.2) m")
        self.path((1.0,))

    def path(self, pressures_pa_gauge: Sequence[float]) -> FingerPath:
        """Return what the finger goes through."""
        return FingerPath(tuple(pressures_pa_gauge), self.unload, self.tip_loads_n)


@dataclass(frozen=True, kw_only=True)
class Setup:
    """What is analysed: dimensions, materials, mesh density, rings or none, and what the finger goes through."""

    geometry: FingerGeometry
    silicone: Material
    tpu: Material
    pet: Material
    density: Density
    rings: bool = True
    finger: FingerCase = FingerCase()

    def identity(self, analysis: str, levels: Sequence[float]) -> dict[str, Any]:
        """Return what tells a run of this setup from others (:class:`fea.checkpoint.Checkpoints`)."""
        materials = (self.silicone, self.tpu, self.pet)
        return {
            "analysis": analysis,
            "geometry": self.geometry.as_dict(),
            "materials": [dict(m.parameters) for m in materials],
            "mesh": [asdict(self.density.actuator), asdict(self.density.exoskeleton), self.rings],
            "loads": list(levels),
            "finger": asdict(self.finger),
            "code": code_version(),
        }

    def provenance(self) -> dict[str, Any]:
        """Return materials, mesh and solver, JSON ready."""
        materials = {"silicone": self.silicone, "tpu": self.tpu, "pet": self.pet}
        return {
            "geometry": self.geometry.as_dict(),
            "materials": {
                part: {"name": m.name, "set": m.parameter_set, "source": m.source, "parameters": dict(m.parameters)}
                for part, m in materials.items()
            },
            "density": self.density.name,
            "rings": self.rings,
            "finger": asdict(self.finger),
            "linear_solver": solver_name(),
            "element_kernels": kernel_name(),
            "code_sha256": code_version(),
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Study:
    """A solved analysis.

    Attributes
    ----------
    model : SolidModel
    levels : array [n]
        Pressure [Pa gauge] or load [N] of each state, the unloaded (or self-weight) one first.
    states : list of arrays [n_nodes, 3]
        Displacement at each level.
    status : Status
        How the path ended.
    figures : dict
        Everything for the JSON file.
    """

    model: SolidModel
    levels: F64
    states: list[F64]
    status: Status
    figures: dict[str, Any]


def actuator_study(setup: Setup, pressures_pa_gauge: Sequence[float], sweep: Sweep) -> Study:
    """Analysis (i): inflate the actuator alone.

    The wall's thickness is the difference of the mean outer and inner radii, two pitches long about mid-length.
    """
    g = setup.geometry
    model = actuator_model(g, setup.silicone, setup.pet, setup.density.actuator, rings=setup.rings)
    sweep, kept = _keeping(sweep)
    result = analyse_actuator(model, g, list(pressures_pa_gauge), sweep=sweep)
    states = [np.zeros_like(model.mesh.points_m), *(kept[p] for p in result.pressure_pa_gauge[1:])]
    strains = [_silicone_maximum(model, u) for u in states]
    figures = {
        "pressure_pa_gauge": result.pressure_pa_gauge.tolist(),
        "axial_stretch": (1.0 + result.elongation).tolist(),
        "outer_radius_growth": (result.radial_growth_m / g.actuator_outer_radius_m).tolist(),
        "wall_thickness_m": [_wall_m(model, g, u) for u in states],
        "volume_m3": result.volume_m3.tolist(),
        "max_von_mises_strain": [value for value, _ in strains],
        "max_von_mises_strain_radius_m": [radius for _, radius in strains],
    }
    return _study(model, result, result.pressure_pa_gauge, states, figures)


def exoskeleton_study(setup: Setup, loads_n: Sequence[float], sweep: Sweep) -> Study:
    """Analysis (ii): load the exoskeleton at its distal joint, on top of its self-weight."""
    g = setup.geometry
    model = exoskeleton_model(g, setup.tpu, setup.density.exoskeleton)
    sweep, kept = _keeping(sweep)
    result = analyse_exoskeleton(model, g, setup.tpu, loads_n=tuple(loads_n), sweep=sweep)
    parameters = [1.0, *(1.0 + load for load in loads_n)]
    states = [kept[s] for s in parameters[: len(result.load_n)]]
    stresses = [stress_maximum(model, g, u) for u in states]
    figures = {
        "load_n": result.load_n.tolist(),
        "tip_deflection_m": result.tip_deflection_m.tolist(),
        "joint_rotation_rad": result.angle_rad.tolist(),
        "max_von_mises_stress_pa": [value for value, _ in stresses],
        "stress_maximum_at": [joint for _, joint in stresses],
    }
    return _study(model, result, result.load_n, states, figures)


def finger_study(setup: Setup, pressures_pa_gauge: Sequence[float], sweep: Sweep) -> Study:
    """Analysis (iii): inflate the actuator inside the exoskeleton, and deflate it again."""
    case, g = setup.finger, setup.geometry
    contact = replace(CONTACT, friction=case.friction)
    mesh = FINGER_MESHES[setup.density.name]
    model = finger_model(
        g, setup.silicone, setup.pet, setup.tpu, mesh, contact=contact, no_separation=case.no_separation
    )
    wall = None
    if case.sensor_distance_m is not None:
        wall = tip_wall(model.solid.mesh, g, distance_m=case.sensor_distance_m)
    weight = None
    if case.gravity_m_per_s2 is not None:
        weight = finger_weight(model, setup.silicone, setup.pet, setup.tpu, case.gravity_m_per_s2)
    sweep, kept = _keeping(sweep)
    path = case.path(pressures_pa_gauge)
    result = analyse_finger(model, g, path, wall=wall, weight_n=weight, sweep=sweep)
    parameters = path.targets[: len(result.branch) - 1]
    states = [np.zeros_like(model.solid.mesh.points_m), *(kept[parameter] for parameter in parameters)]
    figures = {
        "branch": list(result.branch),
        "pressure_pa_gauge": result.pressure_pa_gauge.tolist(),
        "tip_angle_deg": np.rad2deg(result.tip_angle_rad).tolist(),
        "joint_rotation_rad": result.joint_angle_rad.tolist(),
        "tip_displacement_m": result.tip_displacement_m.tolist(),
        "volume_m3": result.volume_m3.tolist(),
        "tip_force_n": result.tip_force_n.tolist(),
        "tip_load_n": result.tip_load_n.tolist(),
        "contact_force_n": result.contact_force_n.tolist(),
        "contact_pressure_pa": result.contact_pressure_pa.tolist(),
        "slip_m": result.slip_m.tolist(),
        "max_von_mises_strain": [_silicone_maximum(model.solid, u)[0] for u in states],
    }
    return _study(model.solid, result, result.pressure_pa_gauge, states, figures)


def stress_maximum(model: SolidModel, geometry: FingerGeometry, u_m: F64) -> tuple[float, str]:
    """Return the largest element-mean von Mises stress [Pa] and the name of the joint nearest to it.

    Means over elements are compared, since the stress at the flexures' sharp corners grows with mesh density.
    """
    stress = von_mises_fields(model, u_m).element_stress_pa()
    worst = int(np.argmax(stress))
    height = point_positions(model)[worst, :, 2].mean()
    nearest = int(np.argmin(np.abs(np.array(geometry.joint_position_m) - height)))
    return float(stress[worst]), JOINT_NAMES[nearest]


def _study(model: SolidModel, result: Any, levels: F64, states: list[F64], figures: dict[str, Any]) -> Study:
    quality = mesh_quality(model.mesh)
    more = {
        "status": result.status.value,
        "dofs": result.dofs,
        "elements": result.elements,
        "element_quality": asdict(quality),
        **result.cost.as_dict(),
    }
    return Study(model=model, levels=levels, states=states, status=result.status, figures=figures | more)


def _keeping(sweep: Sweep) -> tuple[Sweep, dict[float, F64]]:
    """Return a sweep that also keeps each step's displacement, by its parameter."""
    kept = {step.parameter: step.u_m for step in sweep.resume}

    def on_step(step: Step) -> None:
        kept[step.parameter] = step.u_m
        sweep.on_step(step)

    return replace(sweep, on_step=on_step), kept


def _wall_m(model: SolidModel, geometry: FingerGeometry, u_m: F64) -> float:
    r, _, z = model.mesh.cylindrical.T
    middle = np.abs(z - 0.5 * geometry.chamber_length_m) <= geometry.ring_pitch_m
    x = model.mesh.points_m + u_m
    radius = np.hypot(x[:, 0], x[:, 1])
    outer = middle & np.isclose(r, geometry.actuator_outer_radius_m)
    inner = middle & np.isclose(r, geometry.actuator_inner_radius_m)
    return float(radius[outer].mean() - radius[inner].mean())


def _silicone_maximum(model: SolidModel, u_m: F64) -> tuple[float, float | None]:
    """Return the silicone's largest nodal von Mises strain and the undeformed radius of its node [m] (None at rest)."""
    strain = node_strain(model, u_m, SILICONE)
    worst = int(np.argmax(strain))
    return float(strain[worst]), float(model.mesh.cylindrical[worst, 0]) if strain[worst] > 1e-9 else None
