"""A finger between the members of an ensemble: every number of its calibration is interpolated.

Differences from the nominal finger add up. Between it and a member a torque law stays monotone, since monotone cubics
are a convex cone; where several differences, or a mirrored one, leave the cone, the nearest monotone law is taken. In
all else the calibration's reader has the last word.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from softhand_sim.calibration.integrity import CHECKSUM, content_sha256
from softhand_sim.checks import require_in
from softhand_sim.uncertainty.ensemble import TOLERANCE, Ensemble, Member, Source
from softhand_sim.uncertainty.monotone import nearest_monotone

_PARTS = ("geometry", "finger", "joints", "tendon", "chamber", "sliding")
_TORQUE = ("stiffness_n_m_per_rad", "stiffness_n_m_per_rad2", "stiffness_n_m_per_rad3")
FURTHEST = 2.0
"""Choice: twice the tolerance; what a finger does was solved at its ends."""


def drawn_coordinates(
    ensemble: Ensemble, count: int, rng: np.random.Generator, *, spread: float = 1.0
) -> list[dict[str, float]]:
    """Draw fingers: a place on the axis of every tolerance, uniform in [-spread, spread].

    Latin hypercube (McKay, Beckman, Conover, Technometrics 21, 1979): each axis is cut into ``count`` equal parts, and
    each part has one finger.

    Raises
    ------
    ValueError
        If ``spread`` is not in [0, 2].
    """
    require_in("spread", spread, 0.0, FURTHEST)
    names = [source.name for source in ensemble.of_kind(TOLERANCE)]
    columns = [2.0 * (rng.permutation(count) + rng.random(count)) / count - 1.0 for _ in names]
    return [
        {name: float(spread * column[k]) for name, column in zip(names, columns, strict=True)} for k in range(count)
    ]


def weights(ensemble: Ensemble, coordinates: Mapping[str, float]) -> list[tuple[Member, float]]:
    """Return how much of each member's difference from the nominal finger a finger at some coordinates has.

    Linear between the nominal finger and the member on that side; where a side has no member, the other one mirrored.

    Raises
    ------
    ValueError
        If there is no such source of tolerance, or a coordinate is not in [-2, 2].
    """
    known = {source.name: source for source in ensemble.of_kind(TOLERANCE)}
    found = []
    for name, at in coordinates.items():
        if name not in known:
            raise ValueError(f"coordinates.{name}: no such tolerance; known: {', '.join(known)}")
        require_in(f"coordinates.{name}", at, -FURTHEST, FURTHEST)
        if at != 0.0:
            member, place = _on_side(known[name], at)
            found.append((member, at / place))
    return found


def blended(ensemble: Ensemble, coordinates: Mapping[str, float]) -> dict[str, Any]:
    """Return the contents of a calibration file for a finger at some coordinates; those left out are 0.

    Differences from the nominal finger add up. The table of the complete finger (``fea``) is the nominal finger's.

    Raises
    ------
    ValueError
        As :func:`weights`, or if members and nominal finger have curves at different pressures, or add up to a joint
        without stiffness.
    """
    nominal = ensemble.nominal.content
    assert nominal is not None
    shares = [(member.content, share) for member, share in weights(ensemble, coordinates) if member.content is not None]
    made = {key: value for key, value in nominal.items() if key != CHECKSUM}
    for part in _PARTS:
        made[part] = _moved(nominal[part], [(content[part], share) for content, share in shares])
    for joint in made["joints"]:
        joint |= dict(zip(_TORQUE, nearest_monotone(*(joint[name] for name in _TORQUE)), strict=True))
    made["curve"] = _curve(nominal["curve"], [(content["curve"], share) for content, share in shares])
    made["provenance"] = {
        **nominal["provenance"],
        "interpolated": {
            "coordinates": dict(coordinates),
            "text": "between members of an ensemble; fea, fit_rmse and all other provenance are the nominal finger's",
        },
    }
    return made | {CHECKSUM: content_sha256(made)}


def _on_side(source: Source, at: float) -> tuple[Member, float]:
    places = {member.at: member for member in source.solved if member.at is not None}
    place = next((p for p in places if p * at > 0.0), next(iter(places)))
    return places[place], place


def _moved(nominal: Any, others: list[tuple[Any, float]]) -> Any:
    """Return a nested value with its numbers moved by shares of the others' differences."""
    if isinstance(nominal, dict):
        return {key: _moved(value, [(other[key], share) for other, share in others]) for key, value in nominal.items()}
    if isinstance(nominal, list):
        return [_moved(value, [(other[k], share) for other, share in others]) for k, value in enumerate(nominal)]
    if isinstance(nominal, float):
        return nominal + sum(share * (other - nominal) for other, share in others)
    return nominal


def _curve(nominal: Any, others: list[tuple[Any, float]]) -> Any:
    """Return the curve up to the lowest of the highest pressures, its angles moved and the tip's their sum again."""
    count = min(len(curve["pressure_pa_gauge"]) for curve in (nominal, *(other for other, _ in others)))
    pressure = nominal["pressure_pa_gauge"][:count]
    for other, _ in others:
        if other["pressure_pa_gauge"][:count] != pressure:
            raise ValueError("curve.pressure_pa_gauge: must be the nominal finger's in every member")
    joints = _moved(nominal["joint_angle_deg"][:count], [(o["joint_angle_deg"], share) for o, share in others])
    return {
        "pressure_pa_gauge": pressure,
        "tip_angle_deg": [float(sum(row)) for row in joints],
        "joint_angle_deg": joints,
    }
