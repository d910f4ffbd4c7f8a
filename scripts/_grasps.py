"""Which grasp each object of a run gets: from a file, shipped, searched, or scripted."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from scripts import _cli
from softhand_sim.calibration import load_calibration
from softhand_sim.grasp.choice.grasp_file import KeptGrasp, load_grasps
from softhand_sim.grasp.choice.kept import kept_or_searched
from softhand_sim.grasp.choice.search import DEFAULT_BUDGET, SMALLEST_BUDGET
from softhand_sim.grasp.choice.shipped import shipped_grasp
from softhand_sim.grasp.proof import proven
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.objects.model import ObjectModel


@dataclass(frozen=True, kw_only=True)
class ChosenGrasp:
    """A grasp, where it comes from (file, shipped, search, scripted) and the time that it took."""

    kept: KeptGrasp
    source: str
    wall_s: float

    def data(self) -> dict[str, Any]:
        """Return it JSON-ready."""
        plan = self.kept.plan
        return {
            "source": self.source,
            "wrist_position_m": list(plan.wrist_pose[:3]),
            "wrist_yaw_pitch_roll_rad": list(plan.wrist_pose[3:]),
            "retreat": list(plan.retreat),
            "set_angle_deg": list(plan.set_angle_deg),
            "score": self.kept.score,
            "closings": self.kept.closings,
            "search_s": self.wall_s,
        }


def add_grasps(parser: _cli.Parser) -> None:
    """Add ``--grasps FILE`` and ``--search N``."""
    text = "TOML file of grasps of your own, [grasp.NAME] an object (docs/grasp-benchmark.md)"
    parser.add_argument("--grasps", type=Path, metavar="FILE", help=text)
    text = (
        f"search each grasp anew with N closings, {SMALLEST_BUDGET} or more; 0: scripted from the shape; default: the "
        f"shipped one of the shape, else a search with {DEFAULT_BUDGET}"
    )
    parser.add_argument("--search", type=_cli.non_negative_int, metavar="N", help=text)


def check_search(search: int | None) -> None:
    """Refuse a budget that is too small, before any object is loaded."""
    if search and search < SMALLEST_BUDGET:
        raise ValueError(f"--search: {search} must be 0, or {SMALLEST_BUDGET} or above")


def choose_grasps(
    models: Sequence[ObjectModel],
    *,
    own: Path | None,
    search: int | None,
    calibration: Path | None,
    protocol: GraspProtocol,
) -> dict[str, ChosenGrasp]:
    """Return each object's grasp by its name.

    Raises
    ------
    ValueError
        If the file is wrong, or holds a grasp for none of the objects.
    """
    given = {} if own is None else load_grasps(own).grasps
    names = [model.name for model in models]
    if strange := sorted(set(given) - set(names)):
        raise ValueError(f"--grasps {own}: grasp.{strange[0]} is for none of the objects {names}")
    finger, chosen = load_calibration(calibration), {}
    for model in tqdm(models, desc="grasps", unit="object", leave=False):
        started = time.perf_counter()
        shipped = shipped_grasp(model) if search is None else None
        if model.name in given:
            kept, source = given[model.name], "file"
        elif search == 0:
            kept, source = KeptGrasp(plan=plan_grasp(model)), "scripted"
        elif shipped is not None:
            kept, source = shipped, "shipped"
        else:
            budget = search or DEFAULT_BUDGET
            found = kept_or_searched(model, finger, protocol=protocol, budget=budget)
            kept, source = proven(found, model, finger, protocol).kept, "search"
        chosen[model.name] = ChosenGrasp(kept=kept, source=source, wall_s=time.perf_counter() - started)
    return chosen


def cost(chosen: dict[str, ChosenGrasp]) -> str:
    """Return in a line where the grasps come from and what the searched ones cost."""
    parts = []
    for source in dict.fromkeys(grasp.source for grasp in chosen.values()):
        own = [grasp for grasp in chosen.values() if grasp.source == source]
        text = f"{len(own)} {'from the file' if source == 'file' else source}"
        if source == "search":
            closings, wall_s = sum(grasp.kept.closings or 0 for grasp in own), sum(grasp.wall_s for grasp in own)
            text = f"{len(own)} searched ({closings} closings, {wall_s:.1f} s with their trials)"
        parts.append(text)
    return f"grasps: {', '.join(parts)}"
