"""Whether a calibration file is as it was written: checksum, finite numbers, units in the names of dimensions."""

import hashlib
import json
from typing import Any

from softhand_sim.calibration.fields import Fields, not_finite

CHECKSUM = "content_sha256"
"""Field with the SHA-256 of all others, as compact as ``json.dumps(..., sort_keys=True)`` writes them."""
_UNITS = ("_m", "_rad", "_count")


def content_sha256(content: dict[str, Any]) -> str:
    """Return the SHA-256 of a calibration file's fields but the checksum itself."""
    others = {key: value for key, value in content.items() if key != CHECKSUM}
    return hashlib.sha256(json.dumps(others, sort_keys=True, allow_nan=False).encode()).hexdigest()


def check_whole(root: Fields) -> None:
    """Refuse a file whose content is not what was written.

    A file without a checksum, written by hand, has only its fields checked.

    Raises
    ------
    ValueError
        If a number anywhere is not finite, or the checksum is not that of the content.
    """
    bad = not_finite(root.raw)
    if bad is not None:
        raise root.error(*bad, "finite")
    if CHECKSUM in root.raw and root.raw[CHECKSUM] != (found := content_sha256(root.raw)):
        allowed = f"{found[:12]}..., that of the content; the file was damaged, or edited: then remove this field"
        raise root.error(CHECKSUM, root.raw[CHECKSUM], allowed)


def read_geometry(geometry: Fields) -> dict[str, Any]:
    """Return the dimensions; every one is a number, or a list of numbers, with its unit in its name.

    Raises
    ------
    ValueError
        If one has no unit (``_m``, ``_rad``) or isn't a number.
    """
    for name, value in geometry.raw.items():
        if not name.endswith(_UNITS):
            raise geometry.error(name, value, f"a name that ends with a unit, {', '.join(_UNITS)}")
        geometry.numbers(name, (None,) if isinstance(value, list) else ())
    return geometry.raw
