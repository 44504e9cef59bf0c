"""Descriptions of rigs with something wrong in them, the same ones again for the same seed.

Each begins as a rig of the catalogue with its move, in full or by its name with a parameter, and
is then damaged once or several times: as a slip of the pen would, a wrong unit, another program,
or a disk.
"""

import re
from collections.abc import Callable

import numpy as np

from ...models import CATALOGUE, default_move, dumps

Random = np.random.Generator
Damage = Callable[[str, Random], str]

VALUES = (
    "true", '"text"', '""', "[]", "{}", "[[]]", "[1.0, 2.0]", "{x = 1.0}", "1979-05-27", "07:32:00",
    "1979-05-27T07:32:00Z", "nan", "inf", "-inf", "0", "-0.0", "-1", "1", "3.5", "5e-324",
    "1e-300", "1e308", "-1e308", "1e999", "9" * 30, "9" * 5000, "0x7fffffffffffffff",
    '"\\u0000"', '"a\\nb"', '"world"', '"load"', '"load.x"', '["load", "load"]',
    "[" * 40 + "]" * 40, "[" * 3000 + "]" * 3000,
)  # fmt: skip
"""What may stand where something else should."""
CELLS = ("", "nan", "inf", "1e400", "text", "0,5", "1;2", '"', "\0", "1_0", "-", "٣")
"""What may stand in a table of samples."""
ENTRY = re.compile(r"^( *)([\w.]+)( *= *)(.+)$", re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]?\d+)?(?![\w.])")
WORD = re.compile(r'"[^"\n]*"')


def damaged(random: Random) -> tuple[bytes, bytes]:
    """A damaged description, and a damaged table of samples that its move may name."""
    name = str(random.choice(list(CATALOGUE)))
    text = dumps(CATALOGUE[name](), default_move(name)) if random.random() < 0.6 else _short(name)
    for _ in range(random.choice((1, 1, 1, 2, 5))):
        text = DAMAGES[int(random.integers(len(DAMAGES)))](text, random)
    return _encoded(text, random), _samples(random)


def _short(name: str) -> str:
    """A rig by its name, with a parameter and a part of a move."""
    move = default_move(name)
    return (
        f'rig = "{name}"\nload_mass = 80.0\n\n[move]\nstart = {list(move.start)}\n'
        f"goal = {list(move.goal)}\nduration = {move.duration}\norder = {move.order}\n"
    )


def _at(pattern: re.Pattern[str], text: str, random: Random) -> re.Match[str] | None:
    """One place of a pattern."""
    found = list(pattern.finditer(text))
    return found[int(random.integers(len(found)))] if found else None


def _replaced(text: str, found: re.Match[str] | None, by: str, group: int = 0) -> str:
    return text if found is None else text[: found.start(group)] + by + text[found.end(group) :]


def _other_value(text: str, random: Random) -> str:
    return _replaced(text, _at(ENTRY, text, random), str(random.choice(VALUES)), 4)


def _other_number(text: str, random: Random) -> str:
    found = _at(NUMBER, text, random)
    if found is None:
        return text
    reach = int(random.choice((1, 3, 20)))
    number = float(found[0]) * 10.0 ** float(random.integers(-reach, reach + 1))
    number *= float(random.choice((-1, 1)))
    return _replaced(text, found, f"{number!r}")


def _other_word(text: str, random: Random) -> str:
    found = _at(WORD, text, random)
    other = _at(WORD, text, random)
    return text if other is None else _replaced(text, found, other[0])


def _misspelled(text: str, random: Random) -> str:
    found = _at(ENTRY, text, random)
    if found is None:
        return text
    key, place = found[2], int(random.integers(len(found[2])))
    slips = (
        key[:place] + key[place + 1 :],
        key.upper(),
        key + "s",
        f"{key}.{key}",
        f'"{key}\\u0000"',
    )
    return _replaced(text, found, str(random.choice(slips)), 2)


def _other_line(text: str, random: Random) -> str:
    """A line lost, twice, or elsewhere."""
    lines = text.split("\n")
    place, goal = (int(number) for number in random.integers(len(lines), size=2))
    how = random.integers(3)
    line = lines[place] if how == 1 else lines.pop(place)
    if how:
        lines.insert(goal, line)
    return "\n".join(lines)


def _cut(text: str, random: Random) -> str:
    return text[: int(random.integers(len(text) + 1))]


def _swapped(text: str, random: Random) -> str:
    """Two tokens in one another's place."""
    tokens = re.split(r"(\s+|[\[\]=,{}])", text)
    one, other = (int(number) for number in random.integers(len(tokens), size=2))
    tokens[one], tokens[other] = tokens[other], tokens[one]
    return "".join(tokens)


def _inserted(text: str, random: Random) -> str:
    """Letters, marks and whole entries that do not belong there."""
    extra = (
        "[[", "]]", "=", '"', "'''", "#", "\0", "\x1b[2J", "\ufeff", "é", "\n[move]\n",
        "\n[home]\n", '\nname = "x"\n', "\n[[loads]]\n", "\n[[ropes.sheaves]]\n",
        '\nsamples = "samples.csv"\n', '\nsamples = "."\n', '\nprofile = "sampled"\n',
        "\nturning = [0, 1, 2]\n", "a." * 3000 + "a = 1\n",
    )  # fmt: skip
    place = int(random.integers(len(text) + 1))
    return text[:place] + str(random.choice(np.array(extra, dtype=object))) + text[place:]


def _sampled(text: str, _: Random) -> str:
    """A move that is a table of samples."""
    head = text.partition("[move]")[0]
    return f'{head}[move]\nprofile = "sampled"\nsamples = "samples.csv"\n'


DAMAGES: tuple[Damage, ...] = (
    *(_other_value, _other_number, _other_word) * 4,
    _misspelled, _other_line, _cut, _swapped, _inserted, _sampled,
)  # fmt: skip
"""Kinds of damage, some more often than others."""


def _encoded(text: str, random: Random) -> bytes:
    """Mostly as it should be, sometimes as another program or a bad disk would have it."""
    content, how = text.encode(), random.integers(40)
    if how == 0:
        return b"\xef\xbb\xbf" + content
    if how == 1:
        return text.replace("\n", "\r\n").encode()
    if how == 2:
        return text.encode("utf-16")
    if how == 3 and content:
        spoilt = bytearray(content)
        for place in random.integers(len(spoilt), size=3):
            spoilt[place] = random.integers(256)
        return bytes(spoilt)
    return content


def _samples(random: Random) -> bytes:
    """A table of a move, mostly with something wrong in it."""
    columns = int(random.integers(1, 5))
    rows = [[f"{0.5 * i:g}", *(f"{0.01 * i * i:g}" for _ in range(columns))] for i in range(8)]
    for _ in range(random.integers(3)):
        row = rows[int(random.integers(len(rows)))]
        row[int(random.integers(len(row)))] = str(random.choice(np.array(CELLS, dtype=object)))
    if random.random() < 0.2:
        rows[3].pop()
    if random.random() < 0.2:
        rows.reverse()
    mark = str(random.choice((",", ",", ",", ";", "\t", " ")))
    text = "\n".join(map(mark.join, rows[: int(random.choice((0, 1, 8, 8, 8)))]))
    return _encoded(f"time,x\n{text}" if random.random() < 0.5 else text, random)
