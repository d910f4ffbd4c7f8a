"""Compiled loops: how they are compiled, and when their machine code on disk is out of date.

numba's cache on disk knows a kernel by its own file and the types of its arguments. A kernel that calls others gets,
among its arguments, a record whose type carries a digest of all their files (`sources_field`): whenever one of them
changes, the type does, and the kernel is compiled anew.
"""

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy as np
from numba.core.caching import FunctionCache

try:
    import fcntl
except ImportError:  # a system without it: no lock
    fcntl = None  # type: ignore[assignment]

Function = TypeVar("Function", bound=Callable[..., Any])

_OPTIONS = {"nogil": True, "error_model": "numpy"}


def inner(function: Function) -> Function:
    """Compile a function that only other kernels call; its machine code becomes part of theirs."""
    kernel: Function = numba.njit(**_OPTIONS)(function)
    return kernel


def entry(function: Function) -> Function:
    """Compile a kernel on first use and keep its code on disk, or in memory where no cache folder is writable."""
    try:
        kernel: Function = numba.njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:
        kernel = numba.njit(**_OPTIONS)(function)
    return kernel


def compile_for(kernel: Any, *arguments: Any) -> None:
    """Compile an entry for the types of some arguments, or load its code from disk, before it is first called.

    One process at a time: the index of numba's cache on disk has no lock, and two processes that add to it at once can
    leave each other's code under the wrong types.
    """
    types = tuple(numba.typeof(argument) for argument in arguments)
    if types not in kernel.overloads:
        with _alone(kernel.stats.cache_path):
            kernel.compile(types)


def loaded(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """Return an entry's code for the types of some arguments; it looks at no types any more, so they must be these."""
    codes, kinds = _codes(kernel), tuple(_kind(argument) for argument in arguments)
    if kinds not in codes:
        compile_for(kernel, *arguments)
        codes[kinds] = kernel.overloads[tuple(numba.typeof(argument) for argument in arguments)].entry_point
    code: Callable[..., Any] = codes[kinds]
    return code


@cache
def _codes(_: Any) -> dict[tuple[Any, ...], Callable[..., Any]]:
    """Return the memory of `loaded` for a kernel: numba takes milliseconds to tell the type of a record."""
    return {}


def _kind(argument: Any) -> Any:
    if not isinstance(argument, np.ndarray):
        return type(argument)
    flags = argument.flags
    return argument.dtype, argument.ndim, flags.c_contiguous, flags.f_contiguous, flags.writeable, flags.aligned


def callback(signature: str, function: Callable[..., Any]) -> Any:
    """Compile a function that the engine may call, or load its code from disk; its ``address`` is an attribute."""
    try:
        folder = FunctionCache(function).cache_path
    except RuntimeError:
        return numba.cfunc(signature)(function)
    with _alone(folder):
        return numba.cfunc(signature, cache=True)(function)


@contextmanager
def _alone(folder: str | None) -> Iterator[None]:
    if folder is None or fcntl is None:
        yield
        return
    Path(folder).mkdir(parents=True, exist_ok=True)
    with (Path(folder) / "softhand_sim.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def sources_field(*folders: Path) -> tuple[str, str]:
    """Return a field of a record type whose name is a digest of all Python files of some folders."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.glob("*.py")):
            digest.update(path.read_bytes())
    return f"sources_{digest.hexdigest()[:16]}", "u1"
