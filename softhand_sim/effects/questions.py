"""Whether a scene calls for an effect of the gas: by rehearsing the closing with and without it."""

import math

import numpy as np

from softhand_sim.effects.build import TICK_S
from softhand_sim.effects.kind import Estimate
from softhand_sim.effects.rehearsal import without
from softhand_sim.effects.scene import SceneFacts


def gas(scene: SceneFacts) -> Estimate:
    """Return what set pressures at once change: with an object everything, without one what is left after closing."""
    if scene.lift_m is not None:
        reason = "an object is grasped, and fingers that close at once would throw it"
        return Estimate(own_deg=math.inf, redraws=True, reason=reason)
    if scene.rehearsal is None:
        return Estimate(own_deg=0.0, redraws=False, reason="there is no gas")
    away = scene.rehearsal.pressure_pa_gauge[_held(scene)] - scene.set_pa_gauge
    # another seed's noise may end at the other end of the controller's band
    largest = max(float(np.abs(away).max()), scene.band_pa)
    reason = (
        f"from then on pressures are within {largest / 1e3:.1f} kPa of the set ones; without it all of the flow goes"
    )
    return Estimate(own_deg=scene.angle_change_deg(largest), redraws=False, reason=reason)


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
    held = _held(scene)
    apart = np.abs(scene.rehearsal.pressure_pa_gauge[held] - alone.pressure_pa_gauge[held])
    largest = float(apart.max())
    beyond = max(0.0, largest - scene.rehearsal.pulse_pa)
    reason = (
        f"{what}: held pressures differ by {largest / 1e3:.1f} kPa, a pulse is {scene.rehearsal.pulse_pa / 1e3:.1f}"
    )
    return Estimate(own_deg=scene.angle_change_deg(beyond), redraws=True, reason=reason)


def _held(scene: SceneFacts) -> slice:
    return slice(round(scene.closed_s / TICK_S), None)
