"""What environments tell beside observations: the truth about plants, for evaluation.

A single environment's info has the same keys after `reset` and `step`, and NumPy's numbers and
arrays alone, so that recorders of data take it as it is:

    load, tension, ...    of the plant, as `CraneEnv` and `HandEnv` say
    reward_tracking, reward_smoothness    what the reward is the product of
    scenario              the numbers of the scenario, (numbers,), named by `scenario_names`
    reason                why the episode is over, an index of `reasons`; 0 while it goes on

A vector environment's has arrays (n, ...) in their place and, beside every entry, "_" and its name:
a mask (n,) of the simulations that it is about, as Gymnasium's own vector environments have it.
"""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..models.types import Mask
from .common import NOT_FINITE, TIME, Ids


class Told:
    """What n simulations' infos have beside the plants' own: scenarios, and why episodes end.

    Parameters
    ----------
    num
        Number of simulations.
    undisturbed
        A scenario of their kind.
    ends
        Why episodes can end early.
    """

    def __init__(self, num: int, undisturbed: Any, ends: Sequence[str]) -> None:
        names: list[str] = []
        for item in fields(undisturbed):
            count = np.size(getattr(undisturbed, item.name))
            names += [item.name] if count == 1 else [f"{item.name}_{k}" for k in range(count)]
        self.names = tuple(names)
        """Of the numbers of a scenario."""
        self.reasons = tuple(dict.fromkeys(("", TIME, NOT_FINITE, *ends)))
        """Why an episode can be over, and before them "" for one that goes on."""
        self.scenarios = np.tile(_numbers(undisturbed), (num, 1))
        """Numbers of the scenarios, (n, numbers)."""
        self.reason = np.zeros(num, dtype=np.int64)
        """Index of `reasons`, (n,)."""

    def begin(self, ids: Ids, scenarios: Sequence[Any]) -> None:
        """Take note of the scenarios of some simulations, whose episodes go on."""
        self.reason[ids] = 0
        self.scenarios[ids] = [_numbers(scenario) for scenario in scenarios]

    def end(self, sim: int, reason: str) -> None:
        """Take note of why an episode is over, "" if it goes on."""
        self.reason[sim] = self.reasons.index(reason)


def _numbers(scenario: Any) -> list[float]:
    """All numbers of a scenario, one after the other."""
    numbers: list[float] = []
    for item in fields(scenario):
        value = getattr(scenario, item.name)
        numbers += value if np.ndim(value) else (value,)
    return numbers


def with_masks(info: dict[str, Any], which: Mask) -> dict[str, Any]:
    """An info of n simulations with Gymnasium's masks of those that it is about, (n,)."""
    masked: dict[str, Any] = {}
    for name, value in info.items():
        masked[name], masked[f"_{name}"] = value, which.copy()
    return masked


def of_one(info: dict[str, NDArray[Any]], sim: int) -> dict[str, NDArray[Any]]:
    """What an info of n simulations, of live arrays, has of one: views."""
    return {name: values[sim, ...] for name, values in info.items()}


def copied(info: dict[str, NDArray[Any]]) -> dict[str, Any]:
    """What views of one simulation say now, the caller's own."""
    return {name: values.copy() if values.ndim else values[()] for name, values in info.items()}
