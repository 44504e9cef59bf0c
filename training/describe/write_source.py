"""`flatrig export`: a crane's exact feedforward as source for a controller, and its policy."""

from pathlib import Path

from ... import feedforward
from ...models.files import STANDARD_OUTPUT, write_text
from .. import options
from ..console import console
from .write_policy import check, write_policy


def main(command: options.Export) -> None:
    """Write what is asked for: C with its header, Python, or a policy."""
    check(command)
    rig, move = command.target()
    if command.onnx:
        write_policy(command, rig)
    if not command.c and not command.python:
        return
    reference = feedforward.from_move(move, rig)
    out = console()
    if command.c:
        text = feedforward.source(rig, "c", reference)
        header = feedforward.source(rig, "c header", reference)
        write_text(command.c, text)
        if command.c != STANDARD_OUTPUT:
            beside = Path(command.c).with_suffix(".h")
            write_text(beside, header)
            out.print(f"wrote {command.c} and {beside}", soft_wrap=True)
            out.print(
                f"test it: cc -std=c99 -DSELF_TEST {command.c} -lm && ./a.out", soft_wrap=True
            )
    if command.python:
        write_text(command.python, feedforward.source(rig, "python"))
        if command.python != STANDARD_OUTPUT:
            out.print(f"wrote {command.python}", soft_wrap=True)
