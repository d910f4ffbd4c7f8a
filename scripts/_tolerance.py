"""``--tolerance`` and ``--effects``: the cheapest measured setting, a scene's effects, and what is said of them."""

import argparse
from dataclasses import replace

from scripts import _cli
from softhand_sim.effects import PRESETS
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity

AUTO = "auto"


def add_tolerance(parser: argparse.ArgumentParser) -> None:
    """Add ``--tolerance DEG,MM`` and ``--effects``."""
    text = "degrees and mm: the cheapest measured setting within that of the finest one (docs/accuracy.md)"
    parser.add_argument("--tolerance", type=parse_tolerance, metavar="DEG,MM", help=text)
    text = (
        "of the scene (default bench); auto: of full those that each scene calls for, half of the --tolerance for them "
        "and half for the setting (docs/effects.md)"
    )
    parser.add_argument("--effects", choices=(*PRESETS, AUTO), default="bench", help=text)


def parse_tolerance(text: str) -> Tolerance:
    """Parse ``DEG,MM`` (argparse type)."""
    angle, _, slip = text.partition(",")
    return Tolerance(angle_deg=_cli.non_negative_float(angle), slip_m=1e-3 * _cli.non_negative_float(slip))


def chosen_fidelity(args: argparse.Namespace) -> Fidelity:
    """Return time step and solver, picked by ``--tolerance`` or the default ones with ``--timestep`` [ms], and effects.

    Raises
    ------
    ValueError
        If both are given, no measured setting is within the tolerance, or ``--effects auto`` has none.
    """
    auto = args.effects == AUTO
    effects = "full" if auto else args.effects
    if args.tolerance is not None:
        if args.timestep is not None:
            raise ValueError(f"--timestep {args.timestep:g}: --tolerance picks it; give one of them")
        return replace(Fidelity.within(args.tolerance, effects_too=auto), effects=effects)
    if auto:
        raise ValueError("--effects auto: needs --tolerance DEG,MM")
    fidelity = Fidelity(effects=effects)
    return fidelity if args.timestep is None else replace(fidelity, timestep_s=1e-3 * args.timestep)


def tell_picked(fidelity: Fidelity) -> None:
    """Print what a tolerance picked, with its expected error and cost; nothing without one."""
    m = fidelity.measured
    if m is not None:
        print(
            f"picked: {m.name}; expected within {m.angle_error_deg:.2g} degrees and {1e3 * m.slip_error_m:.2g} mm of "
            f"the finest setting, at {m.cost_ratio:.2g} times the bare engine's cost"
        )
    t = fidelity.auto_effects
    if t is not None:
        half = f"{t.angle_deg:g} degrees and {1e3 * t.slip_m:g} mm"
        print(f"effects: those of {fidelity.effects} that a scene calls for within {half}")
