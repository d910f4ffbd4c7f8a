"""Which actuation runs: compiled where numba is installed, plain elsewhere."""

import importlib.util
from collections.abc import Callable
from functools import partial

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.actuation.parts import Actuation, EngineArrays, HandParts, Runner
from softhand_sim.actuation.plain import PlainActuation
from softhand_sim.wrist import move_wrists

Vector = npt.NDArray[np.float64]


def has_numba() -> bool:
    """Return whether there is a compiler for what has a compiled and a plain form."""
    return importlib.util.find_spec("numba") is not None


def prepare_actuation(hand: HandParts, engine: EngineArrays) -> Actuation:
    """Return the actuation of all worlds of the engine's arrays."""
    if not has_numba():
        return PlainActuation(hand, engine)
    from softhand_sim.actuation.compiled import CompiledActuation  # noqa: PLC0415 - numba is optional

    return CompiledActuation(hand, engine)


def engine_runner(actuation: Actuation, model: mujoco.MjModel, data: mujoco.MjData) -> Runner | None:
    """Return what takes whole steps of an actuation's only world in compiled code; None where there is none."""
    if isinstance(actuation, PlainActuation):
        return None
    from softhand_sim.actuation.compiled import CompiledActuation  # noqa: PLC0415 - numba is optional
    from softhand_sim.actuation.native import EngineGuard  # noqa: PLC0415

    assert isinstance(actuation, CompiledActuation)
    guard = EngineGuard(model, data)
    actuation.load_run(guard)
    return partial(actuation.run, guard)


def wrist_mover() -> Callable[[Vector, Vector, float, float], None]:
    """Return `move_wrists`, compiled where numba is installed."""
    if not has_numba():
        return move_wrists
    from softhand_sim.actuation import kernel  # noqa: PLC0415 - numba is optional

    return kernel.move_wrists
