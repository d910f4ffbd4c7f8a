"""``--tolerance``: the cheapest measured setting that is within it, and what is said of it."""

import argparse

from scripts import _cli
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity


def add_tolerance(parser: argparse.ArgumentParser) -> None:
    """Add ``--tolerance DEG,MM``."""
    text = "degrees and mm: the cheapest measured setting within that of the finest one (docs/accuracy.md)"
    parser.add_argument("--tolerance", type=parse_tolerance, metavar="DEG,MM", help=text)


def parse_tolerance(text: str) -> Tolerance:
    """Parse ``DEG,MM`` (argparse type)."""
    angle, _, slip = text.partition(",")
    return Tolerance(angle_deg=_cli.non_negative_float(angle), slip_m=1e-3 * _cli.non_negative_float(slip))


def chosen_fidelity(args: argparse.Namespace) -> Fidelity:
    """Return time step and solver: picked by ``--tolerance``, or the default ones with ``--timestep`` [ms].

    Raises
    ------
    ValueError
        If both are given, or no measured setting is within the tolerance.
    """
    if args.tolerance is not None:
        if args.timestep is not None:
            raise ValueError(f"--timestep {args.timestep:g}: --tolerance picks it; give one of them")
        return Fidelity.within(args.tolerance)
    return Fidelity() if args.timestep is None else Fidelity(timestep_s=1e-3 * args.timestep)


def tell_picked(fidelity: Fidelity) -> None:
    """Print what a tolerance picked, with its expected error and cost; nothing without one."""
    m = fidelity.measured
    if m is not None:
        print(
            f"picked: {m.name}; expected within {m.angle_error_deg:.2g} degrees and {1e3 * m.slip_error_m:.2g} mm of "
            f"the finest setting, at {m.cost_ratio:.2g} times the bare engine's cost"
        )
