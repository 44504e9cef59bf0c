"""Compiles a rig's C file for this machine, once, and calls it.

The library is kept in the user's cache folder under a digest of its source.
"""

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from ...models.errors import OptionError
from ..generated.c_source import c_source
from ..generated.c_words import Start, Words, identifier
from ..generated.program import Program

FLAGS = "-std=c99", "-O2", "-shared", "-fPIC"
"""Of the compiler; -O2 without anything that changes what sums come to."""


def compiler() -> str | None:
    """The C compiler of this machine: $CC, or one of the usual names; None if there is none."""
    names = (os.environ.get("CC", ""), "cc", "gcc", "clang")
    return next((found for name in names if name and (found := shutil.which(name))), None)


def library(name: str, text: str) -> ctypes.CDLL:
    """A C file as a library of this process.

    Raises
    ------
    OptionError
        There is no compiler, it refuses the file, or nothing can be kept.
    """
    found = compiler()
    if found is None:
        raise OptionError("there is no C compiler (cc, gcc or clang, or $CC); step without one")
    digest = hashlib.sha256("\0".join((text, found, *FLAGS)).encode()).hexdigest()[:24]
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "flatrig"
    place = folder / f"{name}-{digest}.so"
    if not place.exists():
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder) as beside:
                source, built = Path(beside) / f"{name}.c", Path(beside) / place.name
                source.write_text(text)
                order = [found, *FLAGS, str(source), "-o", str(built), "-lm"]
                done = subprocess.run(order, capture_output=True, text=True, check=False)
                if done.returncode:
                    first = next(iter(done.stderr.splitlines()), f"status {done.returncode}")
                    raise OptionError(f"{found} refuses the file of rig {name}: {first}")
                built.replace(place)
        except TimeoutError:  # of a caller who has waited long enough, not of a file
            raise
        except OSError as error:
            raise OptionError(f"cannot build in {folder}: {error.strerror}") from None
    return ctypes.CDLL(str(place))


class Library:
    """A rig's C file as a library, with a state that has begun and room for a motion.

    Parameters
    ----------
    program
        Of the rig.
    words
        About it.
    start
        Where the state begins.
    more
        C to compile behind the file.

    Raises
    ------
    OptionError
        As `library`.
    """

    def __init__(self, program: Program, words: Words, start: Start, more: str = "") -> None:
        self.name = self.name_of(words)
        self.functions = library(self.name, c_source(program, words, start) + more)
        of_state, of_motion = _structures(program, len(words.encoders))
        self.state, self.motion = of_state(), of_motion()
        for i, value in enumerate(start.newton):
            self.state.newton[3 * i] = value
        self.state.side[:] = list(start.sides)
        self.state.angle[:] = list(start.angles)
        self.state.samples = 1

    @staticmethod
    def name_of(words: Words) -> str:
        """What its functions' names begin with."""
        return identifier(words.rig)

    def function(self, name: str, *arguments: Any) -> Any:
        """A function of the library, of that name behind the rig's, with its arguments' types."""
        found = getattr(self.functions, f"{self.name}_{name}")
        found.argtypes = arguments
        return found


def _structures(
    program: Program, encoders: int
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """The file's types NAME_state and NAME_motion, member by member."""
    axes = max((len(vector) for _, vector, _ in program.spans), default=0)
    state = [
        ("newton", ctypes.c_double * (3 * len(program.newton))),
        ("side", ctypes.c_double * len(program.blocks)),
        ("largest", ctypes.c_double * len(program.determinants)),
        ("angle", ctypes.c_double * len(program.angles)),
        ("span", ctypes.c_double * (axes * len(program.spans))),
        ("samples", ctypes.c_int),
    ]
    sizes = (
        ("input", len(program.inputs)),
        ("tension", len(program.tensions)),
        ("encoder", encoders),
        ("encoder_rate", encoders),
        ("position", len(program.names)),
        ("velocity", len(program.names)),
        ("acceleration", len(program.names)),
    )
    motion = [(name, ctypes.c_double * size) for name, size in sizes]
    return _structure("State", state), _structure("Motion", motion)


def _structure(name: str, fields: list[tuple[str, Any]]) -> type[ctypes.Structure]:
    return type(name, (ctypes.Structure,), {"_fields_": fields})
