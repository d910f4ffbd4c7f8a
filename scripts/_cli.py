"""What every script does alike: one-line errors, a JSON file that is either whole or absent."""

import argparse
import json
import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NoReturn, TypeVar

BAD_INPUT = 2
INCOMPLETE = 1
_Geometry = TypeVar("_Geometry", bound=Any)


class Parser(argparse.ArgumentParser):
    """Command line with examples kept as written, and one line on a wrong call."""

    def __init__(self, *, description: str | None, examples: str) -> None:
        super().__init__(description=description, epilog=examples, formatter_class=argparse.RawDescriptionHelpFormatter)

    def add_common(self, *, seed: str, json: str) -> None:
        """Add ``--seed`` and ``--json``, which every script has, with their help texts."""
        self.add_argument("--seed", type=non_negative_int, default=0, help=f"{seed} (default 0)")
        self.add_argument("--json", type=Path, metavar="FILE", help=json)

    def error(self, message: str) -> NoReturn:
        """Say what is wrong in one line and exit with status 2."""
        print(f"error: {message}", file=sys.stderr)
        raise SystemExit(BAD_INPUT)


def positive_float(text: str) -> float:
    """Parse a finite number above zero (argparse type)."""
    value = float(text)
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"{text} must be a finite number above 0")
    return value


def non_negative_float(text: str) -> float:
    """Parse a finite number, zero or above (argparse type)."""
    value = float(text)
    if not (math.isfinite(value) and value >= 0.0):
        raise argparse.ArgumentTypeError(f"{text} must be a finite number of 0 or above")
    return value


def positive_int(text: str) -> int:
    """Parse a whole number of 1 or above (argparse type)."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} must be a whole number of 1 or above")
    return value


def non_negative_int(text: str) -> int:
    """Parse a whole number of 0 or above (argparse type)."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text} must be a whole number of 0 or above")
    return value


def rising_pressures(text: str) -> tuple[float, ...]:
    """Return the gauge pressures [Pa] of ``--pressures``, comma-separated in kPa.

    Raises
    ------
    ValueError
        If they are no numbers, do not increase, or do not lie in (0, 1000) kPa.
    """
    try:
        found = tuple(1e3 * float(item) for item in text.split(","))
    except ValueError:
        raise ValueError(f"--pressures {text}: must be numbers in kPa, comma-separated") from None
    if not all(0.0 < p < 1e6 for p in found) or any(a >= b for a, b in pairwise(found)):
        raise ValueError(f"--pressures {text}: must increase and lie in (0, 1000) kPa")
    return found


def check_writable(path: Path | None, option: str = "--json") -> None:
    """Make sure before the work that its result can be written (creates the folder).

    Raises
    ------
    ValueError
        If `path` is a folder or its folder cannot be written.
    """
    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"{option} {path}: folder cannot be made ({error.strerror})") from None
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise ValueError(f"{option} {path}: not a writable file")


def add_dimension(parser: argparse.ArgumentParser) -> None:
    """Add ``--dimension NAME=VALUE``, which may be given more than once."""
    parser.add_argument(
        "--dimension", type=_named_number, action="append", default=[], metavar="NAME=VALUE", help="a dimension in SI"
    )


def add_materials(parser: argparse.ArgumentParser) -> None:
    """Add ``--materials SILICONE TPU``."""
    text = "parameter sets of the silicone and of the TPU (set3 set3)"
    parser.add_argument("--materials", nargs=2, metavar=("SILICONE", "TPU"), default=["set3", "set3"], help=text)


def add_friction(parser: argparse.ArgumentParser, default: float) -> None:
    """Add ``--friction MU``."""
    text = "Coulomb's coefficient of silicone on TPU (%(default)s)"
    parser.add_argument("--friction", type=non_negative_float, default=default, metavar="MU", help=text)


def with_dimensions(geometry: _Geometry, dimensions: Sequence[tuple[str, float]]) -> _Geometry:
    """Return a geometry (a dataclass) with some of its numbers replaced.

    Raises
    ------
    ValueError
        If there is no such dimension, or the geometry refuses its value.
    """
    allowed = {f.name: f.type for f in fields(geometry) if f.type in (float, int)}
    for name, value in dimensions:
        if name not in allowed:
            raise ValueError(f"--dimension {name}: no such dimension; allowed: {', '.join(sorted(allowed))}")
        if allowed[name] is int and not value.is_integer():
            raise ValueError(f"--dimension {name}: {value:g} must be a whole number")
    return replace(geometry, **{name: int(v) if allowed[name] is int else v for name, v in dimensions})


def _named_number(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} must read NAME=VALUE") from None


def write_bytes(path: Path, data: bytes) -> None:
    """Write `data` in one piece."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    partial.write_bytes(data)
    partial.replace(path)


def write_text(path: Path, text: str) -> None:
    """Write `text` in one piece: a reader sees the whole file or none."""
    write_bytes(path, text.encode("utf-8"))


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write `data` as JSON in one piece; refuses NaN and infinity."""
    write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


def run(job: Callable[[Sequence[str] | None], int], argv: Sequence[str] | None = None) -> int:
    """Call a script's job and turn bad input into one line on stderr and exit status 2."""
    try:
        return job(argv)
    except (ValueError, FileNotFoundError) as error:
        text = " ".join(str(error).split())
        print(f"error: {text}", file=sys.stderr)
        return BAD_INPUT
