"""Numbered draws of white noise."""

import threading

import numpy as np


class NumberedNoise:
    """Standard normal draws that depend on a seed and a number alone, whatever was drawn before.

    Draw ``n`` comes from the Philox generator with the seed as key and ``n`` as the second word of its counter. One
    generator is set to that place for each draw, which takes a seventh of the time of making a new one.
    """

    def __init__(self) -> None:
        self._bits = np.random.Philox(key=0)
        self._normal = np.random.Generator(self._bits).standard_normal
        self._state = self._bits.state
        self._empty = self._state["buffer_pos"]
        self._lock = threading.Lock()

    def __reduce__(self) -> tuple[type["NumberedNoise"], tuple[()]]:
        return NumberedNoise, ()

    def draw(self, seed: int, number: int, count: int) -> list[float]:
        """Return ``count`` draws for a seed below 2**64 and a number from 0."""
        with self._lock:
            state = self._state
            state["state"]["key"][0] = seed
            state["state"]["counter"][:] = (0, number, 0, 0)
            state["buffer_pos"], state["has_uint32"] = self._empty, 0
            self._bits.state = state
            drawn: list[float] = self._normal(count).tolist()
            return drawn
