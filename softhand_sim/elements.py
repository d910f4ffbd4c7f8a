"""Controllable elements and their fingers: the one place that knows which finger hangs on which manifold."""

from collections.abc import Sequence

FINGERS: tuple[str, ...] = ("thumb", "index", "middle", "ring", "little")
"""Fingers, in the order of every per-finger quantity of this package."""

ELEMENT_FINGERS: dict[str, tuple[str, ...]] = {
    "thumb": ("thumb",),
    "index": ("index",),
    "middle_ring_little": ("middle", "ring", "little"),
}
"""Fingers of each element (the paper's three controllable elements)."""

ELEMENTS: tuple[str, ...] = tuple(ELEMENT_FINGERS)
"""Elements, in the order of every per-element quantity of this package."""

FINGERS_OF_ELEMENT: tuple[tuple[int, ...], ...] = tuple(
    tuple(FINGERS.index(finger) for finger in ELEMENT_FINGERS[name]) for name in ELEMENTS
)
"""Indices into ``FINGERS`` for each element."""

ELEMENT_OF_FINGER: tuple[int, ...] = tuple(
    next(k for k, name in enumerate(ELEMENTS) if finger in ELEMENT_FINGERS[name]) for finger in FINGERS
)
"""Index into ``ELEMENTS`` for each finger."""


def spread_to_fingers(per_element: Sequence[float]) -> tuple[float, ...]:
    """Return a value per finger (5) from one per element (3)."""
    thumb, index, rest = per_element  # written out: called every step
    return thumb, index, rest, rest, rest


def sum_over_fingers(per_finger: Sequence[float]) -> tuple[float, ...]:
    """Return the sum over each element's fingers (3) from a value per finger (5)."""
    thumb, index, middle, ring, little = per_finger  # written out: called every step
    return thumb, index, middle + ring + little
