"""The pages of the API: every public name, on the page of its room of the package.

Public are the names in `__all__` of the packages below, and those of the modules that one needs
for parts of one's own.
"""

import ast
import functools
import importlib
import importlib.util
import inspect
import itertools
from pathlib import Path
from types import ModuleType
from typing import Any

PACKAGES = (
    "flatrig.models",
    "flatrig.feedforward",
    "flatrig.feedforward.dae",
    "flatrig.feedforward.integrators",
    "flatrig.feedforward.multibody",
    "flatrig.feedforward.rolling",
    "flatrig.envs",
)
MODULES = {
    "flatrig.envs.laws": ("Controller", "VectorController", "laws_of"),
    "flatrig.envs.ranges": ("PlantScenario", "Ranges"),
    "flatrig.envs.sb3": ("VecEnv",),
    "flatrig.training.commands": ("command",),
    "flatrig.training.compare.contenders": ("Contender", "contender"),
    "flatrig.training.compare.episode_sets": (
        "Episode",
        "EpisodeSet",
        "episode_set",
        "scenarios_for",
    ),
    "flatrig.training.jobs": (
        "Backend",
        "BackendError",
        "JobError",
        "Jobs",
        "Processes",
        "Result",
        "backend_for",
        "record",
    ),
    "flatrig.training.learned": ("LearnedResidual", "base_controller", "features_of"),
    "flatrig.training.plots": ("figure",),
    "flatrig.training.policy": ("Card", "Policy", "shipped"),
    "flatrig.training.policy_graph": ("graph_of", "memory_of"),
    "flatrig.training.reproduce.entry": ("Sheet", "entry"),
    "flatrig.training.simulate.open_loop": ("open_loop",),
    "flatrig.training.tables": ("table",),
}
"""Public names that no package lists."""

EXTRAS = ("onnx", "stable_baselines3")
"""What some of them import that a site is built without."""


@functools.cache
def public() -> dict[str, tuple[str, ...]]:
    """Names of each public package or module; a thing that has several places is in the first."""
    listed = {place: module(place).__all__ for place in PACKAGES}
    found: dict[str, tuple[str, ...]] = {}
    seen: set[int] = set()
    for place, names in (*listed.items(), *MODULES.items()):
        things = {name: thing(place, name) for name in names}
        new = {name: made for name, made in things.items() if id(made) not in seen}
        seen |= {id(made) for made in new.values() if hasattr(made, "__module__")}
        found[place] = tuple(new)
    return found


def thing(place: str, name: str) -> Any:
    """What a name of a package or module stands for."""
    return getattr(module(place), name)


@functools.cache
def module(place: str) -> ModuleType:
    """A package or module, imported without what is not installed of `EXTRAS`."""
    missing = [extra for extra in EXTRAS if not importlib.util.find_spec(extra)]
    if not missing:
        return importlib.import_module(place)
    from sphinx.ext.autodoc.mock import mock

    with mock(missing):
        return importlib.import_module(place)


def room(place: str, name: str) -> str:
    """Module whose page a name stands on: the room of its package where it is defined."""
    source = getattr(thing(place, name), "__module__", place).split(".")
    inner = place.split(".")
    within = source[: len(inner)] == inner and len(source) > len(inner) + 1
    return ".".join(source[: len(inner) + 1]) if within else place


def comment(place: str, name: str) -> str:
    """Docstring below the assignment of a constant, somewhere in a package; "" if there is none."""
    folder = Path(str(module(place).__file__)).parent
    for path in sorted(folder.rglob("*.py")):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        for made, said in itertools.pairwise(body):
            targets = getattr(made, "targets", [getattr(made, "target", None)])
            if name in [getattr(target, "id", "") for target in targets]:
                text = getattr(getattr(said, "value", None), "value", None)
                if isinstance(text, str):
                    return inspect.cleandoc(text)
    return ""


def entry(place: str, name: str) -> str:
    """Directive that documents a name."""
    made = thing(place, name)
    head = f".. currentmodule:: {place}\n\n"
    if inspect.isclass(made):
        kind = "exception" if issubclass(made, BaseException) else "class"
    elif inspect.isroutine(made):
        kind = "function"
    else:
        lines = "\n".join(f"   {line}".rstrip() for line in comment(place, name).splitlines())
        return f"{head}.. py:data:: {name}\n\n{lines}\n"
    return f"{head}.. auto{kind}:: {name}\n"


def pages() -> dict[str, list[tuple[str, str]]]:
    """Place and name of every public thing, by the page that it stands on."""
    found: dict[str, list[tuple[str, str]]] = {}
    for place, names in public().items():
        for name in names:
            found.setdefault(room(place, name), []).append((place, name))
    return found


def first_line(place: str) -> str:
    """Summary of a module, its first sentence on one line."""
    text = inspect.getdoc(module(place)) or ""
    return " ".join(text.split("\n\n")[0].split()).rstrip(":")


def write(folder: Path) -> None:
    """Write the pages into a folder, with an index."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for page, members in pages().items():
        head = f"{page}\n{'=' * len(page)}\n\n.. automodule:: {page}\n   :no-members:\n"
        body = "\n".join(entry(place, name) for place, name in members)
        (folder / f"{page}.rst").write_text(f"{head}\n{body}", encoding="utf-8")
        names = ", ".join(f":py:obj:`~{place}.{name}`" for place, name in members)
        rows.append(f":doc:`{page}`\n   {first_line(page)}\n\n   {names}\n")
    title = "Python"
    tree = "\n".join(f"   {page.removeprefix('flatrig.')} <{page}>" for page in pages())
    index = [title, "=" * len(title), "", *rows, ".. toctree::", "   :hidden:", "", tree, ""]
    (folder / "index.rst").write_text("\n".join(index), encoding="utf-8")
