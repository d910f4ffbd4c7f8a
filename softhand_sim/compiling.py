"""Compiled loops: how they are compiled, and when their machine code on disk is out of date.

numba's cache on disk knows a kernel by its own file and the types of its arguments. A kernel that calls others gets,
among its arguments, a record whose type carries a digest of all their files (`sources_field`): whenever one of them
changes, the type does, and the kernel is compiled anew.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

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


def sources_field(*folders: Path) -> tuple[str, str]:
    """Return a field of a record type whose name is a digest of all Python files of some folders."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.glob("*.py")):
            digest.update(path.read_bytes())
    return f"sources_{digest.hexdigest()[:16]}", "u1"
