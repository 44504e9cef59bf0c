"""The network of a residual policy, in plain NumPy.

    x = clip((features - mean) / scale)
    h = silu(W2 silu(W1 x))
    a = Wa h                            heads: what the plant may be like
    y = Ws x + Wo silu(Wm (h, a))       the action, in units of its own

The heads are taught the load's mass, wind, friction, the load's error and the delay; what they
say helps the rest of the network, and a user who asks why.  `flatrig.training.learn.student` has
the same network in torch, to be taught.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..models.types import Array

CLIP = 8.0
"""Features are clipped to this many standard deviations."""
LAYERS = ("first", "second", "heads", "mixed", "action", "skip")
"""Linear layers, in the order in which they are used."""


@dataclass(frozen=True, eq=False)
class Network:
    """Numbers of the network; `weights` and `biases` by the names of `LAYERS`."""

    weights: Mapping[str, Array]
    """Each (outputs, inputs)."""
    biases: Mapping[str, Array]
    """Each (outputs,)."""
    mean: Array
    """Means of the features in training, (features,)."""
    scale: Array
    """Standard deviations of the features in training, (features,)."""

    def __call__(self, features: Array) -> tuple[Array, Array]:
        """Actions (n, drives) and heads (n, heads) for features (n, features)."""
        x = np.clip((features - self.mean) / self.scale, -CLIP, CLIP)
        hidden = _silu(self._layer("second", _silu(self._layer("first", x))))
        heads = self._layer("heads", hidden)
        mixed = _silu(self._layer("mixed", np.concatenate((hidden, heads), axis=1)))
        return self._layer("action", mixed) + self._layer("skip", x), heads

    def _layer(self, name: str, x: Array) -> Array:
        return np.asarray(x @ self.weights[name].T + self.biases[name])

    def tensors(self) -> dict[str, Array]:
        """All numbers by name, as files hold them."""
        layers = {f"{name}.weight": self.weights[name] for name in LAYERS}
        layers |= {f"{name}.bias": self.biases[name] for name in LAYERS}
        return layers | {"mean": self.mean, "scale": self.scale}

    @classmethod
    def of(cls, tensors: Mapping[str, Array], features: int, actions: int) -> "Network":
        """From numbers by name, which are checked.

        Raises
        ------
        KeyError
            A layer is missing.
        ValueError
            Shapes do not fit each other, or a number is not finite.
        """
        network = cls(
            {name: tensors[f"{name}.weight"] for name in LAYERS},
            {name: tensors[f"{name}.bias"] for name in LAYERS},
            tensors["mean"],
            tensors["scale"],
        )
        network._check_numbers()
        network._check_shapes(features, actions)
        return network

    def _check_numbers(self) -> None:
        for name, array in self.tensors().items():
            if array.dtype.kind != "f" or not np.isfinite(array).all():
                raise ValueError(f"a number of {name} is not finite")
            if np.abs(array).max(initial=0.0) > LARGEST:
                raise ValueError(f"a number of {name} is larger than {LARGEST:g}")
        if not (self.scale > 0.0).all():
            raise ValueError(f"a feature's scale is {self.scale.min():g}, it must be > 0")

    def _check_shapes(self, features: int, actions: int) -> None:
        width, mixed, heads = (len(self.biases[name]) for name in ("first", "mixed", "heads"))
        hidden = len(self.biases["second"])
        wanted = {
            "first": (width, features), "second": (hidden, width), "heads": (heads, hidden),
            "mixed": (mixed, hidden + heads), "action": (actions, mixed),
            "skip": (actions, features),
        }  # fmt: skip
        for name, shape in wanted.items():
            for array, expected in ((self.weights[name], shape), (self.biases[name], shape[:1])):
                if array.shape != expected:
                    raise ValueError(f"{name} has shape {array.shape}, not {expected}")
        for array in (self.mean, self.scale):
            if array.shape != (features,):
                raise ValueError(f"features have shape {array.shape}, not ({features},)")


LARGEST = 1e6
"""Numbers beyond make outputs that no network was trained to give."""


def _silu(x: Array) -> Array:
    """X / (1 + exp(-x)), without overflow where x is far below zero."""
    return np.asarray(x * 0.5 * (1.0 + np.tanh(0.5 * x)))
