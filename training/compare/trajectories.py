"""What happened in every episode, written on request: one file of arrays for each contender."""

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ...models.files import make_folder, replacing
from ...models.types import Array, Mask
from .kept_runs import Driven
from .metrics import Record


def save_trajectories(
    file: IO[bytes], record: Record, episodes: Mapping[str, Sequence[object]]
) -> None:
    """Write a record as a file of arrays (npz).

    `set` and `number` (N,) say which episode a column is; `time` (T,); `load` and `reference`
    (T, N, p) [m], `input` (T, N, inputs) over the limits and `tension` (T, N, ropes) [N] are NaN
    after an episode's end, early or not.
    """
    counted = record.counted & record.alive
    kept: dict[str, Any] = {
        "set": np.array([name for name, chosen in episodes.items() for _ in chosen]),
        "number": np.concatenate([np.arange(len(chosen)) for chosen in episodes.values()]),
        "time": record.times,
        "load": _counted(record.load, counted),
        "reference": _counted(record.reference, counted),
        "input": _counted(record.inputs, counted),
        "tension": _counted(record.tensions, counted),
    }
    np.savez_compressed(file, **kept)


def write_trajectories(folder: Path, found: Iterable[Driven]) -> None:
    """Write what contenders did as FOLDER/CONTENDER.npz.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    make_folder(folder)
    for driven in found:
        name = next(iter(driven.runs.values())).name
        with replacing(folder / f"{_file_name(name)}.npz") as beside:
            beside.write_bytes(driven.trajectories)


def _counted(values: Array, counted: Mask) -> NDArray[np.float32]:
    """The values of counted periods in single precision, NaN in the others."""
    return np.where(counted[..., None], values, np.nan).astype(np.float32)


def _file_name(contender: str) -> str:
    """A contender's name of letters, digits and single dashes."""
    return re.sub(r"[^a-z0-9]+", "-", contender.lower()).strip("-")
