"""Typed access to a JSON file's fields, with errors that name the file and the field."""

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class Fields:
    """A JSON object, the file it came from and its place in it."""

    path: Path
    place: str
    raw: dict[str, Any]

    def error(self, name: str, value: object, allowed: str) -> ValueError:
        """Return the error that says what is wrong with a field, in one line."""
        return ValueError(f"{self.path}: {self.place}{name} = {_brief(value)}: must be {allowed}")

    def value(self, name: str) -> Any:
        """Return a field's value; an error if it is missing."""
        if name not in self.raw:
            bare = [key for key in self.raw if self.place and name.startswith(f"{key}_")]
            hint = f"; {bare[0]} has no unit in its name" if bare else ""
            raise ValueError(f"{self.path}: {self.place}{name} is missing{hint}")
        return self.raw[name]

    def require_equal(self, name: str, expected: str | int) -> None:
        """Raise unless a field has the expected value."""
        value = self.value(name)
        if value != expected:
            raise self.error(name, value, repr(expected))

    def object(self, name: str) -> "Fields":
        """Return a field that is an object."""
        value = self.value(name)
        if not isinstance(value, dict):
            raise self.error(name, value, "an object")
        return Fields(path=self.path, place=f"{self.place}{name}.", raw=value)

    def objects(self, name: str, count: int) -> tuple["Fields", ...]:
        """Return a field that is a list of ``count`` objects."""
        value = self.value(name)
        if not isinstance(value, list) or len(value) != count or not all(isinstance(v, dict) for v in value):
            raise self.error(name, value, f"a list of {count} objects")
        return tuple(Fields(path=self.path, place=f"{self.place}{name}[{k}].", raw=v) for k, v in enumerate(value))

    def text(self, name: str) -> str:
        """Return a field that is a string."""
        value = self.value(name)
        if not isinstance(value, str):
            raise self.error(name, value, "a string")
        return value

    def list_of(self, name: str, kind: type[T]) -> tuple[T, ...]:
        """Return a field that is a list of values of one type (``str`` or ``bool``)."""
        value = self.value(name)
        if not isinstance(value, list) or not all(isinstance(item, kind) for item in value):
            raise self.error(name, value, f"a list of {kind.__name__}")
        return tuple(value)

    def numbers(self, name: str, shape: tuple[int | None, ...]) -> npt.NDArray[np.float64]:
        """Return a field that is an array of finite numbers; ``None`` in ``shape`` means any length."""
        value = self.value(name)
        text = "(" + ", ".join("n" if size is None else str(size) for size in shape) + ")"
        try:
            array = np.array(_only_numbers(value), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise self.error(name, value, f"an array of numbers of shape {text}") from None
        fits = array.ndim == len(shape) and all(
            wanted is None or wanted == size for wanted, size in zip(shape, array.shape, strict=True)
        )
        if not fits:
            raise self.error(name, value, f"an array of numbers of shape {text}")
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            index = "".join(f"[{k}]" for k in bad[0])
            raise self.error(f"{name}{index}", float(array[tuple(bad[0])]), "finite")
        array.setflags(write=False)
        return array

    def build(self, kind: type[T], **read: Any) -> T:
        """Return ``kind``, a dataclass, from the fields of the same names, but for those in ``read``."""
        names = [field.name for field in fields(kind)]  # type: ignore[arg-type]
        values = {name: self.value(name) for name in names if name not in read}
        try:
            return kind(**values, **read)
        except ValueError as error:
            raise ValueError(f"{self.path}: {self.place}{error}") from None

    def build_only(self, kind: type[T], **read: Any) -> T:
        """Return ``kind`` like :meth:`build`; an error if there are other fields."""
        names = [field.name for field in fields(kind)]  # type: ignore[arg-type]
        for name in self.raw:
            if name not in names:
                raise self.error(name, self.raw[name], f"absent: an unknown field; known: {', '.join(names)}")
        return self.build(kind, **read)

    @contextmanager
    def naming_file(self) -> Iterator[None]:
        """Put the file's name in front of errors that lack it."""
        try:
            yield
        except ValueError as error:
            if str(error).startswith(f"{self.path}: "):
                raise
            raise ValueError(f"{self.path}: {error}") from None


def read_fields(path: Path) -> Fields:
    """Return the object that a JSON file holds.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it isn't JSON, not an object, or holds a field twice.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such calibration file")
    try:
        raw = json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=_once)
    except _TwiceError as error:
        raise ValueError(f"{path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: not a JSON file: {error}") from None
    if not isinstance(raw, dict):
        raise ValueError(f"{path}: holds a {type(raw).__name__}: must be an object")
    return Fields(path=path, place="", raw=raw)


def not_finite(value: Any, place: str = "") -> tuple[str, float] | None:
    """Return place and value of the first number that is not finite in a JSON value, None if all are."""
    if isinstance(value, float) and not math.isfinite(value):
        return place, value
    if isinstance(value, dict):
        inner = ((f"{place}.{key}" if place else key, item) for key, item in value.items())
    elif isinstance(value, list):
        inner = ((f"{place}[{k}]", item) for k, item in enumerate(value))
    else:
        return None
    return next((bad for where, item in inner if (bad := not_finite(item, where)) is not None), None)


class _TwiceError(ValueError):
    """An object holds a field twice."""


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise _TwiceError(f"{twice}: must not be there twice in one object")
    return made


def _only_numbers(value: Any) -> Any:
    """Return nested lists as they are; NumPy itself would take texts and truth values as numbers."""
    if isinstance(value, list):
        return [_only_numbers(item) for item in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    return value


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
