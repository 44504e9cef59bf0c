"""A rig's program as one file of C99, with its header, its start and a test of itself.

What the file says of itself is meant for whoever puts it into a controller and has nothing else.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ...models.types import Array
from ..exact.taylor import SINGULAR
from .c_header import Header
from .c_operations import Operations, wrapped
from .c_parts import ABOUT, DENSE, OUTSIDE, SELF_TEST
from .c_words import Replay, Start, Words, identifier
from .program import Program, Value, live, needs
from .statuses import MESSAGES, RAIL_TOLERANCE, SLACK, TURNED
from .words import number, text_of


def c_header(program: Program, words: Words) -> str:
    """The declarations, for other files of a controller."""
    return Header(program, words).text()


def c_source(program: Program, words: Words, start: Start, replay: Replay | None = None) -> str:
    """The file: declarations, functions, and under SELF_TEST a main program."""
    return _File(program, words).source(start, replay)


class _File:
    def __init__(self, program: Program, words: Words) -> None:
        self.program, self.words = _without_multipliers(program), words
        self.name = identifier(words.rig)
        self.upper = self.name.upper()

    def source(self, start: Start, replay: Replay | None) -> str:
        name, upper, words = self.name, self.upper, self.words
        columns = "; ".join(f"{i} {n} [{u}]" for i, (n, u) in enumerate(words.columns))
        about = ABOUT.format(
            name=name, upper=upper, rig=words.rig, version=words.version, columns=columns,
            order=self.program.order, outside=OUTSIDE[self.words.losses],
        )  # fmt: skip
        step = "\n".join(self._step())
        parts = [about, "#include <math.h>\n", Header(self.program, self.words).text()]
        if self.program.angles:
            parts.append("static const double TURN = 6.283185307179586;\n")
        if "larger(" in step:
            parts.append(LARGER)
        if "solve(" in step:
            parts.append(DENSE)
        parts += [step, self._begin(start), self._message()]
        if replay is not None:
            parts.append(self._test(replay))
        return "\n".join(parts)

    def _step(self) -> Iterator[str]:
        name, upper, program = self.name, self.upper, self.program
        operations = Operations(program, upper)
        body = [*operations.statements(program.operations), *self._checks()]
        body += [*operations.statements(program.extra), *self._crossings(), *self._keep()]
        used = set(re.findall(r"\b[rg]\d+(?:_\d+)?\b", "\n".join(body)))
        yield f"int {name}_step({name}_state *state, const double *derivatives, double h,"
        yield f"    {' ' * len(name)}          {name}_motion *motion)"
        yield "{"
        if not program.newton:
            yield "    (void)h;"
        yield f"    if (state->samples < 1) return {upper}_NOT_BEGUN;"
        factorial = 1.0
        for k in range(program.order + 1):
            factorial *= max(k, 1)
            for c in range(program.columns):
                if f"r{k}_{c}" in used:
                    value = f"derivatives[{k * program.columns + c}]"
                    scale = "" if factorial == 1.0 else f"{number(1.0 / factorial)}*"
                    yield f"    const double r{k}_{c} = {scale}{value};"
        for i in range(len(program.newton)):
            n = f"state->newton[{i}]"
            yield f"    const double g{i} = {n}[0] + h*({n}[1] + h*{n}[2]);"
        for i in range(len(program.angles)):
            yield f"    const double g{len(program.newton) + i} = state->angle[{i}];"
        yield from body
        yield "}"

    def _checks(self) -> Iterator[str]:
        """That all have a value, sides are kept, rails are not left, and frames do not jump."""
        program, upper = self.program, self.upper
        for place, name in enumerate(program.determinants):
            side = f"state->side[{program.scalar[place]}]"
            yield f"    if (!({name}*{side} > 0.0)) return {upper}_SINGULAR;"
            yield (
                f"    if (!(fabs({name}) > {number(SINGULAR)}*state->largest[{place}])) "
                f"return {upper}_SINGULAR;"
            )
        values = [v for v in self._values() if isinstance(v, str)]
        total = " + ".join(dict.fromkeys(values))
        yield from wrapped(f"if (!(fabs({total}) < HUGE_VAL)) return {upper}_LOST;", 1)
        for column, first, last in self.words.rails:
            at = text_of(program.kinematics[0][column])
            limits = [
                f"{at} {sign} {number(end)}"
                for sign, end in ((">=", first - RAIL_TOLERANCE), ("<=", last + RAIL_TOLERANCE))
                if abs(end) < float("inf")
            ]
            if limits:
                yield f"    if (!({' && '.join(limits)})) return {upper}_OFF_RAIL;"
        yield from self._rope_ends()
        for i, column in enumerate(program.angles):
            angle = text_of(program.kinematics[0][column])
            yield (
                f"    if (state->samples > 1 && !(fabs({angle} - state->angle[{i}]) < {TURNED}))"
                f" return {upper}_TURNED;"
            )

    def _rope_ends(self) -> Iterator[str]:
        """That no rope is longer or shorter than it can be."""
        for terms, low, high in self.words.rope_ends:
            at = " + ".join(
                f"{number(factor)}*{text_of(self.program.kinematics[0][column])}"
                for factor, column in terms
            )
            limits = [
                f"{at} {sign} {number(end)}"
                for sign, end in ((">=", low - RAIL_TOLERANCE), ("<=", high + RAIL_TOLERANCE))
                if abs(end) < float("inf")
            ]
            condition = f"if (!({' && '.join(limits)})) return {self.upper}_ROPE_END;"
            yield from wrapped(condition, 1)

    def _values(self) -> Sequence[Value]:
        program = self.program
        return [*(v for row in program.kinematics for v in row), *program.inputs, *program.tensions]

    def _crossings(self) -> Iterator[str]:
        """That no span is shorter than nothing or reverses."""
        for i, (_, vector, length) in enumerate(self.program.spans):
            if isinstance(length, str):
                yield f"    if (!({length} >= 0.0)) return {self.upper}_REVERSED;"
            along = " + ".join(f"{text_of(v)}*state->span[{i}][{a}]" for a, v in enumerate(vector))
            yield from wrapped(
                f"if (state->samples > 1 && {along} < 0.0) return {self.upper}_REVERSED;", 1
            )

    def _keep(self) -> Iterator[str]:
        """What the next sample needs, and the results."""
        program, upper = self.program, self.upper
        for i, series in enumerate(program.carried):
            for k, value in enumerate(series):
                yield f"    state->newton[{i}][{k}] = {text_of(value)};"
        for i, value in enumerate(program.determinants):
            yield (
                f"    if (fabs({value}) > state->largest[{i}]) state->largest[{i}] = fabs({value});"
            )
        for i, column in enumerate(program.angles):
            yield f"    state->angle[{i}] = {text_of(program.kinematics[0][column])};"
        for i, (_, vector, _) in enumerate(program.spans):
            for a, value in enumerate(vector):
                yield f"    state->span[{i}][{a}] = {text_of(value)};"
        yield "    state->samples = 2;"
        groups = zip(("position", "velocity", "acceleration"), program.kinematics, strict=True)
        members: list[tuple[str, tuple[Value, ...]]] = [
            ("input", program.inputs),
            ("tension", program.tensions),
            *groups,
        ]
        for k, member in enumerate(("encoder", "encoder_rate")):
            members.append((member, tuple(program.kinematics[k][j] for j in self.words.encoders)))
        for member, values in members:
            for i, value in enumerate(values):
                yield f"    motion->{member}[{i}] = {text_of(value)};"
        if self.words.pulling:
            yield from self._taut()
        yield f"    return {upper}_OK;"

    def _taut(self) -> Iterator[str]:
        """The check that what cannot push does not."""
        pulling, upper = self.words.pulling, self.upper
        first, which = f"motion->tension[{pulling[0]}]", "i"
        yield f"    double lowest = {first}, highest = fabs({first});"
        if len(pulling) == len(self.words.tensions):
            yield f"    for (int i = 1; i < {upper}_ROPES; ++i) {{"
        else:
            which = "pulling[i]"
            listed = ", ".join(map(str, pulling))
            yield f"    static const int pulling[{len(pulling)}] = {{{listed}}};"
            yield f"    for (int i = 1; i < {len(pulling)}; ++i) {{"
        yield f"        const double tension = motion->tension[{which}];"
        yield "        if (tension < lowest) lowest = tension;"
        yield "        if (fabs(tension) > highest) highest = fabs(tension);"
        yield "    }"
        yield f"    if (lowest < -{number(SLACK)}*highest) return {upper}_SLACK;"

    def _begin(self, start: Start) -> str:
        name, upper, program = self.name, self.upper, self.program
        home = ", ".join(map(number, start.outputs))
        lines = [
            f"int {name}_begin({name}_state *state, const double *output)",
            "{",
            f"    static const double home[{upper}_COLUMNS] = {{{home}}};",
            f"    double derivatives[({upper}_ORDER + 1)*{upper}_COLUMNS] = {{0.0}};",
            f"    {name}_motion motion;",
        ]
        values = [(f"newton[{i}][0]", v) for i, v in enumerate(start.newton)]
        values += [(f"newton[{i}][{k}]", 0.0) for i in range(len(start.newton)) for k in (1, 2)]
        values += [(f"side[{i}]", v) for i, v in enumerate(start.sides)]
        values += [(f"largest[{i}]", 0.0) for i in range(len(program.determinants))]
        values += [(f"angle[{i}]", v) for i, v in enumerate(start.angles)]
        lines += [f"    state->{member} = {number(v)};" for member, v in values]
        lines += [
            "    state->samples = 1;",
            "    for (int i = 0; i <= 64; ++i) {",
            f"        for (int c = 0; c < {upper}_COLUMNS; ++c)",
            "            derivatives[c] = home[c] + (output[c] - home[c])*(i/64.0);",
            f"        const int status = {name}_step(state, derivatives, 0.0, &motion);",
            f"        if (status > {upper}_SLACK) {{",
            "            state->samples = 0;",
            "            return status;",
            "        }",
            "        if (i == 64) return status;",
            "    }",
            f"    return {upper}_OK;",
            "}",
            "",
        ]
        return "\n".join(lines)

    def _message(self) -> str:
        lines = [f"const char *{self.name}_message(int status)", "{", "    switch (status) {"]
        for status in self.words.statuses:
            lines.append(f'    case {self.upper}_{status.name}: return "{MESSAGES[status]}";')
        return "\n".join([*lines, '    default: return "no status";', "    }", "}", ""])

    def _test(self, replay: Replay) -> str:
        values = {
            "name": self.name,
            "upper": self.upper,
            "samples": len(replay.inputs),
            "step": number(replay.step),
            "derivatives": rows(replay.derivatives.reshape(len(replay.inputs), -1)),
            "inputs": rows(replay.inputs),
            "tensions": rows(replay.tensions),
        }
        text = SELF_TEST
        for key, value in values.items():
            text = text.replace(f"@{key}@", str(value))
        return text


def _without_multipliers(program: Program) -> Program:
    """A program that finds what the file hands out, and no more."""
    wanted = [v for values in (*program.kinematics, *program.carried) for v in values]
    wanted += [*program.inputs, *program.tensions, *program.determinants]
    wanted += [v for _, vector, length in program.spans for v in (*vector, length)]
    wanted += [value for operation in program.extra for value in needs(operation)]
    return replace(program, operations=live(program.operations, wanted))


LARGER = """static double larger(double a, double b)
{
    return a > b ? a : b;
}
"""


def rows(table: Array) -> str:
    """Rows of numbers as C reads them."""
    lines: list[str] = []
    for row in table:
        lines += wrapped("{" + ", ".join(map(number, row.tolist())) + "},", 1)
    return "\n".join(lines)
