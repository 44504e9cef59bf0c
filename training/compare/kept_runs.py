"""What one contender did, and how a file of progress keeps it: the same bits come back."""

import base64
import hashlib
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..policy import Policy
from .contenders import CONTENDERS, Contender
from .runs import Run


@dataclass(frozen=True, eq=False)
class Driven:
    """What one contender did on every set of episodes."""

    runs: Mapping[str, Run]
    """By the set's name."""
    trajectories: bytes = b""
    """The file of its trajectories, where they are asked for."""

    def __post_init__(self) -> None:
        """Lay arrays out as they come back from elsewhere: the order of sums depends on it."""
        for run in self.runs.values():
            for part in (run, run.metrics):
                for item in fields(part):
                    value = getattr(part, item.name)
                    if isinstance(value, np.ndarray):
                        object.__setattr__(part, item.name, np.ascontiguousarray(value))


def identity_of(contender: Contender, policy: Policy | None) -> object:
    """What tells a contender, with its policy, from others."""
    wrap = contender.wrap
    law = contender.name, contender.sensors, f"{wrap.__module__}.{wrap.__qualname__}"
    if policy is None:
        return law
    tensors = sorted(policy.network.tensors().items())
    numbers = b"".join(array.tobytes() for _, array in tensors)
    return law, policy.card, hashlib.sha256(numbers).hexdigest()


def kept(driven: Driven) -> dict[str, Any]:
    """The same as JSON."""
    return {
        "contender": next(iter(driven.runs.values())).name,
        "runs": {name: _run(run) for name, run in driven.runs.items()},
        "trajectories": base64.b64encode(driven.trajectories).decode(),
    }


def restored(metrics: type, data: Any) -> Driven:
    """What `kept` has made; `metrics` is the dataclass of the metrics.

    Raises
    ------
    ValueError, TypeError, KeyError
        It is none.
    """
    contender = CONTENDERS[data["contender"]]
    runs = {}
    for name, parts in data["runs"].items():
        values = {key: _value(entry) for key, entry in parts["metrics"].items()}
        arrays = {key: _value(parts[key]) for key in ("times", "distance", "hold")}
        runs[name] = Run(contender, metrics=metrics(**values), **arrays)
    return Driven(runs, base64.b64decode(data["trajectories"]))


def _run(run: Run) -> dict[str, Any]:
    parts = {name: _plain(getattr(run, name)) for name in ("times", "distance", "hold")}
    metrics = {item.name: _plain(getattr(run.metrics, item.name)) for item in fields(run.metrics)}
    return parts | {"metrics": metrics}


def _plain(value: Any) -> Any:
    """An array as text that holds all its bits; what is none stays as it is."""
    if not isinstance(value, np.ndarray):
        return value
    text = base64.b64encode(zlib.compress(value.tobytes(), 1)).decode()
    return {"shape": value.shape, "type": value.dtype.str, "zlib": text}


def _value(entry: Any) -> Any:
    if not isinstance(entry, dict):
        return entry
    data = zlib.decompress(base64.b64decode(entry["zlib"]))
    array: NDArray[Any] = np.frombuffer(data, np.dtype(entry["type"]))
    return array.reshape(entry["shape"]).copy()
