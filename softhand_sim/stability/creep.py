"""Ten minutes of holding: how fast an object drifts in the hand, by default and with the settings against creep.

Soft contacts creep by design (a friction force is a damper whose rate the solver regularises); the engine's noslip
iterations take the rest out, if there are enough of them. How far inside its friction cone a grasp is: the share of the
tangential forces in what friction could bear, |f_t| over mu f_n, each summed over the object's contacts.
"""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from softhand_sim.calibration import FingerCalibration
from softhand_sim.grasp.contacts import ContactMap
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.model import ObjectModel
from softhand_sim.simulation import HandSimulation

HOLD_S = 600.0
WITHOUT_CREEP = EngineSettings(noslip_iterations=30, impratio=100.0)
"""Choice: the high-accuracy preset for holding, at the default step: ten times the noslip iterations and the ratio of
frictional to normal impedance. A lemon, a minute: 1.9 um/s by default, 2.1 with 30 iterations, 0.1 with both."""


@dataclass(frozen=True, kw_only=True)
class Creep:
    """What a long hold came to.

    Attributes
    ----------
    outcome: verdict of the trial.
    creep_m_per_s: steady drift over the second half of the hold.
    slip_m: displacement in the hand from the start of the lift to the end of the hold.
    cone_share: how much of its friction the grasp uses at the end, 0 to 1.
    """

    outcome: Outcome
    creep_m_per_s: float
    slip_m: float
    cone_share: float


def creep(
    model: ObjectModel, calibration: FingerCalibration, engine: EngineSettings, seed: int = 0, hold_s: float = HOLD_S
) -> Creep:
    """Grasp with the scripted grasp, lift by 0.1 m and hold."""
    protocol = replace(load_protocol(), phases=(Lift(height_m=0.1), Hold(duration_s=hold_s)))
    setup = prepare(model, calibration, protocol=protocol, engine=engine, plan=plan_grasp(model))
    contacts, last = ContactMap.of(setup.scene.model), 0.0

    def watch(simulation: HandSimulation) -> None:
        nonlocal last
        # a look a second is enough for what stands still
        if round(simulation.data.time / 0.02) % 50 == 0:
            last = cone_share(simulation, contacts)

    result = run_trial(setup, seed, watch)
    return Creep(outcome=result.outcome, creep_m_per_s=result.creep_m_per_s, slip_m=result.slip_m, cone_share=last)


def cone_share(simulation: HandSimulation, contacts: ContactMap) -> float:
    """Return the tangential forces of the object's contacts with the hand over what friction could bear; 0 without."""
    model, data, force = simulation.model, simulation.data, np.zeros(6)
    used = borne = 0.0
    for contact in contacts.of_object(data):
        mujoco.mj_contactForce(model, data, int(contact), force)
        used += float(np.hypot(force[1], force[2]))
        borne += float(data.contact.friction[contact, 0] * force[0])
    return used / borne if borne > 0.0 else 0.0
