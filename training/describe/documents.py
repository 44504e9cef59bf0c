"""`flatrig docs`: the pages that travel with the package, and those that are made from the code."""

import sys
import webbrowser
from collections.abc import Callable
from pathlib import Path

from ...models.errors import OptionError, did_you_mean
from ...models.reading import read_text
from ..console import console
from ..options import Docs

ROOT = Path(__file__).resolve().parents[2]
"""What travels: README.md, CONTRIBUTING.md, CHANGELOG.md, and the folder docs."""
HTML = ROOT / "build" / "docs" / "html"
"""What `make docs` writes."""


def written_pages() -> dict[str, Path]:
    """Pages that are files, by name: "how-to/ship", "README"."""
    docs = ROOT / "docs"
    found = {path.stem: path for path in sorted(ROOT.glob("*.md"))}
    paths = sorted(docs.rglob("*.md"), key=lambda path: (path.parent != docs, path))
    return found | {path.relative_to(docs).with_suffix("").as_posix(): path for path in paths}


def made_pages() -> dict[str, Callable[[], str]]:
    """Pages that are made when they are asked for, by name."""
    from .environment_page import environment_ids, environment_page, environments_page
    from .toml_page import toml_page

    single = {name: lambda name=name: environment_page(name) for name in environment_ids()}
    return {"toml": toml_page, "environments": environments_page, **single}


def show(command: Docs) -> None:
    """Print a page, or the list of pages; or open it.

    Raises
    ------
    OptionError
        There is no such page, or it is to be opened and is not built.
    """
    if command.open:
        place = _to_open(command.page)
        print(place)
        webbrowser.open(place.as_uri())
    elif command.page:
        _print(_text(command.page))
    else:
        index = HTML / "docs" / "index.html"
        print(index if index.exists() else ROOT / "docs" / "index.md")
        titles = {name: _title(path) for name, path in written_pages().items()}
        titles |= dict.fromkeys(made_pages(), "made from the code")
        print(*(f"{name:<34} {title}" for name, title in titles.items()), sep="\n")


def _text(page: str) -> str:
    """A page in Markdown.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    if (path := _file(page)) is not None:
        return read_text(path, OptionError)
    made = made_pages()
    return made[_made_name(page)]()


def _file(page: str) -> Path | None:
    """The file of a page by its name, which may lack the folder; None if it is not a file."""
    plain = page.removesuffix(".md").removeprefix("docs/")
    pages = written_pages()
    last = [path for name, path in pages.items() if name.rpartition("/")[2] == plain]
    return pages.get(plain) or (last[0] if last and plain != "index" else None)


def _made_name(page: str) -> str:
    made = made_pages()
    plain = page.lower()
    for name in made:
        short = name.removeprefix("flatrig/")
        if plain in (name.lower(), short.lower(), short.lower().removesuffix("-v0")):
            return name
    names = [*written_pages(), *(name.rpartition("/")[2] for name in written_pages()), *made]
    close = did_you_mean(page, dict.fromkeys(names))
    hint = close if "did you mean" in close else "; `flatrig docs` lists them"
    raise OptionError(f"there is no page {page!r}{hint}")


def _to_open(page: str) -> Path:
    """What to open for a page: as it was built, or else its file.

    Raises
    ------
    OptionError
        There is none, or it is made from the code and not built.
    """
    if not page:
        built, path = HTML / "docs" / "index.html", ROOT / "docs" / "index.md"
    elif (found := _file(page)) is not None:
        path = found
        built = HTML / path.relative_to(ROOT).with_suffix(".html")
    else:
        name = _made_name(page)
        inner = {"toml": "toml", "environments": "environments/index"}.get(name)
        short = name.removeprefix("flatrig/")
        inner = inner or f"environments/{short}"
        built = path = HTML / "docs" / "reference" / f"{inner}.html"
    if not built.exists() and not path.exists():
        raise OptionError(f"{page} is made from the code; `flatrig docs {page}` prints it")
    return built if built.exists() else path


def _title(path: Path) -> str:
    return read_text(path, OptionError).partition("\n")[0].removeprefix("# ")


def _print(text: str) -> None:
    """Show Markdown: set in a terminal, as it is in a pipe or file."""
    screen = console()
    if not screen.is_terminal:
        sys.stdout.write(text)
        return
    from rich.markdown import Markdown

    with screen.pager(styles=True):
        screen.print(Markdown(text))
