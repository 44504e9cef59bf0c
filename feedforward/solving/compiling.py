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
from ..generated.c_words import identifier
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
        except OSError as error:
            raise OptionError(f"cannot build in {folder}: {error.strerror}") from None
    return ctypes.CDLL(str(place))


def structures(
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


def function(built: ctypes.CDLL, rig: str) -> Any:
    """The file's function NAME_step."""
    step = getattr(built, f"{identifier(rig)}_step")
    step.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
    return step
