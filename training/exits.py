"""How a command ends: its exit status, and the one line on stderr that says why.

    return refuse("the move is not feasible", report.problems)

A script can tell "no" from "what did you mean?": the first is an answer, the second none.
"""

import sys
from collections.abc import Sequence

DONE = 0
"""Done, and nothing speaks against it."""
NO = 1
"""The answer is no: a move cannot be made, a goal is missed, a number has left its band."""
MISTAKE = 2
"""Nothing was done: a mistake in options, description or files, or one of the system's refusals."""
LONGEST = 200
"""Letters of a word, such as a path, that is said whole."""
INTERRUPTED = 130
"""As shells have it for the signal SIGINT."""


def complain(text: str) -> None:
    """Say something in one line on stderr.

    What cannot be printed becomes an escape, and of a word without end only both ends are said.
    """
    words = (
        word if len(word) <= LONGEST else f"{word[:90]}...{word[-90:]}" for word in text.split()
    )
    line = " ".join(words)
    shown = "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in line)
    print(f"flatrig: {shown}", file=sys.stderr)


def refuse(what: str, problems: Sequence[str], *, force: bool = False) -> int:
    """Say in one line what is wrong, if anything is; returns the exit status.

    Parameters
    ----------
    what
        The answer that problems lead to, such as "the move is not feasible".
    problems
        What is wrong, one sentence each; the first one is said.
    force
        Whether the command goes on all the same and thereby does what it is asked to.
    """
    if not problems:
        return DONE
    others = len(problems) - 1
    more = f" (and {others} more problem{'s' if others > 1 else ''})" if others else ""
    complain(f"{'warning: ' * force}{what}: {problems[0]}{more}")
    return DONE if force else NO
