"""`flatrig reproduce`: the sources' figures and claims, computed anew.

    flatrig reproduce                   # lists them
    flatrig reproduce K3.21             # one: a table here, a figure and its numbers as CSV
    flatrig reproduce all -o figures    # all, into a folder

`flatrig.training.reproduce.entry` says how to add one.
"""

from pathlib import Path

from ...models.errors import OptionError, did_you_mean
from ...models.files import STANDARD_OUTPUT, make_folder
from .. import options
from ..console import console
from ..option_values import output_folder
from ..tables import table
from .entry import Entry, entries
from .gallery import write_page

FOLDER = "results/reproduce"


def main(command: options.Reproduce) -> None:
    """List the entries, or make one or all."""
    out = console()
    if command.list or not command.name:
        rows = ((entry.name, entry.title) for entry in entries().values())
        out.print(table("What can be reproduced", "name", "what it shows", rows=rows, right=False))
        return
    chosen = _chosen(command.name)
    if command.page == STANDARD_OUTPUT:
        raise OptionError("--page is '-', it must name a file: its pictures stand beside it")
    if command.page:
        write_page(Path(command.page), chosen)
        out.print(f"wrote {command.page}", soft_wrap=True)
        return
    folder = output_folder(command.output, FOLDER)
    if command.output:  # found out before the figures are computed
        make_folder(folder)
    for entry in chosen:
        summary, files = entry.run(folder)
        if entry.caption:
            out.print(f"{entry.name}: {entry.caption}", markup=False, highlight=False)
        out.print(summary)
        for path in files:
            out.print(f"wrote {path}", soft_wrap=True)


def _chosen(name: str) -> list[Entry]:
    """Entries that are meant.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    known = entries()
    chosen = [known[key] for key in known if name.lower() in (key.lower(), "all")]
    if not chosen:
        hint = did_you_mean(name, known)
        raise OptionError(f"there is nothing to reproduce called {name!r}{hint}")
    return chosen
