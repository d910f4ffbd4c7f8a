"""Solving a finger with a progress bar, through the store of solved ones."""

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

from tqdm import tqdm

from fea.calibration import FINGER_PATH
from fea.density import Density
from fea.exoskeleton import LOADS_N
from fea.finger_design import FingerDesign
from fea.identity import finger_identity
from fea.store import FingerStore, Solved
from scripts import _cli
from softhand_sim.calibration import FingerCalibration, load_calibration
from softhand_sim.objects.cache import cache_folder


class Analyses(Protocol):
    """The analyses of a finger: :func:`fea.solved.solve_finger`, or a cheap stand-in for tests."""

    def __call__(
        self, design: FingerDesign, density: Density, *, choose: bool = ..., progress: Callable[[], None] = ...
    ) -> Solved:
        """Return a finger's calibration; a ``ValueError`` says why there is none."""
        ...


def add_store(parser: argparse.ArgumentParser) -> None:
    """Add ``--store FOLDER`` and ``--force``."""
    text = "solved fingers (default: $SOFTHAND_CACHE/fingers, or softhand-sim/fingers in the user's cache folder)"
    parser.add_argument("--store", type=Path, metavar="FOLDER", help=text)
    parser.add_argument("--force", action="store_true", help="solve again what the store has")


@dataclass(frozen=True, kw_only=True)
class Solver:
    """The analyses behind a store; with ``force`` the store is written but not asked."""

    store: FingerStore
    analyses: Analyses
    force: bool = False

    def __call__(
        self, design: FingerDesign, density: Density, *, choose: bool = False, label: str = "load steps"
    ) -> tuple[Solved, bool]:
        """Return a finger's calibration and whether it came from the store.

        Raises
        ------
        ValueError
            If the analyses refuse the finger.
        """
        steps = len(density.pressures_pa_gauge) + len(LOADS_N) + 1 + len(FINGER_PATH.targets)

        def work() -> Solved:
            with tqdm(total=None if choose else steps, desc=label, unit="step") as bar:
                return self.analyses(design, density, choose=choose, progress=lambda: bar.update(1))

        identity = finger_identity(design.geometry, design.materials, density, choose_sector=choose)
        return self.store.solve(identity, work, force=self.force)


def solver(args: Any, analyses: Analyses) -> Solver:
    """Return the analyses behind the store that a command line names."""
    folder = args.store if args.store is not None else cache_folder() / "fingers"
    return Solver(store=FingerStore(folder, warn=_warn), analyses=analyses, force=args.force)


def checked(artifact: Mapping[str, Any]) -> FingerCalibration:
    """Return a calibration as the runtime reads it, before it replaces any file.

    Raises
    ------
    ValueError
        If the runtime refuses it; the message names the field.
    """
    with TemporaryDirectory() as folder:
        file = Path(folder) / "finger.json"
        _cli.write_json(file, dict(artifact))
        try:
            return load_calibration(file)
        except ValueError as error:
            raise ValueError(str(error).replace(f"{file}: ", "refused by the runtime: ")) from None


def _warn(line: str) -> None:
    print(f"store: {line}", file=sys.stderr)
