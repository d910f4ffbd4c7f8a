"""Range checks that name the field, the value and what is allowed, in one line."""

import sys

_LARGEST = sys.float_info.max


def require_finite(name: str, value: float, *, above: float | None = None, at_least: float | None = None) -> float:
    """Return ``value`` if it is a finite number above (or at least) a bound.

    Raises
    ------
    ValueError
        Otherwise; the message names the field, the value and the allowed range.
    """
    allowed = "finite"
    if above is not None:
        allowed = f"finite and > {above:g}"
    elif at_least is not None:
        allowed = f"finite and >= {at_least:g}"
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if (
        not is_number
        or not abs(value) <= _LARGEST  # NaN, infinity, and whole numbers that no float holds
        or (above is not None and not value > above)
        or (at_least is not None and not value >= at_least)
    ):
        raise ValueError(f"{name} = {value!r}: must be a number, {allowed}")
    return float(value)


def require_in(name: str, value: float, low: float, high: float) -> float:
    """Return ``value`` if it is a number in ``[low, high]``.

    Raises
    ------
    ValueError
        Otherwise; the message names the field, the value and the allowed range.
    """
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not low <= value <= high:
        raise ValueError(f"{name} = {value!r}: must be a number in [{low:g}, {high:g}]")
    return float(value)
