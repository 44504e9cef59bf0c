"""The house as its imports show it: rooms, the arrows between them, and circles.

    python tests/rooms.py            # counts, and every circle
    python tests/rooms.py --rooms    # and which room takes from which

A room is a folder.  Its `__init__.py` is its door, which hands out what lies inside and below: a
node of its own.  Imports inside functions and for type checkers count like all others.
"""

import ast
import sys
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("models", "feedforward", "envs", "training")

Graph = dict[str, set[str]]
"""What each node takes from: files by their path relative to the root, or rooms."""


def files(root: Path = ROOT) -> list[str]:
    """Return the Python files of the package, relative to its root."""
    return sorted(
        path.relative_to(root).as_posix() for part in PARTS for path in (root / part).rglob("*.py")
    )


def arrows(root: Path = ROOT) -> Graph:
    """Return the files that each file imports."""
    known = set(files(root))
    return {file: set(_imported(root, file, known)) - {file} for file in sorted(known)}


def _imported(root: Path, file: str, known: set[str]) -> Iterable[str]:
    package = ("flatrig", *Path(file).parent.parts)
    for node in ast.walk(ast.parse((root / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            targets = [tuple(alias.name.split(".")) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            base += tuple(node.module.split(".")) if node.module else ()
            targets = [(*base, alias.name) for alias in node.names]
        else:
            continue
        yield from filter(None, (_file_of(target, known) for target in targets))


def _file_of(target: tuple[str, ...], known: set[str]) -> str | None:
    """Return the file that holds what is imported: a module, a name in one, or a door."""
    if target[0] != "flatrig":
        return None
    for parts in (target[1:], target[1:-1]):
        for path in ("/".join(parts) + ".py", "/".join((*parts, "__init__.py"))):
            if path in known:
                return path
    return None


def room_of(file: str) -> str:
    """Return the folder of a file, or the file itself where it is a door."""
    return file if file.endswith("__init__.py") else file.rpartition("/")[0]


def between_rooms(graph: Graph) -> Graph:
    """Return which room takes from which, without doors: those see all that lies below them."""
    rooms: Graph = defaultdict(set)
    for file, taken in graph.items():
        if not file.endswith("__init__.py"):
            rooms[room_of(file)] |= {room_of(t) for t in taken if not t.endswith("__init__.py")}
    return {room: taken - {room} for room, taken in rooms.items()}


def circles(graph: Graph) -> list[list[str]]:
    """Return the sets of nodes each of which reaches every other along arrows."""
    names = sorted(graph)
    number = {name: i for i, name in enumerate(names)}
    pairs = [(number[a], number[b]) for a, taken in graph.items() for b in taken if b in number]
    rows, columns = np.array(pairs).T if pairs else np.zeros((2, 0), int)
    size = (len(names), len(names))
    matrix = coo_array((np.ones(len(rows)), (rows, columns)), shape=size)
    _, component = connected_components(matrix, connection="strong")
    members = [[names[i] for i in np.flatnonzero(component == c)] for c in np.unique(component)]
    return [nodes for nodes in members if len(nodes) > 1]


def main() -> None:
    """Print what the house looks like."""
    graph = arrows()
    rooms = between_rooms(graph)
    print(f"{len(graph)} files, {sum(map(len, graph.values()))} imports between them")
    print(f"{len(rooms)} rooms, {sum(map(len, rooms.values()))} arrows between them")
    for title, nodes in (("files", graph), ("rooms", rooms)):
        tangled = circles(nodes)
        print(f"{len(tangled)} circles of {title}")
        for circle in tangled:
            print("   ", ", ".join(circle))
    if "--rooms" in sys.argv:
        for room, taken in sorted(rooms.items()):
            print(f"{room} <- {', '.join(sorted(taken)) or 'nothing'}")


if __name__ == "__main__":
    main()
