"""A page that needs nothing else: HTML with its style, pictures and films inside."""

import base64
import io
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from .. import plots

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #202020; max-width: 62rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; }
h2 { font-size: 1.2rem; margin-top: 2rem; border-bottom: 1px solid #d0d0d0; }
table { border-collapse: collapse; margin: .6rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .8rem .2rem 0; text-align: right; border-bottom: 1px solid #e6e6e6; }
th:first-child, td:first-child { text-align: left; }
table:not(:has(thead)) td { text-align: left; padding-right: 2rem; }
thead th { font-weight: 600; border-bottom: 1px solid #808080; }
img, svg { max-width: 100%; height: auto; }
.yes, .no { padding: .4rem .8rem; border-left: .4rem solid #009e73; background: #f2f8f6; }
.no { border-color: #d55e00; background: #fcf3ee; }
pre { background: #f5f5f5; padding: .6rem; overflow-x: auto; font-size: 13px; }
.wide { overflow-x: auto; }
footer { margin-top: 2rem; color: #606060; font-size: 13px; }
@media print { body { max-width: none; margin: 0; font-size: 11px; }
  h2, tr { break-after: avoid; } img, svg, table { break-inside: avoid; }
  pre { white-space: pre-wrap; } .film { display: none; } }
"""


def page(title: str, parts: Iterable[str]) -> str:
    """The whole file."""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body>\n</html>\n"
    )


def paragraph(text: str, kind: str = "") -> str:
    """Some text."""
    return f"<p{f' class={kind}' if kind else ''}>{escape(text)}</p>"


def heading(text: str) -> str:
    """Of a section."""
    return f"<h2>{escape(text)}</h2>"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, which scrolls where the page is narrow."""
    top = "".join(f"<th>{escape(head)}</th>" for head in heads)
    body = "\n".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    head = f"<thead><tr>{top}</tr></thead>\n" if any(heads) else ""
    return f'<div class="wide"><table>{head}<tbody>\n{body}\n</tbody></table></div>'


def picture(data: bytes, kind: str, words: str, style: str = "") -> str:
    """A picture or a film, inside the page."""
    coded = base64.b64encode(data).decode("ascii")
    label = f' class="{style}"' if style else ""
    return f'<p{label}><img alt="{escape(words)}" src="data:image/{kind};base64,{coded}"></p>'


def figure(drawn: Any, words: str) -> str:
    """A figure, inside the page."""
    buffer = io.BytesIO()
    drawn.savefig(buffer, format="png", dpi=plots.DENSITY, metadata={"Software": None})
    return picture(buffer.getvalue(), "png", words)


def verbatim(text: str) -> str:
    """Text as it is."""
    return f"<pre>{escape(text)}</pre>"
