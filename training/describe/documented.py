"""What docstrings say of fields and parameters, as rows of Markdown tables."""

import ast
import inspect
import itertools
import re
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any


def field_texts(kind: type) -> dict[str, str]:
    """Docstrings of a class's fields, and of those that it inherits, by name."""
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        if base.__module__.partition(".")[0] != __name__.partition(".")[0]:
            continue
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(base))).body
        body = getattr(tree, "body", [])
        for made, said in itertools.pairwise(body):
            if isinstance(made, ast.AnnAssign) and isinstance(made.target, ast.Name):
                text = getattr(getattr(said, "value", None), "value", None)
                if isinstance(text, str):
                    found[made.target.id] = " ".join(text.split())
    return found


def parameter_texts(documented: Any) -> dict[str, str]:
    """What the section "Parameters" of a docstring says, by name."""
    text = inspect.getdoc(documented) or ""
    _, _, section = text.partition("Parameters\n----------\n")
    section = re.split(r"\n\w[\w ]*\n---+\n", section)[0]
    parts = re.findall(r"^(\w[^\n]*)\n((?:(?: {4}[^\n]*)?(?:\n|\Z))+)", section, flags=re.MULTILINE)
    return {name.strip(): " ".join(said.split()) for name, said in parts}


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(map(_cell, line))} |\n" for line in lines)


def code(value: object) -> str:
    """A value as code."""
    return f"`{value}`"


def _cell(value: object) -> str:
    text = " ".join(str(value).replace("``", "`").split())
    return text.replace("|", r"\|")
