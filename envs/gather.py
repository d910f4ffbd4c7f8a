"""The observed vector of a state in one compiled call; `Observer.see_plainly` has the same in NumPy, slower."""

import numpy as np
import numpy.typing as npt

from softhand_sim.compiling import entry, inner

F64 = npt.NDArray[np.float64]
I64 = npt.NDArray[np.int64]


@inner
def _in_palm(xpos: F64, xquat: F64, palm: int, body: int, out: F64) -> None:
    """`object_in_palm`: turn back by the palm's quaternion (w, v), a + 2 v x (v x a + w a) with -v."""
    w, x, y, z = xquat[palm, 0], -xquat[palm, 1], -xquat[palm, 2], -xquat[palm, 3]
    a, b, c = xpos[body, 0] - xpos[palm, 0], xpos[body, 1] - xpos[palm, 1], xpos[body, 2] - xpos[palm, 2]
    p, q, r = w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a
    out[0] = a + 2.0 * (y * r - z * q)
    out[1] = b + 2.0 * (z * p - x * r)
    out[2] = c + 2.0 * (x * q - y * p)
    d, e, f, g = xquat[body, 0], xquat[body, 1], xquat[body, 2], xquat[body, 3]
    out[3] = w * d - x * e - y * f - z * g
    out[4] = w * e + x * d + y * g - z * f
    out[5] = w * f - x * g + y * d + z * e
    out[6] = w * g + x * f - y * e + z * d
    if out[3] < 0.0:
        for k in range(3, 7):
            out[k] *= -1.0


@inner
def _clip(low: F64, high: F64, out: F64) -> None:
    for k in range(out.shape[0]):
        # so ordered that a NaN stays one
        if out[k] < low[k]:
            out[k] = low[k]
        elif out[k] > high[k]:
            out[k] = high[k]


@entry
def gather(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    reading: F64, valves: F64, sets: F64, pressure: F64, qpos: F64, qvel: F64, positions: I64, velocities: I64,
    xpos: F64, xquat: F64, palm: int, body: int, own: F64, commanded: F64, low: F64, high: F64, out: F64,
) -> None:  # fmt: skip
    """Write an observation, clipped to its bounds.

    Parameters
    ----------
    reading, valves, sets, pressure
        Of the gas [Pa gauge], (3,), valves (6,).
    qpos, qvel, xpos, xquat
        The engine's.
    positions, velocities
        Where wrist and joints, (21,), and joints and object, (21,), are in the first two.
    palm, body
        Numbers of the palm's and the object's body.
    own
        The object's height at rest [m], mass [kg] and friction, (3,).
    commanded
        What the task adds at the end, (t,).
    low, high, out
        Bounds, and the vector: `HARDWARE`, `PRIVILEGED` where there is room for it, and what is commanded, (n,).
    """
    hardware = 15
    for k in range(3):
        out[k] = 1e-3 * reading[k]
    for k in range(6):
        out[3 + k], out[9 + k] = valves[k], qpos[positions[k]]
    end = out.shape[0] - commanded.shape[0]
    if end > hardware:
        for k in range(3):
            out[15 + k], out[18 + k] = 1e-3 * sets[k], 1e-3 * pressure[k]
        for k in range(15):
            out[21 + k], out[36 + k] = qpos[positions[6 + k]], qvel[velocities[k]]
        _in_palm(xpos, xquat, palm, body, out[51:58])
        for k in range(6):
            out[58 + k] = qvel[velocities[15 + k]]
        out[64], out[65], out[66] = xpos[body, 2] - own[0], own[1], own[2]
    for k in range(commanded.shape[0]):
        out[end + k] = commanded[k]
    _clip(low, high, out)
