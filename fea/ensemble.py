"""The fingers that are solved to learn how far a finger's calibration can be off: sources, and members of each."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from fea.density import Density
from fea.finger_design import FingerDesign, material_named, with_fields
from fea.laws import IsochoricOgden

TOLERANCE_M = 1e-4
"""Tolerance of a printed wall: 0.1 mm either way."""
WALLS = {
    "tube_wall": ("tube_wall_m", 1.0, "the exoskeleton's printed tube, outside of the joints"),
    "flexure_wall": ("flexure_thickness_m", 1.0, "the printed strip that bends in each joint"),
    "actuator_wall": (
        "actuator_inner_radius_m",
        -1.0,
        "silicone between chamber and tube, from a printed mould's core",
    ),
}
"""Walls by source: the dimension, the sign with which it changes as the wall grows, and what the wall is. The paper
prints exoskeleton and moulds on the same machine, so the tolerance holds for all three."""
SETS = ("set1", "set2", "set3")
MEASURED = {"tensile": "ecoflex-00-50-data/tensile", "data-sheet": "ecoflex-00-50-data/data_sheet"}

MESH_ANGLE_DEG = {"coarse": 85.9, "calibration": 95.28, "reference": 95.52}
"""Tip angle at 75 kPa, friction 0.3, of the same finger on three meshes (docs/finger-analysis.md)."""


@dataclass(frozen=True, kw_only=True)
class EnsembleMember:
    """A finger to solve; ``at`` is its place on its source's axis, 1 at the end of the tolerance, None on none.

    ``design`` is None where there cannot be such a finger, and ``refused`` says why.
    """

    name: str
    at: float | None
    design: FingerDesign | None
    refused: str | None = None


@dataclass(frozen=True, kw_only=True)
class EnsembleSource:
    """A reason why a finger may differ from the calibrated one.

    A ``tolerance`` is an interval about the nominal finger, ``scenarios`` are alternatives to it.
    """

    name: str
    kind: str
    text: str
    members: tuple[EnsembleMember, ...]


def ensemble_sources(base: FingerDesign) -> tuple[EnsembleSource, ...]:
    """Return walls, silicone data and pairs of materials about a finger; the mesh is no finger of its own."""
    return (*_walls(base), _silicone_data(base), _pairs(base))


def mesh_place() -> float:
    """Return where the coarse mesh lies on the mesh's axis, on which 1 is the reference less the calibration mesh."""
    angle = MESH_ANGLE_DEG
    return (angle["coarse"] - angle["calibration"]) / (angle["reference"] - angle["calibration"])


def member_density(density: Density, base: FingerDesign, design: FingerDesign) -> Density:
    """Return the density for a member: a softer silicone has analysis (i) at pressures lower by the shear moduli.

    The free actuator of the tensile test's silicone, a third as stiff at first, passes the lengthening that the fit
    uses after three of the usual pressures, and a cubic needs four.
    """
    laws = (design.materials.silicone.law, base.materials.silicone.law)
    own, usual = (law.shear_modulus_pa for law in laws if isinstance(law, IsochoricOgden))
    if own >= usual:
        return density
    return replace(density, pressures_pa_gauge=tuple(p * own / usual for p in density.pressures_pa_gauge))


def _walls(base: FingerDesign) -> Iterator[EnsembleSource]:
    for name, (dimension, sign, what) in WALLS.items():
        members = []
        for side, at in (("minus", -1.0), ("plus", 1.0)):
            value = getattr(base.geometry, dimension) + at * sign * TOLERANCE_M
            label = f"{name.replace('_', '-')}-{side}"
            try:
                design = replace(base, geometry=with_fields(base.geometry, {dimension: value}))
            except ValueError as error:
                members.append(EnsembleMember(name=label, at=at, design=None, refused=str(error)))
            else:
                members.append(EnsembleMember(name=label, at=at, design=design))
        text = f"{what}: {dimension} {'+-' if sign > 0.0 else '-+'} {1e3 * TOLERANCE_M:g} mm"
        yield EnsembleSource(name=name, kind="tolerance", text=text, members=tuple(members))


def _silicone_data(base: FingerDesign) -> EnsembleSource:
    members = tuple(
        EnsembleMember(name=f"silicone-{name}", at=None, design=_with_materials(base, silicone=material))
        for name, material in MEASURED.items()
    )
    text = "silicone from a tensile test (41 kPa at 100 %) or scaled to the supplier's data sheet (83 kPa)"
    return EnsembleSource(name="silicone_data", kind="scenarios", text=text, members=members)


def _pairs(base: FingerDesign) -> EnsembleSource:
    """Return the paper's pairs but the finger's own."""
    own = (base.materials.silicone.parameters, base.materials.tpu.parameters)
    members = []
    for silicone, tpu in product(SETS, SETS):
        design = _with_materials(base, silicone=f"ecoflex-00-50/{silicone}", tpu=f"ninjaflex/{tpu}")
        if (design.materials.silicone.parameters, design.materials.tpu.parameters) != own:
            members.append(EnsembleMember(name=f"pair-{silicone}-{tpu}", at=None, design=design))
    text = "the paper's parameter sets, silicone with TPU; it found set3 with set3 to fit its tests"
    return EnsembleSource(name="material_pair", kind="scenarios", text=text, members=tuple(members))


def _with_materials(base: FingerDesign, **names: str) -> FingerDesign:
    found = {role: material_named(name) for role, name in names.items()}
    return replace(base, materials=replace(base.materials, **found))
