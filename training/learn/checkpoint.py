"""Everything a training run needs to go on, in safetensors and JSON: nothing to unpickle."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save

from ...models.errors import OptionError
from ...models.files import replacing, write_text
from ...models.reading import read_json

if TYPE_CHECKING:
    from stable_baselines3 import PPO

    from .sb3 import Adapter

NAME = "checkpoint"
"""Both files without their suffixes."""
DAMAGE = (ValueError, KeyError, TypeError, RuntimeError, OverflowError, SafetensorError)
"""What reading a damaged checkpoint may raise."""


def write(folder: Path, model: "PPO", adapter: "Adapter", state: dict[str, Any]) -> None:
    """Write network, optimiser (Adam) and normalisation, and `state` as JSON."""
    tensors = {f"network.{k}": v for k, v in model.policy.state_dict().items()}
    for index, entries in model.policy.optimizer.state_dict()["state"].items():
        tensors |= {f"adam.{index}.{k}": torch.as_tensor(v) for k, v in entries.items()}
    normaliser = adapter.normaliser
    tensors |= {
        "normaliser.mean": torch.as_tensor(normaliser.mean),
        "normaliser.var": torch.as_tensor(normaliser.var),
        "normaliser.count": torch.as_tensor(float(normaliser.count), dtype=torch.float64),
    }
    with replacing(folder / f"{NAME}.safetensors") as beside:
        beside.write_bytes(save({k: v.detach().clone().contiguous() for k, v in tensors.items()}))
    write_text(folder / f"{NAME}.json", json.dumps(state, indent=2) + "\n")


def read(folder: Path, model: "PPO", adapter: "Adapter") -> dict[str, Any]:
    """Restore what `write` wrote; returns its `state`.

    Raises
    ------
    OptionError
        The files are missing, damaged, or of another network.
    """
    entries = read_json(folder / f"{NAME}.json", OptionError)
    try:
        state = {"steps": int(entries["steps"])} | {k: float(entries[k]) for k in ("spent", "best")}
        tensors = load_file(folder / f"{NAME}.safetensors")
        network: dict[str, torch.Tensor] = {}
        moments: dict[int, dict[str, torch.Tensor]] = {}
        for key, value in tensors.items():
            kind, _, name = key.partition(".")
            if kind == "network":
                network[name] = value
            elif kind == "adam":
                index, _, name = name.partition(".")
                moments.setdefault(int(index), {})[name] = value
        model.policy.load_state_dict(network)
        optimiser = model.policy.optimizer
        optimiser.load_state_dict({**optimiser.state_dict(), "state": moments})
        normaliser = adapter.normaliser
        normaliser.mean = tensors["normaliser.mean"].numpy().astype(np.float64)
        normaliser.var = tensors["normaliser.var"].numpy().astype(np.float64)
        normaliser.count = float(tensors["normaliser.count"])
    except OSError as error:
        raise OptionError(
            f"cannot read the checkpoint in {folder}: {error.strerror or error}"
        ) from None
    except DAMAGE as error:
        reason = " ".join(str(error).split())
        raise OptionError(f"the checkpoint in {folder} does not fit: {reason}") from None
    return state
