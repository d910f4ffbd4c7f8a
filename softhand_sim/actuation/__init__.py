"""What acts on the fingers in each step of the engine, for any number of hands at once.

Gas, valves, control, friction, relaxation and relief are advanced together and written to the hands' ``ctrl``.

`Actuation` says what there is to do, `prepare_actuation` chooses between the compiled kernel and plain Python, which
agree to 1e-10. `PneumaticSystem` and `Losses` stay the reference and hold all parameters.
"""

from softhand_sim.actuation.choice import engine_runner, prepare_actuation, wrist_mover
from softhand_sim.actuation.parts import Actuation, Course, EngineArrays, HandParts, Runner

__all__ = [
    "Actuation",
    "Course",
    "EngineArrays",
    "HandParts",
    "Runner",
    "engine_runner",
    "prepare_actuation",
    "wrist_mover",
]
