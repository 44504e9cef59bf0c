"""Names in backticks: links where the API has a page, and a warning where nothing bears the name.

Docstrings speak of parameters, fields and modules in single backticks.  Sphinx knows those that the
API documents.  Of the others this extension accepts what stands in the sources, so that a warning
is left for a name that is wrong.
"""

import ast
import functools
import importlib
import re
from pathlib import Path
from typing import Any

import api
import numpy as np
from docutils import nodes
from numpy.typing import ArrayLike, NDArray
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.ext import napoleon
from sphinx.util.nodes import make_refnode
from sphinx.util.typing import stringify_annotation

import flatrig
from flatrig.models.types import Array, Mask

ROOMS = ("models", "feedforward", "envs", "training")


@functools.cache
def words() -> frozenset[str]:
    """Every name and short string constant in the package's sources."""
    found: set[str] = set()
    root = Path(str(flatrig.__file__)).parent
    for room in ROOMS:
        found.add(room)
        for path in (root / room).rglob("*.py"):
            found.add(path.stem)
            found.add(path.parent.name)
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                for field in ("id", "attr", "arg", "name", "value"):
                    value = getattr(node, field, None)
                    if isinstance(value, str) and len(value) < 40:
                        found.add(value)
    return frozenset(found)


@functools.cache
def pages() -> dict[int, str]:
    """Where each public class and function is documented, by its identity."""
    return {
        id(api.thing(place, name)): f"{place}.{name}"
        for place, names in api.public().items()
        for name in names
    }


def thing(dotted: str) -> Any:
    """What a dotted name leads to, None if to nothing."""
    parts = dotted.split(".")
    if not all(parts):
        return None
    for count in range(len(parts), 0, -1):
        try:
            found: Any = importlib.import_module(".".join(parts[:count]))
        except (ImportError, ValueError):
            continue
        for part in parts[count:]:
            found = getattr(found, part, None)
        return found
    return None


@functools.cache
def shorts() -> dict[str, str]:
    """Documented name by public name alone, in the first package that has it."""
    found: dict[str, str] = {}
    for place, names in api.public().items():
        for name in names:
            found.setdefault(name, f"{place}.{name}")
    return found


def documented(target: str) -> str:
    """Name under which a class, a function or a member of one is documented; "" if under none."""
    first, _, rest = target.partition(".")
    if first in shorts():
        return f"{shorts()[first]}.{rest}".rstrip(".")
    if found := pages().get(id(thing(target))):
        return found
    head, _, member = target.rpartition(".")
    owner = pages().get(id(thing(head))) if head else None
    return f"{owner}.{member}" if owner else ""


def resolve(app: Sphinx, env: Any, node: Any, contnode: nodes.Element) -> nodes.Element | None:
    """Lead a name to its page, or let it be code, or leave it to be warned of."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"]
    domain = env.get_domain("py")
    if (name := documented(target)) and name != target and name in domain.objects:
        entry = domain.objects[name]
        place = app.builder, node["refdoc"], entry.docname, entry.node_id
        return make_refnode(*place, contnode, name)
    plain = target.removeprefix(".").removesuffix(".py")
    parts = [part.rstrip("0123456789") for part in plain.split(".")]
    known = not all(part.isidentifier() for part in parts) or set(parts) <= words()
    return contnode if known or thing(plain) is not None else None


def with_code(lines: list[str]) -> list[str]:
    """Lines of a docstring in which indented blocks of its text are marked as code."""
    end = next((i for i, line in enumerate(lines) if line and not line.strip("-")), len(lines))
    found: list[str] = []
    last = ""
    for number, line in enumerate(lines):
        if line.startswith("    ") and number < end and found and not found[-1]:
            plain = last and not last.startswith((" ", "..", "- ", "* ")) and last[-2:] != "::"
            if plain:
                found += ["::", ""]
        found.append(line)
        last = line or last
    return found


def process(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Let napoleon read docstrings with sections; of a field it takes "word: text" for a type."""
    lines[:] = with_code(lines)
    if what not in ("attribute", "data", "property"):
        napoleon._process_docstring(app, what, name, thing, options, lines)


ALIASES = (
    ("ArrayLike", ArrayLike),
    ("Array", Array),
    ("Mask", Mask),
    ("NDArray", NDArray[Any]),
    ("NDArray", NDArray[np.int32]),
)


@functools.cache
def shorter() -> dict[str, str]:
    """Names for types of arrays, by what they are an alias of, the longest first."""
    texts = {
        stringify_annotation(alias, mode): name
        for name, alias in ALIASES
        for mode in ("smart", "fully-qualified", "fully-qualified-except-typing")
    }
    texts |= {re.sub(r"~?(?:\w+\.)+(?=\w)", "", text): name for text, name in texts.items()}
    return dict(sorted(texts.items(), key=lambda item: -len(item[0])))


def with_aliases(text: str) -> str:
    """A signature in which types of arrays are called as in the sources."""
    for long, short in shorter().items():
        text = text.replace(long, short)
    return text


def sign(app: Sphinx, *about: Any) -> tuple[str, str | None] | None:
    """Write a signature, of which there is one of a function or class, with those names."""
    *_, signature, returns = about
    if signature is None:
        return None
    return with_aliases(signature), returns and with_aliases(returns)


def name_types(app: Sphinx, tree: nodes.document) -> None:
    """Do so where a field or property tells its type."""
    for signature in tree.findall(addnodes.desc_annotation):
        if (text := with_aliases(signature.astext())) != signature.astext():
            signature.children = [nodes.Text(text)]


def setup(app: Sphinx) -> dict[str, bool]:
    """Take part in the build."""
    app.setup_extension("sphinx.ext.napoleon")
    for listener in list(app.events.listeners["autodoc-process-docstring"]):
        if listener.handler is napoleon._process_docstring:
            app.disconnect(listener.id)
    app.connect("autodoc-process-docstring", process)
    app.connect("autodoc-process-signature", sign)
    app.connect("doctree-read", name_types)
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
