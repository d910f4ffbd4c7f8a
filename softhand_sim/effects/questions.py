"""Whether a scene calls for an effect of the gas: by rehearsing the closing with and without it."""

import numpy as np

from softhand_sim.effects.build import TICK_S
from softhand_sim.effects.kind import Estimate
from softhand_sim.effects.rehearsal import without
from softhand_sim.effects.scene import SceneFacts


def rehearsed(scene: SceneFacts, name: str, what: str) -> Estimate:
    """Return what leaving an effect of flow or command out changes, beyond the controller's band.

    Parameters
    ----------
    scene
        The scene.
    name
        The effect.
    what
        What it does, for the reason.
    """
    alone = scene.rehearse(without(scene.offered, name))
    if scene.rehearsal is None or alone is None:
        return Estimate(own_deg=0.0, redraws=False, reason="there is no gas")
    held = slice(round(scene.closed_s / TICK_S), None)
    apart = np.abs(scene.rehearsal.pressure_pa_gauge[held] - alone.pressure_pa_gauge[held])
    largest = float(apart.max())
    beyond = max(0.0, largest - scene.rehearsal.pulse_pa)
    reason = (
        f"{what}: held pressures differ by {largest / 1e3:.1f} kPa, a pulse is {scene.rehearsal.pulse_pa / 1e3:.1f}"
    )
    return Estimate(own_deg=scene.angle_change_deg(beyond), redraws=True, reason=reason)
