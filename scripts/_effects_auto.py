"""What a tolerance chooses for a scene, time step and effects, held against everything at the default step."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from softhand_sim.effects.auto import choose, declared
from softhand_sim.effects.effects import Effects
from softhand_sim.effects.omission import Omission
from softhand_sim.effects.scene import SceneFacts, Tolerance
from softhand_sim.fidelity.fidelity import Fidelity

Variant = tuple[Effects, float, float]
"""Effects that are kept, and the declared errors of angle [deg] and slip [m]."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One comparison: scene, what was kept, declared errors, what was measured."""

    scene: str
    seed: int
    effects_kept: tuple[str, ...]
    declared_deg: float
    declared_m: float
    change: Omission

    @property
    def bounded(self) -> bool:
        """Whether the measured change is within the declared one, to rounding."""
        return self.change.angle_deg <= self.declared_deg + 1e-9 and self.change.slip_m <= self.declared_m + 1e-12


@dataclass(frozen=True, kw_only=True)
class Auto:
    """A tolerance, what of it the effects have, and the setting that the rest allows."""

    tolerance: Tolerance
    of_effects: Tolerance
    fidelity: Fidelity

    def variant(self, facts: SceneFacts) -> Variant:
        """Return the effects that a scene keeps, and the errors that effects and setting declare together."""
        kept = choose(facts, self.of_effects)[0]
        angle, slip = declared(facts, kept, self.of_effects)
        m = self.fidelity.measured
        return (kept, angle, slip) if m is None else (kept, angle + m.angle_error_deg, slip + m.slip_error_m)

    def kept(self, row: Row) -> bool:
        """Whether a scene is within the tolerance."""
        return row.change.angle_deg <= self.tolerance.angle_deg and row.change.slip_m <= self.tolerance.slip_m


def chosen(args: Any) -> Auto | None:
    """Return what ``--auto`` with its tolerance chooses; None without it.

    Raises
    ------
    ValueError
        If ``--effects-alone`` is given without it, or no measured setting is within half of the tolerance.
    """
    if not args.auto:
        if args.effects_alone:
            raise ValueError("--effects-alone: needs --auto")
        return None
    tolerance = Tolerance(angle_deg=args.angle, slip_m=1e-3 * args.slip)
    if args.effects_alone:
        return Auto(tolerance=tolerance, of_effects=tolerance, fidelity=Fidelity())
    fidelity = Fidelity.within(tolerance, effects_too=True)
    return Auto(tolerance=tolerance, of_effects=fidelity.auto_effects or tolerance, fidelity=fidelity)


def print_scenes(rows: Sequence[Row], auto: Auto) -> None:
    """Print a line for each scene, as Markdown."""
    engine = auto.fidelity.engine
    asked = f"{auto.tolerance.angle_deg:g} degrees, {1e3 * auto.tolerance.slip_m:g} mm"
    print(f"tolerance {asked}; time step {1e3 * engine.timestep_s:g} ms, {engine.noslip_iterations} noslip iterations")
    print("\n| scene | kept | step | angle: declared, measured | slip, mm | same verdict | time |\n" + "|---" * 7 + "|")
    for row in rows:
        change, slip = row.change, f"{1e3 * row.declared_m:.1f}, {1e3 * row.change.slip_m:.2f}"
        print(
            f"| {row.scene} | {', '.join(row.effects_kept) or 'nothing'} | {1e3 * engine.timestep_s:g} ms "
            f"| {row.declared_deg:.1f}, {change.angle_deg:.2f} | {slip} | {'yes' if change.same_outcome else 'no'} "
            f"| {change.time_ratio:.2f} |"
        )
    kept, ratios = sum(auto.kept(row) for row in rows), [row.change.time_ratio for row in rows]
    print(f"\nwithin the tolerance: {kept} of {len(rows)}; time, median: {np.median(ratios):.2f}")
