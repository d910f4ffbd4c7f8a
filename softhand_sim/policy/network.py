"""A multilayer perceptron in plain NumPy: what a learned policy is when it runs, without any learning library."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Network:
    """Layers y = W x + b with tanh between them; the last one is linear.

    Attributes
    ----------
    weights
        Of each layer, (outputs, inputs).
    biases
        Of each layer, (outputs,).

    Raises
    ------
    ValueError
        If there is no layer, two do not fit, or a value is not finite; names the layer.
    """

    weights: tuple[Vector, ...]
    biases: tuple[Vector, ...]

    def __post_init__(self) -> None:
        if not self.weights or len(self.weights) != len(self.biases):
            raise ValueError(f"weights: {len(self.weights)} layers and {len(self.biases)} biases, must be as many")
        inputs = self.weights[0].shape[-1]
        for k, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            if weight.ndim != 2 or weight.shape[1] != inputs:
                raise ValueError(f"weight_{k}: shape {weight.shape} must be (outputs, {inputs})")
            if bias.shape != weight.shape[:1]:
                raise ValueError(f"bias_{k}: shape {bias.shape} must be {weight.shape[:1]}")
            if not (np.isfinite(weight).all() and np.isfinite(bias).all()):
                raise ValueError(f"weight_{k}, bias_{k}: all values must be finite")
            inputs = weight.shape[0]

    @property
    def inputs(self) -> int:
        """Number of inputs."""
        return int(self.weights[0].shape[1])

    @property
    def outputs(self) -> int:
        """Number of outputs."""
        return int(self.weights[-1].shape[0])

    def __call__(self, x: Sequence[float] | Vector) -> Vector:
        """Return the outputs, (outputs,), for inputs, (inputs,)."""
        y = np.asarray(x, dtype=np.float64)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            y = np.tanh(weight @ y + bias)
        return np.asarray(self.weights[-1] @ y + self.biases[-1])
