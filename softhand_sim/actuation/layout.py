"""How hands lie in arrays: one record with what they share, one a world with its state."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from softhand_sim.actuation.parts import HandParts
from softhand_sim.control.onoff import OnOffController
from softhand_sim.elements import ELEMENT_OF_FINGER, FINGERS
from softhand_sim.pneumatics.compiled.layout import GAS_SHAPE, SCRATCH_SHAPE, orifice_row

_FINGERS = len(FINGERS)
GAS, SET, GIVEN = range(3)
"""Where the fingers' pressures come from: the gas, the set pressures at once, or recorded ones."""


def hand_dtype(branches: int, hinges: int) -> np.dtype[Any]:
    """Return the record of what all worlds share; ``branches`` of relaxation, 0 for none, ``hinges`` of a finger.

    ``nodes`` and ``holes``, the leaks that are open, are scratch of one world's step. They lie here because a part of a
    record is not counted: each slice of an array of its own costs two atomic counts, which were two thirds of a step.
    """
    floats: tuple[str, ...] = (
        "volume",
        "area",
        "area_slope",
        "friction",
        "friction_stiffness",
        "tick",
        "opening",
        "closing",
    )
    floats += ("relief_thrust", "relief_spring", "relief_time", "wall_1", "wall_2", "wall_3")
    floats += ("volts", "low", "high", "counts", "noise_v", "offset")
    floats += ("dead_band", "control_ambient", "minimum_ticks", "dead_ticks")
    flags = ("delays", "leaks", "tubes", "losses", "relieves", "senses", "lookahead")
    return np.dtype(
        [
            *((name, "f8") for name in floats),
            *((name, "u1") for name in flags),
            ("leak", "f8", (_FINGERS, 4)),
            ("leak_start", "f8", _FINGERS),
            ("branches", "i8"),
            ("branch_stiffness", "f8", max(branches, 1)),
            ("branch_time", "f8", max(branches, 1)),
            ("straight", "f8", _FINGERS),
            ("highest_set", "f8", 3),
            *((name, "i8", _FINGERS) for name in ("tendon", "pressure_ctrl", "loss_ctrl", "element")),
            ("wrist_ctrl", "i8", 6),
            ("joint_qpos", "i8", (_FINGERS, hinges)),
            ("nodes", "f8", SCRATCH_SHAPE),
            ("holes", "f8", (_FINGERS, 4)),
        ]
    )


def world_dtype(branches: int, memory: int) -> np.dtype[Any]:
    """Return the record of one world's state; ``memory`` floats of the controller."""
    return np.dtype(
        [
            ("gas", "f8", GAS_SHAPE),
            ("open", "u1", 6),
            ("wanted", "u1", 6),
            ("waiting", "f8", 6),
            ("time", "f8"),
            ("to_tick", "f8"),
            ("left", "f8"),
            ("ticks", "i8"),
            ("noise_seed", "i8"),
            ("reading", "f8", 3),
            ("set", "f8", 3),
            ("memory", "f8", max(memory, 1)),
            ("slip", "f8", _FINGERS),
            ("bulge", "f8", _FINGERS),
            ("flow", "f8", (max(branches, 1), _FINGERS)),
            ("elongation", "f8", _FINGERS),
            ("volume", "f8", _FINGERS),
            ("pressure", "f8", _FINGERS),
            ("source", "u1"),
        ]
    )


def hand_record(hand: HandParts) -> npt.NDArray[np.void]:
    """Return what all worlds share, shape (1,)."""
    chamber, losses, index = hand.calibration.chamber, hand.losses, hand.index
    branches = 0 if losses.relaxation is None else len(losses.relaxation.time_s)
    records = np.zeros(1, hand_dtype(branches, index.joint_qpos.shape[1]))
    r = records[0]
    r["volume"], r["area"], r["area_slope"] = chamber.volume_m3, chamber.area_m2, chamber.area_slope_m
    if losses.sliding is not None:
        r["friction"], r["friction_stiffness"] = (
            losses.sliding.law.coefficient_per_rad / losses.sliding.law.stiffness_n_per_m,
            losses.sliding.law.stiffness_n_per_m,
        )
    r["branches"] = branches
    if losses.relaxation is not None:
        r["branch_stiffness"], r["branch_time"] = losses.relaxation.stiffness_n_per_m, losses.relaxation.time_s
    r["losses"], r["relieves"] = losses.any, losses.relief is not None
    r["wall_1"], r["wall_2"], r["wall_3"] = hand.calibration.tendon.polynomial
    if losses.relief is not None:
        law = losses.relief.law
        r["relief_thrust"], r["relief_spring"], r["relief_time"] = law.thrust_n, law.stiffness_n_per_m, law.time_s
    r["straight"], r["joint_qpos"], r["element"] = index.straight_length_m, index.joint_qpos, ELEMENT_OF_FINGER
    r["tendon"], r["pressure_ctrl"], r["loss_ctrl"] = index.tendon, index.pressure_ctrl, index.loss_ctrl
    r["wrist_ctrl"] = index.wrist_ctrl
    r["leak_start"] = math.inf
    if hand.pneumatics is not None:
        _add_pneumatics(r, hand)
    return records


def _add_pneumatics(r: Any, hand: HandParts) -> None:
    system = hand.pneumatics
    if system is None:
        return
    r["tick"], r["tubes"] = system.tick_s, system.elements[0].tubing is not None
    r["highest_set"] = system.highest_set_pa_gauge
    if system.delay is not None:
        r["delays"], r["opening"], r["closing"] = True, system.delay.opening_s, system.delay.closing_s
    r["leaks"] = bool(system.leaks)
    for leak in system.leaks:
        finger = FINGERS.index(leak.finger)
        r["leak"][finger], r["leak_start"][finger] = orifice_row(leak.orifice), leak.start_s
    if system.sensor is not None:
        s = system.sensor
        r["senses"], r["volts"], r["low"], r["high"] = True, s.supply_v, s.low_pa_abs, s.high_pa_abs
        r["counts"], r["noise_v"], r["offset"] = 1 << s.converter_bits, s.noise_v, s.offset_pa
    if type(system.controller) is OnOffController:
        c = system.controller
        r["dead_band"], r["control_ambient"], r["lookahead"] = c.dead_band_pa, c.ambient_pa_abs, c.lookahead
        r["minimum_ticks"], r["dead_ticks"] = c.minimum_pulse_ticks, c.dead_time_ticks
