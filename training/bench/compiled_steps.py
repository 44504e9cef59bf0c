"""Exact feedforward by a rig's compiled file, many samples in one call."""

import ctypes

import numpy as np

from ...feedforward import Motion, Reference
from ...feedforward.exact.branch import branch_of
from ...feedforward.exact.motion import find_slack
from ...feedforward.exact.problem import problem_of
from ...feedforward.solving.compiling import Library
from ...feedforward.solving.source import program_of, start_of, words_of
from ...models import Rig
from ...models.errors import PathError
from ...models.types import Array

BATCH = """
int @_batch(const @_state *start, int samples, const double *derivatives, const double *gaps,
    @_motion *motions)
{
    @_state state = *start;
    const int size = (#_ORDER + 1)*#_COLUMNS;
    for (int i = 0; i < samples; ++i)
        if (@_step(&state, derivatives + i*size, gaps[i], motions + i) > #_SLACK) return i;
    return samples;
}
"""


class CompiledSteps:
    """The steps of one rig along one path, compiled.

    Raises
    ------
    OptionError
        There is no C compiler.
    RigError, PathError, SmoothnessError
        The rig has no program, or cannot start there.
    """

    def __init__(self, rig: Rig, reference: Reference) -> None:
        self.rig, self.reference = rig, reference
        self.program, self.order = program_of(rig), problem_of(rig).order
        begin = branch_of(problem_of(rig), reference).at(0.0)
        words = words_of(rig, self.program)
        start = start_of(self.program, begin)
        name = Library.name_of(words)
        more = BATCH.replace("@", name).replace("#", name.upper())
        self.library = Library(self.program, words, start, more)
        pointer = ctypes.c_void_p
        self._batch = self.library.function(
            "batch", pointer, ctypes.c_int, pointer, pointer, pointer
        )
        self.step = self.library.function("step", pointer, pointer, ctypes.c_double, pointer)

    def derivatives(self, times: Array) -> Array:
        """Of the reference, shape (N, order + 1, outputs), contiguous."""
        found = self.reference.derivatives(times, self.order)
        return np.ascontiguousarray(found.transpose(1, 0, 2))

    def results(self, derivatives: Array, gaps: Array) -> Array:
        """Results at samples, each a gap (N,) [s] after the one before.

        Shape (N, members of the motion); the first gap is 0.

        Raises
        ------
        PathError
            A sample is refused.
        """
        size = ctypes.sizeof(self.library.motion) // 8
        motions = np.empty((len(derivatives), size))
        state = ctypes.addressof(self.library.state)
        places = (array.ctypes.data for array in (derivatives, gaps, motions))
        done = self._batch(state, len(motions), *places)
        if done < len(motions):
            raise PathError(f"rig {self.rig.name} cannot go on at sample {done}")
        return motions

    def motion(self, times: Array) -> Motion:
        """The motion at ascending times (N,), from the path's start on."""
        found = self.results(self.derivatives(times), np.diff(times, prepend=times[0]))
        parts, first = {}, 0
        for member, kind, *_ in self.library.motion._fields_:
            size = ctypes.sizeof(kind) // 8
            parts[member] = found[:, first : first + size]
            first += size
        return Motion(
            rig=self.rig,
            times=times,
            coordinate_names=self.program.names,
            positions=parts["position"],
            velocities=parts["velocity"],
            accelerations=parts["acceleration"],
            inputs=parts["input"],
            tensions=parts["tension"],
            multipliers=np.zeros((len(times), 0)),
            slack=find_slack(self.rig, times, parts["tension"]),
        )
