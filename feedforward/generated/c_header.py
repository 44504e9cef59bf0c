"""The declarations of a rig's C file: statuses, the motion, the state, and its functions."""

from collections.abc import Iterable

from .c_operations import wrapped
from .c_parts import BEGIN
from .c_words import Words, identifier
from .program import Program
from .statuses import MESSAGES


class Header:
    """Prints the declarations."""

    def __init__(self, program: Program, words: Words) -> None:
        self.program, self.words = program, words
        self.name = identifier(words.rig)
        self.upper = self.name.upper()
        self.spans = len(program.spans)
        self.axes = max((len(vector) for _, vector, _ in program.spans), default=0)

    def text(self) -> str:
        """The header."""
        program, name, upper = self.program, self.name, self.upper
        sizes = {
            "ORDER": program.order,
            "COLUMNS": program.columns,
            "INPUTS": len(program.inputs),
            "ROPES": len(program.tensions),
            "COORDINATES": len(program.names),
        }
        lines = [f"#ifndef {upper}_H", f"#define {upper}_H", ""]
        lines += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
        lines += [f"#define {upper}_{key} {value}" for key, value in sizes.items()]
        lines += ["", "/* What begin and step return; results are valid for the first two. */"]
        lines.append("enum {")
        for status in self.words.statuses:
            comma = "," if status < max(self.words.statuses) else ""
            lines.append(f"    {upper}_{status.name} = {status:d}{comma} /* {MESSAGES[status]} */")
        lines += ["};", ""]
        lines += self._motion() + self._state()
        lines += [
            *wrapped_comment(BEGIN),
            f"int {name}_begin({name}_state *state, const double *output);",
            "",
            *wrapped_comment(
                "One sample of the motion, h after the one before [s]. derivatives: the reference "
                f"and its first {program.order} derivatives, [order*{upper}_COLUMNS + column]. "
                "A refused sample leaves state and motion as they are."
            ),
            f"int {name}_step({name}_state *state, const double *derivatives, double h,",
            f"    {' ' * len(name)}          {name}_motion *motion);",
            "",
            "/* A status in words. */",
            f"const char *{name}_message(int status);",
            "",
            "#ifdef __cplusplus", "}", "#endif", "", "#endif",
        ]  # fmt: skip
        return "\n".join(lines) + "\n"

    def _motion(self) -> list[str]:
        words, upper = self.words, self.upper
        inputs = [
            f"{n} [{u}], limit {high:g}" if low == -high else f"{n} [{u}], {low:g} to {high:g}"
            for n, u, low, high in words.inputs
        ]
        coordinates = [f"{n} [{u}]" for n, u in zip(self.program.names, words.units, strict=True)]
        groups: list[tuple[str, str, str, Iterable[str]]] = [
            ("input", "INPUTS", "What drives apply", inputs),
            ("tension", "ROPES", _what(words), words.tensions),
            ("encoder", "INPUTS", "What an encoder on each drive reads", ()),
            ("encoder_rate", "INPUTS", "and its rate", ()),
            ("position", "COORDINATES", "Coordinates", coordinates),
            ("velocity", "COORDINATES", "their rates [1/s]", ()),
            ("acceleration", "COORDINATES", "and accelerations [1/s2]", ()),
        ]
        lines = ["typedef struct {"]
        for member, size, what, entries in groups:
            listed = "; ".join(f"{i} {entry}" for i, entry in enumerate(entries))
            lines += wrapped_comment(f"{what}{': ' if listed else ''}{listed}", 1)
            if size != "ROPES" or words.tensions:
                lines.append(f"    double {member}[{upper}_{size}];")
        return [*lines, f"}} {self.name}_motion;", ""]

    def _state(self) -> list[str]:
        program = self.program
        members = [
            ("newton", len(program.newton), "[3]", "unknowns that are found by Newton's method"),
            ("side", len(program.blocks), "", "signs of determinants: the branch of the solutions"),
            ("largest", len(program.determinants), "", "sizes of scalar determinants so far"),
            ("angle", len(program.angles), "", "of frames that turn, with all their turns [rad]"),
            ("span", self.spans, f"[{self.axes}]", "of the ropes [m]"),
        ]
        lines = [
            *wrapped_comment("What one sample tells the next; begin fills it."),
            "typedef struct {",
        ]
        for member, size, more, what in members:
            if size:
                lines.append(f"    double {member}[{size}]{more}; /* {what} */")
        return [
            *lines,
            "    int samples; /* 0 before begin, 1 before the first sample, then 2 */",
            f"}} {self.name}_state;",
            "",
        ]


def _what(words: Words) -> str:
    """What the tensions are."""
    links = ", then of links" if words.links else ""
    return f"Where ropes leave their winches{links} [N]"


def wrapped_comment(text: str, indent: int = 0) -> list[str]:
    """A comment on as many lines as it needs."""
    return list(wrapped(f"/* {text} */", indent))
