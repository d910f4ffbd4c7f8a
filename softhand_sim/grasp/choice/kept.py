"""Grasps that were searched for once are kept in the user's cache folder, under everything that they depend on."""

import hashlib
import logging
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.grasp.choice.grasp_file import GraspFile, KeptGrasp, load_grasps, rounded, write_grasps
from softhand_sim.grasp.choice.search import DEFAULT_BUDGET, search_grasp
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.hand.anatomy import HandAnatomy
from softhand_sim.objects.cache import cache_folder
from softhand_sim.objects.model import ObjectModel

# choice: what full trials then choose from; scores tell little more apart
MOST = 16
_LOG = logging.getLogger(__name__)


def kept_or_searched(
    model: ObjectModel,
    calibration: FingerCalibration,
    *,
    protocol: GraspProtocol,
    budget: int = DEFAULT_BUDGET,
    seed: int = 0,
) -> tuple[KeptGrasp, ...]:
    """Return the best few grasps that a search finds, best first, from the cache if the same search was done before.

    See `search_grasp` for the arguments and what it raises. A damaged or unwritable cache costs a search, no more.
    """
    anatomy = HandAnatomy()
    path = cache_folder() / "grasps" / f"{_key(model, calibration, protocol, budget, seed, anatomy)}.toml"
    try:
        return tuple(load_grasps(path).grasps.values())
    except FileNotFoundError:
        pass
    except (ValueError, OSError) as error:
        _LOG.warning("kept grasp is damaged and searched again: %s", error)
    found = search_grasp(model, calibration, protocol=protocol, budget=budget, seed=seed, anatomy=anatomy)
    kept = tuple(
        KeptGrasp(plan=rounded(one.plan), score=round(one.score, 3), closings=found.closings)
        for one in found.grasps[:MOST]
    )
    try:
        write_grasps(path, GraspFile(grasps={str(place): one for place, one in enumerate(kept, start=1)}))
    except OSError as error:
        _LOG.warning("grasp not kept in %s: %s", path.parent, error)
    return kept


def _key(
    model: ObjectModel,
    calibration: FingerCalibration,
    protocol: GraspProtocol,
    budget: int,
    seed: int,
    anatomy: HandAnatomy,
) -> str:
    """Return the SHA-256 of object, hand, search and the search's own source."""
    with np.printoptions(precision=17, floatmode="unique", threshold=sys.maxsize):
        digest = hashlib.sha256(repr((calibration, anatomy, budget, seed)).encode())
    # of the protocol a closing knows the way in and the limits
    digest.update(repr((protocol.approach_m, protocol.close_s, protocol.thresholds)).encode())
    named = replace(model, name="", rgba=(0.0, 0.0, 0.0, 0.0), notes=())
    digest.update(repr((named.mass_kg, named.friction, named.primitive)).encode())
    arrays = [named.inertia_kg_m2, np.asarray(named.mesh.vertices), np.asarray(named.mesh.faces)]
    arrays += [np.asarray(array) for part in named.convex_parts for array in (part.vertices, part.faces)]
    for array in arrays:
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()
