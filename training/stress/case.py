"""What a stressed case is, how it may end, and who says so.

    case = Case("free fall", "at 0.9 g", partial(drop, 0.9), must=(CORRECT,))
    outcome = judge(case)              # outcome.ending, .error, .tolerance, .reason

A case is a function of nothing that returns what it found.  It ends

- correct: what was found lies within its tolerance of what a second road says,
- refused: a `FlatrigError` says why, before anything is computed wrongly,
- stopped: a run was ended, and a reason is named,
- wrong: none of these, or another of them than the case must end in.  A number that is not finite
  is wrong, as are a warning of NumPy's, an exception of another kind, and a case that does not end.
"""

import math
import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from ...models.errors import FlatrigError

CORRECT, REFUSED, STOPPED, WRONG = "correct", "refused", "stopped", "wrong"
ENDINGS = (CORRECT, REFUSED, STOPPED, WRONG)
EITHER: tuple[str, ...] = (CORRECT, REFUSED)
PATIENCE = 300.0
"""Seconds after which a case counts as one that does not end."""


class Stopped(Exception):
    """A run was ended; its argument names the reason."""


@dataclass(frozen=True)
class Found:
    """What a case found."""

    error: float
    """Distance from what the second road says, in the road's own measure."""
    tolerance: float
    road: str = ""
    """What the error is of."""
    limit: float | None = None
    """Largest stable time step [s]."""
    theory: float | None = None
    """What that should be [s]."""

    @property
    def share(self) -> float:
        """The error over its tolerance."""
        return self.error / self.tolerance


@dataclass(frozen=True)
class Case:
    """Something extreme, and how it must end."""

    row: str
    """Of the table; many cases share one."""
    label: str
    check: Callable[[], Found]
    must: tuple[str, ...] = (CORRECT,)
    """How it may end."""


@dataclass(frozen=True)
class Outcome:
    """How a case ended."""

    row: str
    label: str
    ending: str
    reason: str = ""
    error: float | None = None
    tolerance: float | None = None
    limit: float | None = None
    theory: float | None = None


def worst(*found: Found) -> Found:
    """The one that is nearest to its tolerance or farthest beyond; the first not finite."""
    return max(found, key=lambda one: one.share if math.isfinite(one.share) else math.inf)


def judge(case: Case, patience: float = PATIENCE) -> Outcome:
    """Run a case and say how it ended."""
    try:
        with warnings.catch_warnings(), _alarm(patience):
            warnings.simplefilter("error")
            found = case.check()
    except Stopped as stop:
        outcome = Outcome(case.row, case.label, STOPPED, str(stop))
    except FlatrigError as error:
        outcome = Outcome(case.row, case.label, REFUSED, f"{type(error).__name__}: {error}")
    except Exception as error:  # whatever it is, it was not meant to be
        return Outcome(case.row, case.label, WRONG, f"{type(error).__name__}: {error}")
    else:
        good = math.isfinite(found.error) and found.error <= found.tolerance
        outcome = Outcome(
            case.row,
            case.label,
            CORRECT if good else WRONG,
            found.road,
            found.error,
            found.tolerance,
            found.limit,
            found.theory,
        )
    if outcome.ending in case.must or outcome.ending == WRONG:
        return outcome
    expected = " or ".join(case.must)
    return Outcome(
        case.row, case.label, WRONG, f"{outcome.ending}, not {expected}: {outcome.reason}",
        outcome.error, outcome.tolerance, outcome.limit, outcome.theory,
    )  # fmt: skip


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Raise `TimeoutError` in the block after so many seconds, where the system has alarms."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def ring(*_: object) -> None:
        raise TimeoutError(f"still running after {seconds:g} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
