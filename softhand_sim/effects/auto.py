"""Effects chosen by the scene: each is asked what leaving it out would change, and stays if that is too much.

The estimates bound the change of tip angles and slip as long as the verdict of the trial stays. A grasp that is about
to fail is decided by any small change, the sensor's noise among them; no estimate made beforehand can bound that.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

from softhand_sim.effects import gravity, interference, pads, relaxation, relief, sliding
from softhand_sim.effects.effects import NEED_GAS, Effects
from softhand_sim.effects.kind import Estimate
from softhand_sim.effects.questions import rehearsed
from softhand_sim.effects.scene import SceneFacts, Tolerance


@dataclass(frozen=True, kw_only=True)
class Answer:
    """One effect's answer.

    Attributes
    ----------
    name, active
        The effect, and whether the scene has it.
    reason
        In words.
    omission_error_deg, omission_error_m
        What leaving it out alone would change at most: tip angle [deg] and slip [m]; infinite if that cannot be told.
    """

    name: str
    active: bool
    reason: str
    omission_error_deg: float
    omission_error_m: float


def _gas(_scene: SceneFacts) -> Estimate:
    reason = "an object is grasped, and fingers that close at once would throw it"
    return Estimate(own_deg=math.inf, redraws=True, reason=reason)


def _relief(scene: SceneFacts) -> Estimate:
    assert scene.offered.relief is not None
    return relief.question(scene, scene.offered.relief)


def _pads(scene: SceneFacts) -> Estimate:
    assert scene.offered.pads is not None
    return pads.question(scene, scene.offered.pads)


QUESTIONS: Mapping[str, Callable[[SceneFacts], Estimate]] = MappingProxyType(
    {
        "gas": _gas,
        "tube": partial(rehearsed, name="tube", what="lag of the chambers behind the valves"),
        "heat": partial(rehearsed, name="heat", what="warming and cooling of the gas"),
        "supply": partial(rehearsed, name="supply", what="droop of the supply"),
        "leaks": partial(rehearsed, name="leaks", what="a leak is declared"),
        "valve_delay": partial(rehearsed, name="valve_delay", what="dead time of the valves"),
        "sensor": partial(rehearsed, name="sensor", what="noise and steps of the readings"),
        "sliding": sliding.question,
        "relaxation": relaxation.question,
        "relief": _relief,
        "interference": interference.question,
        "gravity": gravity.question,
        "pads": _pads,
    }
)
"""Each effect's own question."""


def choose(
    scene: SceneFacts, tolerance: Tolerance, force: Mapping[str, bool] | None = None
) -> tuple[Effects, tuple[Answer, ...]]:
    """Return the effects that the scene calls for, and every effect's answer.

    Effects are left out in the order of what that costs, the least first, as long as all omissions together stay
    within the tolerance. The controller's band counts once, however many of them redraw the held pressures.

    Parameters
    ----------
    scene
        The scene, with the parameters that each effect would have.
    tolerance
        Of angle and slip.
    force
        Effects that are to stay (True) or to go (False) whatever their answer; with the gas goes what needs it.

    Raises
    ------
    ValueError
        If an effect to be forced does not exist, or one that is not offered is to stay.
    """
    forced = dict(force or {})
    for name, stays in forced.items():
        if name not in QUESTIONS or (stays and name not in scene.offered.present):
            raise ValueError(
                f"force = {name!r}: must be one of the effects offered: {', '.join(scene.offered.present)}"
            )
    if forced.get("gas") is False:
        forced = dict.fromkeys(NEED_GAS, False) | forced
    estimates = {name: QUESTIONS[name](scene) for name in scene.offered.present}
    arm = scene.calibration.finger.length_m
    gone = [name for name in estimates if forced.get(name) is False]
    for name in sorted(estimates, key=lambda n: (estimates[n].redraws, estimates[n].own_deg)):
        if name not in forced:
            error = _together(scene, [estimates[n] for n in (*gone, name)])
            if error <= tolerance.angle_deg and arm * math.radians(error) <= tolerance.slip_m:
                gone.append(name)
    answers = [
        Answer(name=name, active=False, reason=_absent(name), omission_error_deg=0.0, omission_error_m=0.0)
        for name in QUESTIONS
        if name not in estimates
    ]
    for name, estimate in estimates.items():
        error = _together(scene, [estimate])
        reason = estimate.reason if name not in forced else f"forced; {estimate.reason}"
        answers.append(
            Answer(
                name=name,
                active=name not in gone,
                reason=reason,
                omission_error_deg=error,
                omission_error_m=arm * math.radians(error),
            )
        )
    order = list(QUESTIONS)
    return replace(scene.offered, **dict.fromkeys(gone)), tuple(sorted(answers, key=lambda a: order.index(a.name)))


def _absent(name: str) -> str:
    return "no leak is declared" if name == "leaks" else "not offered"


def _together(scene: SceneFacts, estimates: list[Estimate]) -> float:
    """Return what leaving all of these out changes at most [deg]."""
    band = scene.band_deg if any(estimate.redraws for estimate in estimates) else 0.0
    return band + sum(estimate.own_deg for estimate in estimates)
