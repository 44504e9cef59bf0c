"""Command lines with one thing wrong in each, the same ones again for the same seed.

They follow from the commands as they are registered, so that a new one is met, too.
"""

from dataclasses import fields
from typing import get_args, get_type_hints

import numpy as np

from ...models import CATALOGUE
from ..options import COMMANDS
from ..rig_options import RigOptions

Random = np.random.Generator

NO_NUMBERS = ("", "x", "1..0", "0x10", "1,5", "ten", "1e", "∞")
NO_RIGS = (
    "", "overheat", "nowhere.toml", "./", "/", "a\0b.toml", "overhead.toml/x.toml", "-",
    "overhead crane", "x" * 5000 + ".toml", "../..", "file.toml", "é",
)  # fmt: skip
NO_CHANGES = (
    "load_mass", "=3", "load_mass=", "load_mass=nan", "load_mass=-1", "load_mass=1e999",
    "loadmass=3", "load.mas=3", "lode.mass=3", "load_mass=x", "load.mass=-3", "..=1",
    "load.name=3", "\0=1",
)  # fmt: skip
NO_OPTIONS = ("--nothing", "--rat", "-z", "---", "--set=", "--output", "--=3", "--help=3")
OUT_OF_RANGE = (
    ("solve", "--rate", ("0", "-1", "nan", "inf", "1e300")),
    ("solve", "--duration", ("0", "-3", "nan", "inf", "1e300")),
    ("solve", "--order", ("-1", "2", "1000000")),
    ("solve", "--goal", ("nan", "inf", "1e300", "5")),
    ("solve", "--blend", ("nan", "inf")),
    ("solve", "--move", ("", "nowhere.toml", ".", "file.toml", "a\0b")),
    ("compare", "--scenarios", ("0", "-1")),
    ("compare", "--policy", ("nowhere.json", ".", "file.toml", "a\0b")),
    ("render", "--fps", ("0", "nan", "-5")),
    ("render", "--speed", ("0", "nan", "-1")),
    ("render", "--camera", ("", "tpo", "9")),
    ("render", "--controller", ("pq", ",", "ff,,pd", "pd,pd", "ff+pdd")),
    ("render", "--scenario", ("x", "load_mass", "load_mass=x", "lode_mass=1", "wind=nan", "=3")),
    ("render", "--output", ("film.avi", "film.txt")),
    ("train", "--steps", ("0", "-1")),
    ("stress", "--rigs", ("0", "-1")),
    ("regress", "--baseline", ("nowhere.csv", ".", "file.toml", "a\0b")),
)  # fmt: skip
"""Commands, options, and values that they cannot have."""
NO_FILES = ("file.toml/a.csv", "a\0b.csv", "kept.csv", "x" * 300)
"""What no table can be written to, in a folder with these two files."""


def wrong_line(random: Random) -> list[str]:
    """A command line that must be refused."""
    kind = random.integers(7)
    rig = str(random.choice(list(CATALOGUE)))
    if kind == 0:
        return [_slip(_name(_class(random)), random), rig]
    if kind == 1:
        return _no_number(random, rig)
    if kind == 2:
        return [_with_rig(random), _one_of(NO_RIGS, random)]
    if kind == 3:
        return [_with_rig(random), "overhead", "--set", _one_of(NO_CHANGES, random)]
    if kind == 4:
        name = _class(random)
        return [_name(name), *([rig] if issubclass(name, RigOptions) else []),
                _one_of(NO_OPTIONS, random)]  # fmt: skip
    if kind == 5:
        return ["solve", "overhead", "--rate", "20", "-o", _one_of(NO_FILES, random)]
    command, option, values = OUT_OF_RANGE[int(random.integers(len(OUT_OF_RANGE)))]
    about = ["overhead"] if command in _about_rigs() else []
    return [command, *about, option, _one_of(values, random)]


def _one_of(values: tuple[str, ...], random: Random) -> str:
    return values[int(random.integers(len(values)))]


def _name(options: type) -> str:
    return options.__name__.lower()


def _class(random: Random) -> type:
    """The options of some command."""
    return list(COMMANDS)[int(random.integers(len(COMMANDS)))]


def _about_rigs() -> list[str]:
    return [_name(options) for options in COMMANDS if issubclass(options, RigOptions)]


def _with_rig(random: Random) -> str:
    return str(random.choice(_about_rigs()))


def _slip(word: str, random: Random) -> str:
    """A word that is no command, but nearly one."""
    place = int(random.integers(len(word)))
    return str(random.choice((word[:place] + "q" + word[place + 1 :], word.upper(), f"{word}q")))


def _no_number(random: Random, rig: str) -> list[str]:
    """Something else where an option needs a number."""
    options = _class(random)
    hints = get_type_hints(options)
    numeric = [
        item.name
        for item in fields(options)
        if {int, float} & {hints[item.name], *get_args(hints[item.name])}
    ]
    about = [rig] if issubclass(options, RigOptions) else []
    if not numeric:
        return [_name(options), *about, "--number", "3"]
    return [_name(options), *about, f"--{random.choice(numeric)}", _one_of(NO_NUMBERS, random)]
