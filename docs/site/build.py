"""Build the site: `make docs`, or `python docs/site/build.py [FOLDER]`.

Pages are staged, laid out as in the repository, so that links between them and to sources lead
where they lead there; what is generated from the code is written beside them, not into the tree.
"""

import re
import shutil
import sys
from pathlib import Path

import api
from sphinx.cmd.build import main as sphinx

from flatrig.training.describe.environment_page import (
    environment_ids,
    environment_page,
    environments_page,
)
from flatrig.training.describe.toml_page import toml_page

SITE = Path(__file__).resolve().parent
ROOT = SITE.parents[1]
FIRST = """\
<!doctype html>
<title>flatrig</title>
<meta http-equiv="refresh" content="0; url=docs/index.html">
<a href="docs/index.html">flatrig's documentation</a>
"""
OPTIONS = ["-b", "html", "-n", "-W", "--keep-going", "-q", "-E", "-a", "-j", "auto"]
"""All anew, since every page shows the table of contents; and a warning is a mistake."""
LINKED = re.compile(r"\]\((?!https?:|mailto:)([^)#\s]+)")


def staged(folder: Path) -> Path:
    """Copy the pages, and what they link to, into a folder; returns it."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=shutil.ignore_patterns("__pycache__"))
    for page in ROOT.glob("*.md"):
        shutil.copy2(page, folder)
    for page in folder.rglob("*.md"):
        for target in LINKED.findall(page.read_text(encoding="utf-8")):
            there = (page.parent / target).resolve()
            here = ROOT / there.relative_to(folder)
            if here.is_file() and not there.exists():
                there.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(here, there)
    return folder


def write_environments(folder: Path) -> None:
    """Write a page for each environment into a folder, and an index."""
    folder.mkdir(exist_ok=True)
    names = [name.removeprefix("flatrig/") for name in environment_ids()]
    for name in names:
        (folder / f"{name}.md").write_text(environment_page(name), encoding="utf-8")
    tree = "\n".join(["```{toctree}", ":hidden:", *(f"{name} <{name}>" for name in names), "```\n"])
    (folder / "index.md").write_text(f"{environments_page()}\n{tree}", encoding="utf-8")


def main(folder: Path = ROOT / "build" / "docs") -> int:
    """Build the site into `html` of a folder; returns Sphinx's exit status."""
    folder = folder.resolve()
    source, html = staged(folder / "source"), folder / "html"
    reference = source / "docs" / "reference"
    api.write(reference / "api")
    (reference / "toml.md").write_text(toml_page(), encoding="utf-8")
    write_environments(reference / "environments")
    html.mkdir(parents=True, exist_ok=True)
    places = ["-c", SITE, "-d", folder / "doctrees", source, html]
    status = sphinx([*OPTIONS, *map(str, places)])
    (html / "index.html").write_text(FIRST, encoding="utf-8")
    print(html / "index.html")
    return status


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
