"""Effects chosen by the scene: each is asked what leaving it out would change, and stays if that is too much.

A grasp that is about to fail is decided by any small change, the sensor's noise among them. So an effect's own estimate
counts only where the grasp bears a disturbance (`SceneFacts.firm`), or where there is no object. Elsewhere leaving out
anything may cost the object, and what bounds that is how far a free finger bends, and how high the object is lifted.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

from softhand_sim.effects import gravity, interference, pads, relaxation, relief, sliding
from softhand_sim.effects.effects import NEED_GAS, Effects
from softhand_sim.effects.kind import Estimate
from softhand_sim.effects.questions import gas, rehearsed
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


def _relief(scene: SceneFacts) -> Estimate:
    assert scene.offered.relief is not None
    return relief.question(scene, scene.offered.relief)


def _pads(scene: SceneFacts) -> Estimate:
    assert scene.offered.pads is not None
    return pads.question(scene, scene.offered.pads)


QUESTIONS: Mapping[str, Callable[[SceneFacts], Estimate]] = MappingProxyType(
    {
        "gas": gas,
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
    bound = _Bound(scene, tolerance, estimates)
    gone = [name for name in estimates if forced.get(name) is False]
    # the gas takes its own effects along, so it is asked first
    for name in sorted(estimates, key=lambda n: (n != "gas", estimates[n].redraws, estimates[n].own_deg)):
        along = [n for n in estimates if n in NEED_GAS] if name == "gas" else []
        free = name not in forced and not any(forced.get(n) for n in along)
        if free and estimates[name].saves and bound.allows([*gone, *along, name]):
            gone += [n for n in (*along, name) if n not in gone]
    answers = [
        Answer(name=name, active=False, reason=_absent(name), omission_error_deg=0.0, omission_error_m=0.0)
        for name in QUESTIONS
        if name not in estimates
    ]
    for name, estimate in estimates.items():
        angle, slip = bound.of([name])
        reason = estimate.reason if name not in forced else f"forced; {estimate.reason}"
        if scene.lift_m is not None and angle > 0.0 and not bound.firm:
            reason += "; the grasp is not known to bear a disturbance, the object may be lost"
        answers.append(
            Answer(name=name, active=name not in gone, reason=reason, omission_error_deg=angle, omission_error_m=slip)
        )
    order = list(QUESTIONS)
    return replace(scene.offered, **dict.fromkeys(gone)), tuple(sorted(answers, key=lambda a: order.index(a.name)))


def declared(scene: SceneFacts, kept: Effects, tolerance: Tolerance) -> tuple[float, float]:
    """Return what a scene with some effects differs by at most: angle [deg] and slip [m] (`choose`)."""
    estimates = {name: QUESTIONS[name](scene) for name in scene.offered.present}
    gone = [name for name in estimates if name not in kept.present]
    return _Bound(scene, tolerance, estimates).of(gone) if gone else (0.0, 0.0)


def _absent(name: str) -> str:
    return "no leak is declared" if name == "leaks" else "not offered"


class _Bound:
    """What leaving effects out together changes at most."""

    def __init__(self, scene: SceneFacts, tolerance: Tolerance, estimates: Mapping[str, Estimate]) -> None:
        self._scene, self._tolerance, self._estimates = scene, tolerance, estimates
        self._arm_m = scene.calibration.finger.length_m
        # a disturbed grasp takes trials: only where the answer matters
        alone = [self._estimated_deg([name]) for name in estimates]
        self.firm = any(0.0 < error <= tolerance.angle_deg for error in alone) and scene.firm

    def allows(self, gone: list[str]) -> bool:
        """Whether all of these together stay within the tolerance."""
        angle, slip = self.of(gone)
        return angle <= self._tolerance.angle_deg and slip <= self._tolerance.slip_m

    def of(self, gone: list[str]) -> tuple[float, float]:
        """Return the largest change of a tip's angle [deg] and of the slip [m]."""
        scene, angle = self._scene, self._estimated_deg(gone)
        if angle > 0.0 and not self.firm and scene.lift_m is not None:
            angle = math.inf
        slip = 0.0 if scene.lift_m is None else min(self._arm_m * math.radians(min(angle, 360.0)), scene.lift_m)
        return min(angle, scene.loss_deg), slip

    def _estimated_deg(self, gone: list[str]) -> float:
        # without gas there is no controller's band, and its own error has that of all flow effects in it
        left = [self._estimates[n] for n in gone if "gas" not in gone or n not in NEED_GAS]
        band = self._scene.band_deg if "gas" not in gone and any(e.redraws for e in left) else 0.0
        return band + sum(e.own_deg for e in left)
