"""How finely the two analyses are meshed and stepped."""

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
    pressures_pa_gauge=tuple(1e3 * p for p in (5, 10, 15, 20, 25, 30, 35, 40)),
)
_CALIBRATION = Density(
    name="calibration",
    # three curved cells over the half turn: four change the elongation by 0.1 %
    actuator=ActuatorMesh(theta_cells=3, inner_cells=2, gap_cells=2, cap_cells=1, core_cells=1),
    exoskeleton=ExoskeletonMesh(),
    pressures_pa_gauge=tuple(1e3 * p for p in (5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60)),
)

DENSITIES = {density.name: density for density in (_COARSE, _CALIBRATION)}
