"""What a scene's settings already tell against its results, before anything runs."""

import mujoco
import numpy as np

VERIFIED_STEP_S = 0.002
"""Largest time step at which verdicts were compared with a finer one (docs/decisions.md)."""
_SLACK = 1e-9


def caveats(model: mujoco.MjModel) -> tuple[str, ...]:
    """Return, in a line each, why results of a model are not verified; empty where they are.

    Above the verified time step verdicts differ from those of a finer one. Contacts whose time constant is below two
    time steps are softened by the engine without a word (MuJoCo's documentation, solver parameters: ``refsafe``).
    """
    step = float(model.opt.timestep)
    found = []
    if step > VERIFIED_STEP_S + _SLACK:
        found.append(
            f"UNVERIFIED_STEP: time step {1e3 * step:g} ms; verdicts are verified up to {1e3 * VERIFIED_STEP_S:g} ms"
        )
    collides = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    constants = model.geom_solref[collides, 0]
    constants = constants[constants > 0.0]
    if constants.size and float(np.min(constants)) < 2.0 * step - _SLACK:
        found.append(
            f"SOFTENED_CONTACTS: time constant {1e3 * float(np.min(constants)):g} ms is below two time steps of "
            f"{1e3 * step:g} ms; the engine takes {2e3 * step:g} ms"
        )
    return tuple(found)
