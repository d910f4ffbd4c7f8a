"""The engine's step as compiled loops take it: by address, its fatal errors caught.

At a fatal error (no memory, say) the engine ends the process unless its caller catches that, as `mujoco.mj_step` does.
So does `mjb_apply` of the engine's own batches, for a function that it calls: here one that steps a world of ours,
while the batch itself is of an empty model.
"""

import ctypes
import weakref
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numba
import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from softhand_sim.compiling import callback, inner

# choice: an empty world needs almost none; the default would be 13 MB for each hand
_EMPTY = '<mujoco><size memory="16K"/></mujoco>'
_WORD, _INT = ir.IntType(64), ir.IntType(32)
APPLY, BATCH, STEPPER, WORLD = range(4)
"""Entries of `EngineGuard.words`, the argument of `guarded_step`; from WORLD on it is what the stepper gets."""


class _Config(ctypes.Structure):
    """``mjBatchConfig``."""

    _fields_ = (("nthread", ctypes.c_int), ("persistent", ctypes.c_ubyte))


class EngineGuard:
    """Lets compiled loops step one world, and tells what the engine said if it failed.

    Attributes
    ----------
    words: addresses, int64, for `guarded_step`.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        library = _library()
        self._kept = model, data, mujoco.MjModel.from_xml_string(_EMPTY)
        message = ctypes.create_string_buffer(200)
        self._batch = library.mjb_makeBatch(
            self._kept[2]._address, 1, ctypes.byref(_Config(1, 0)), message, len(message)
        )
        if not self._batch:
            raise RuntimeError(f"the engine made no batch: {message.value.decode()}")
        weakref.finalize(self, library.mjb_deleteBatch, self._batch)
        world = (_address("mj_step"), model._address, data._address)
        self.words = np.array([_address("mjb_apply"), self._batch, _stepper().address, *world], dtype=np.int64)

    def raise_error(self) -> None:
        """Raise the engine's last error.

        Raises
        ------
        mujoco.FatalError
            Always.
        """
        raise mujoco.FatalError(_library().mjb_error(self._batch, 0).decode())


@cache
def _library() -> Any:
    """Return the engine's library, which `mujoco` has loaded already."""
    folder = Path(mujoco.__file__).parent
    found = [path for name in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll") for path in folder.glob(name)]
    library = ctypes.CDLL(str(found[0]))
    pointer, number = ctypes.c_void_p, ctypes.c_int
    library.mjb_makeBatch.restype = pointer
    library.mjb_makeBatch.argtypes = [pointer, number, pointer, ctypes.c_char_p, number]
    library.mjb_deleteBatch.restype, library.mjb_deleteBatch.argtypes = None, [pointer]
    library.mjb_error.restype, library.mjb_error.argtypes = ctypes.c_char_p, [pointer, number]
    return library


def _address(function: str) -> int:
    return int(ctypes.cast(getattr(_library(), function), ctypes.c_void_p).value or 0)


@cache
def _stepper() -> Any:
    return callback("void(intp, intp, int32, voidptr)", _step_given)


def _step_given(_model: Any, _data: Any, _number: Any, given: Any) -> None:
    """``mjfBatchFunc``: step the world whose addresses are given instead of the batch's."""
    words = numba.carray(given, 3, np.int64)
    _call(words[0], words[1], words[2])


@intrinsic  # type: ignore[untyped-decorator]
def _call(context: Any, function: Any, model: Any, data: Any) -> Any:
    """Call ``void function(model, data)``, all given by address."""
    del context, function, model, data

    def generate(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), [_WORD, _WORD]).as_pointer()
        builder.call(builder.inttoptr(arguments[0], kind), arguments[1:])
        return context.get_dummy_value()

    return types.void(types.intp, types.intp, types.intp), generate


@intrinsic  # type: ignore[untyped-decorator]
def _apply(context: Any, function: Any, batch: Any, stepper: Any, given: Any) -> Any:
    """Call ``mjb_apply(batch, NULL, 1, stepper, given, 0)``."""
    del context, function, batch, stepper, given

    def generate(_: Any, builder: Any, __: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_INT, [_WORD, _WORD, _INT, _WORD, _WORD, _INT]).as_pointer()
        rest = [arguments[1], _WORD(0), _INT(1), arguments[2], arguments[3], _INT(0)]
        return builder.call(builder.inttoptr(arguments[0], kind), rest)

    return types.int32(types.intp, types.intp, types.intp, types.intp), generate


@inner
def guarded_step(words: npt.NDArray[np.int64]) -> bool:
    """Take one step of a guard's world; whether it succeeded."""
    failed: int = _apply(words[APPLY], words[BATCH], words[STEPPER], words[WORLD:].ctypes.data)
    return failed == 0
