"""Stressed cases of generated programs: steps in C, one after another, beside `solve`."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ... import feedforward, models
from ...feedforward.solving.compiling import compiler
from ...models.errors import PathError
from ...models.types import Array
from .case import CORRECT, STOPPED, Case, Finding, Stopped, case, worst
from .wild_moves import random_move

MOVES = 500
"""Random moves of each crane."""
TOGETHER = 10
"""Moves of a case."""
SAMPLES = 501
"""Steps of a move."""
ENDS = CORRECT, STOPPED
"""How a case may end: stopped where there is no compiler."""
ALIKE = 1e-10
"""Largest difference of an input from `solve`, over the largest input."""


def cases() -> Iterator[Case]:
    """Random moves of every crane of the catalogue, tame and wild."""
    for name in models.CATALOGUE:
        for first in range(0, MOVES, TOGETHER):
            label = f"{name}, moves {first} to {first + TOGETHER - 1}"
            yield case("compiled programs", label, stepped, name, first, must=ENDS)


def stepped(name: str, first: int) -> Finding:
    """Steps against `solve` along random moves; what one refuses the other must refuse, too."""
    if compiler() is None:
        raise Stopped("there is no C compiler")
    rig = models.make(name)
    needed = feedforward.analyse(rig).reference_order
    findings = [Finding(0.0, ALIKE, "inputs")]
    for number in range(first, first + TOGETHER):
        move = random_move(rig, np.random.default_rng([7, number]))
        smooth = replace(move, order=max(move.order, needed))
        findings.append(_compared(rig, feedforward.from_move(smooth, rig)))
    return worst(*findings)


def _compared(rig: models.Rig, reference: feedforward.Reference) -> Finding:
    times = np.linspace(0.0, reference.duration, SAMPLES)
    steps, solved = _steps(rig, reference, times), _solved(rig, reference, times)
    if steps is None or solved is None:
        same = steps is None and solved is None
        return Finding(0.0 if same else np.inf, ALIKE, "what is refused")
    return Finding(float(np.abs(steps - solved).max() / np.abs(solved).max()), ALIKE, "inputs")


def _steps(rig: models.Rig, reference: feedforward.Reference, times: Array) -> Array | None:
    try:
        resting = feedforward.base_at(reference, 0.0) is None
        start = reference.start if resting else feedforward.solve(rig, reference, 0.0).at(0.0)
        stepper = feedforward.Stepper(rig, start, in_c=True)
        derivatives = reference.derivatives(times, stepper.order).transpose(1, 0, 2)
        gaps = np.diff(times, prepend=times[0])
        pairs = zip(derivatives, gaps, strict=True)
        return np.array([stepper.step(sample, gap).inputs for sample, gap in pairs])
    except PathError:
        return None


def _solved(rig: models.Rig, reference: feedforward.Reference, times: Array) -> Array | None:
    try:
        return feedforward.solve(rig, reference, times).inputs
    except PathError:
        return None
