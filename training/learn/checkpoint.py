"""Everything a training run needs to go on, in safetensors and JSON: nothing to unpickle.

Lessons are not kept, they would be hundreds of megabytes: a run that goes on gathers new ones.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save

from ...models.errors import OptionError
from ...models.files import replacing, write_text
from ...models.reading import read_json
from .dagger import Training

NAME = "checkpoint"
"""Both files without their suffixes."""
NUMBERS = ("units", "usual", "mean", "scale", "speeds")
"""Arrays that a training run has found out."""
DAMAGE = (ValueError, KeyError, TypeError, RuntimeError, OverflowError, SafetensorError)
"""What reading a damaged checkpoint may raise."""


def write(folder: Path, training: Training, state: dict[str, Any]) -> None:
    """Write network, optimiser (Adam) and what the run has found out, and `state` as JSON."""
    tensors = {f"network.{k}": v for k, v in training.student.state_dict().items()}
    for index, entries in training.school.optimiser.state_dict()["state"].items():
        tensors |= {f"adam.{index}.{k}": torch.as_tensor(v) for k, v in entries.items()}
    tensors |= {f"found.{name}": torch.as_tensor(getattr(training, name)) for name in NUMBERS}
    with replacing(folder / f"{NAME}.safetensors") as beside:
        beside.write_bytes(save({k: v.detach().clone().contiguous() for k, v in tensors.items()}))
    found = {"iteration": training.iteration, "box": training.box, "weight": training.weight}
    write_text(folder / f"{NAME}.json", json.dumps(state | found, indent=2) + "\n")


def read(folder: Path, training: Training) -> dict[str, Any]:
    """Restore what `write` wrote; returns its `state`.

    Raises
    ------
    OptionError
        The files are missing, damaged, or of another network.
    """
    entries = read_json(folder / f"{NAME}.json", OptionError)
    try:
        tensors = load_file(folder / f"{NAME}.safetensors")
        found: dict[str, Any] = {
            name: tensors[f"found.{name}"].numpy().astype(np.float64) for name in NUMBERS
        }
        found["box"] = tuple(tuple(map(float, corner)) for corner in entries["box"])
        found["weight"] = float(entries["weight"])
        training.restore(int(entries["iteration"]), found)
        training.student.load_state_dict(_part(tensors, "network."))
        optimiser = training.school.optimiser
        moments: dict[int, dict[str, torch.Tensor]] = {}
        for key, value in _part(tensors, "adam.").items():
            index, _, name = key.partition(".")
            moments.setdefault(int(index), {})[name] = value
        optimiser.load_state_dict({**optimiser.state_dict(), "state": moments})
        return {key: float(entries[key]) for key in ("spent", "best")}
    except OSError as error:
        raise OptionError(
            f"cannot read the checkpoint in {folder}: {error.strerror or error}"
        ) from None
    except DAMAGE as error:
        reason = " ".join(str(error).split())
        raise OptionError(f"the checkpoint in {folder} does not fit: {reason}") from None


def _part(tensors: dict[str, torch.Tensor], prefix: str) -> dict[str, torch.Tensor]:
    """Tensors whose names begin so, by the rest of these."""
    return {key[len(prefix) :]: value for key, value in tensors.items() if key.startswith(prefix)}
