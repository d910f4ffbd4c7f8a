"""How finely a scene is simulated, as one value: what `for_tolerance` picks and what every run can be given."""

from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

from assets import asset_path
from softhand_sim.effects import BENCH, PRESETS, Effects
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.front import Front, Measured, read_front
from softhand_sim.fidelity.shapes import Shapes
from softhand_sim.hand.chain import check_links
from softhand_sim.hand.scene import EngineSettings


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """Time step, solver, links of a finger, shapes and the effects' policy; the defaults are the engine's defaults.

    Attributes
    ----------
    timestep_s, integrator, cone, impratio, noslip_iterations: as `EngineSettings`.
    links: hinges of a finger, None for three joints (`softhand_sim.hand.chain`).
    shapes: what objects collide with.
    effects: a preset's name; what a scene has unless it is told otherwise.
    auto_effects: within this tolerance each scene leaves out what it does not call for (`effects.auto`); None: nothing.
    measured: what was measured of it; None for a setting of one's own.

    Raises
    ------
    ValueError
        If a value is out of range; the message names it.
    """

    timestep_s: float = EngineSettings.timestep_s
    integrator: str = EngineSettings.integrator
    cone: str = EngineSettings.cone
    impratio: float = EngineSettings.impratio
    noslip_iterations: int = EngineSettings.noslip_iterations
    links: int | None = None
    shapes: Shapes = Shapes.SHIPPED
    effects: str = "bench"
    auto_effects: Tolerance | None = None
    measured: Measured | None = None

    def __post_init__(self) -> None:
        check_links(self.links)
        if self.effects not in PRESETS:
            raise ValueError(f"effects = {self.effects!r}: must be one of {', '.join(PRESETS)}")
        _ = self.engine

    @classmethod
    def for_tolerance(cls, angle_deg: float = 2.0, slip_mm: float = 1.0) -> "Fidelity":
        """Return the cheapest setting of the shipped front that is within a tolerance.

        Parameters
        ----------
        angle_deg, slip_mm
            Of any fingertip's angle at rest and of an object's slip, from the finest setting with the same effects.

        Raises
        ------
        ValueError
            If a tolerance is no number of 0 or above, or no measured setting is within it.
        """
        return cls.within(Tolerance(angle_deg=angle_deg, slip_m=1e-3 * slip_mm))

    @classmethod
    def within(cls, tolerance: Tolerance, *, effects_too: bool = False) -> "Fidelity":
        """Return the cheapest setting of the shipped front within a tolerance.

        With ``effects_too`` the setting has half of it, and the effects that a scene may leave out the other half:
        errors of both may add up.

        Raises
        ------
        ValueError
            If no measured setting is within it.
        """
        if not effects_too:
            return shipped_front().for_tolerance(tolerance)
        half = Tolerance(angle_deg=0.5 * tolerance.angle_deg, slip_m=0.5 * tolerance.slip_m)
        return replace(shipped_front().for_tolerance(half), auto_effects=half)

    @property
    def engine(self) -> EngineSettings:
        """Time step and solver."""
        return EngineSettings(
            timestep_s=self.timestep_s,
            integrator=self.integrator,
            cone=self.cone,
            impratio=self.impratio,
            noslip_iterations=self.noslip_iterations,
        )

    @property
    def scene_effects(self) -> Effects:
        """The preset that is named."""
        return PRESETS.get(self.effects, BENCH)

    def told(self) -> dict[str, str | float]:
        """Return what was picked with expected error and cost, flat, for an environment's ``info``; else nothing."""
        if self.measured is None:
            return {}
        values = vars(self.measured)
        return {f"fidelity_{key}": values[key] for key in ("name", "angle_error_deg", "slip_error_m", "cost_ratio")}

    def data(self) -> dict[str, Any]:
        """Return every field, JSON ready, for the record of a run."""
        return asdict(self) | {"shapes": self.shapes.value}

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> "Fidelity":
        """Return the fidelity of a record's plain fields (not `measured`, `auto_effects`).

        Raises
        ------
        ValueError
            If a field is unknown or its value is refused.
        """
        known = {f.name for f in fields(cls)} - {"measured", "auto_effects"}
        unknown = sorted(set(data) - known)
        if unknown:
            raise ValueError(f"{unknown[0]}: no such field; allowed: {', '.join(sorted(known))}")
        plain = dict(data)
        if "shapes" in plain:
            if plain["shapes"] not in list(Shapes):
                raise ValueError(f"shapes = {plain['shapes']!r}: must be one of {', '.join(Shapes)}")
            plain["shapes"] = Shapes(plain["shapes"])
        return cls(**plain)


HIGH_ACCURACY = Fidelity(timestep_s=0.5e-3, noslip_iterations=10)
"""Choice: for long holds. A tennis ball creeps by 2.8 um/s with it, by 95 at the default setting, 17 with ten noslip
iterations alone, and 6 with those at 1 ms."""

FINEST = Fidelity(timestep_s=0.25e-3, noslip_iterations=10)
"""What errors are measured against. Choice: an eighth of the default time step; half of it is the error bar."""


@cache
def shipped_front() -> Front[Fidelity]:
    """Return the shipped front, ``assets/accuracy/front.json``."""
    return load_front(asset_path("accuracy", "front.json"))


def load_front(path: Path) -> Front[Fidelity]:
    """Read and check a front of fidelities; raises as `read_front`."""
    return read_front(path, lambda data, measured: replace(Fidelity.from_data(data), measured=measured))
