"""How finely actuator and exoskeleton are meshed and stepped; the complete finger has meshes of the same names."""

from dataclasses import dataclass

from fea.actuator import ActuatorMesh
from fea.exoskeleton import ExoskeletonMesh


@dataclass(frozen=True, kw_only=True)
class Density:
    """Meshes of both analyses and the pressures of the actuator's [Pa gauge]."""

    name: str
    actuator: ActuatorMesh
    exoskeleton: ExoskeletonMesh
    pressures_pa_gauge: tuple[float, ...]


_COARSE = Density(
    name="coarse",
    actuator=ActuatorMesh(theta_cells=3, inner_cells=1, gap_cells=1, cap_cells=1, core_cells=1),
    exoskeleton=ExoskeletonMesh(sector_cells=2, rest_cells=3, wall_cells=1, gap_cells=3, segment_cells=2),
    pressures_pa_gauge=tuple(1e3 * p for p in (5, 10, 15, 20, 25, 30, 35, 40, 45)),
)
_CALIBRATION = Density(
    name="calibration",
    # three curved cells over the half turn: four change the elongation by 0.1 %
    actuator=ActuatorMesh(theta_cells=3, inner_cells=2, gap_cells=2, cap_cells=1, core_cells=1),
    exoskeleton=ExoskeletonMesh(),
    pressures_pa_gauge=tuple(1e3 * p for p in (5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60)),
)

_REFERENCE = Density(
    name="reference",
    # average element size of at most 1 mm (reinforcement), 1.5 mm (silicone) and 2.5 mm (exoskeleton): Alves et al.,
    # section 3.2; never coarser than the calibration mesh, so the rings' layers are finer than the paper's
    actuator=ActuatorMesh(theta_cells=15, inner_cells=2, gap_cells=2, cap_cells=2, core_cells=2),
    exoskeleton=ExoskeletonMesh(sector_cells=5, rest_cells=7, wall_cells=2, gap_cells=6, segment_cells=10),
    pressures_pa_gauge=_CALIBRATION.pressures_pa_gauge,
)

DENSITIES = {density.name: density for density in (_COARSE, _CALIBRATION, _REFERENCE)}
