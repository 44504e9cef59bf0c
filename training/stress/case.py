"""What a stressed case is, how it may end, and who says so.

    stressed = case("free fall", "at 0.9 g", drop, 0.9, must=(CORRECT,))
    outcome = judge(stressed)          # outcome.ending, .error, .tolerance, .reason

A case is a function that returns a finding.  It ends

- correct: the finding lies within its tolerance of what a second road says,
- refused: a `FlatrigError` says why, before anything is computed wrongly,
- stopped: a run was ended, and a reason is named,
- wrong: none of these, or another of them than the case must end in.  A number that is not finite
  is wrong, as are a warning of NumPy's, an exception of another kind, and a case that does not end.
"""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from ...models.errors import FlatrigError
from ..jobs import record
from ..watchdog import limited

CORRECT, REFUSED, STOPPED, WRONG = "correct", "refused", "stopped", "wrong"
ENDINGS = (CORRECT, REFUSED, STOPPED, WRONG)
EITHER: tuple[str, ...] = (CORRECT, REFUSED)
PATIENCE = 300.0
"""Time after which a case counts as one that does not end [s]."""


class Stopped(Exception):
    """A run was ended; its argument names the reason."""


@dataclass(frozen=True)
class Finding:
    """What a case comes to: an error, and how large it may be."""

    error: float
    """Distance from what the second road says, in the road's own measure."""
    tolerance: float
    """Largest error that is correct, in the same measure."""
    road: str = ""
    """Name of the quantity that the error is of."""
    limit: float | None = None
    """Largest stable time step in MuJoCo [s]."""
    theory: float | None = None
    """Largest stable time step in theory [s]."""

    @property
    def share(self) -> float:
        """The error over its tolerance."""
        return self.error / self.tolerance


@dataclass(frozen=True)
class Case:
    """Something extreme, and how it must end."""

    row: str
    """Row of the table; many cases share one."""
    label: str
    """Name of the case in its row."""
    check: Callable[..., Finding]
    """Function that computes it."""
    must: tuple[str, ...] = (CORRECT,)
    """How it may end."""
    arguments: tuple[Any, ...] = ()
    """Arguments of the function; labels are rounded, so that they alone tell some cases apart."""


def case(
    row: str,
    label: str,
    check: Callable[..., Finding],
    *arguments: Any,
    must: tuple[str, ...] = (CORRECT,),
) -> Case:
    """The case of a function with arguments."""
    return Case(row, label, check, must, arguments)


@dataclass(frozen=True)
class Outcome:
    """How a case ended."""

    row: str
    """Row of the table."""
    label: str
    """Name of the case in its row."""
    ending: str
    """One of `ENDINGS`."""
    reason: str = ""
    """Why it was refused or stopped, or what its error is of."""
    error: float | None = None
    """Error of its finding, as the fields below; None if it was refused or stopped."""
    tolerance: float | None = None
    """Largest error that is correct."""
    limit: float | None = None
    """Largest stable time step in MuJoCo [s]."""
    theory: float | None = None
    """Largest stable time step in theory [s]."""


def worst(*findings: Finding) -> Finding:
    """The one that is nearest to its tolerance or farthest beyond; the first not finite."""
    return max(findings, key=lambda item: item.share if math.isfinite(item.share) else math.inf)


def attempt(stressed: Case, patience: float = PATIENCE) -> Outcome:
    """Run a case and say how it ended; correct means only that there is a finding."""
    ended = partial(Outcome, stressed.row, stressed.label)
    try:
        with warnings.catch_warnings(), limited(patience):
            warnings.simplefilter("error")
            finding = stressed.check(*stressed.arguments)
    except Stopped as stop:
        return ended(STOPPED, str(stop))
    except FlatrigError as error:
        return ended(REFUSED, f"{type(error).__name__}: {error}")
    except Exception as error:  # whatever it is, it was not meant to be
        return ended(WRONG, f"{type(error).__name__}: {error}")
    return ended(
        CORRECT, finding.road, finding.error, finding.tolerance, finding.limit, finding.theory
    )


def verdict(stressed: Case, attempted: Outcome) -> Outcome:
    """What an attempt at a case, fresh or kept, is worth: wrong if it has not ended as it must."""
    outcome = replace(attempted, row=stressed.row, label=stressed.label)
    if outcome.ending == WRONG:
        return outcome
    if outcome.ending == CORRECT and not _within(outcome):
        return replace(outcome, ending=WRONG)
    if outcome.ending in stressed.must:
        return outcome
    expected = " or ".join(stressed.must)
    reason = f"{outcome.ending}, not {expected}: {outcome.reason}"
    return replace(outcome, ending=WRONG, reason=reason)


def judge(stressed: Case, patience: float = PATIENCE) -> Outcome:
    """Run a case and judge it."""
    return verdict(stressed, attempt(stressed, patience))


def _within(outcome: Outcome) -> bool:
    """Whether there is an error, and not too large a one."""
    if outcome.error is None or outcome.tolerance is None:
        return False
    return math.isfinite(outcome.error) and outcome.error <= outcome.tolerance


def kept(entry: Any) -> Outcome:
    """The outcome that a file has kept as a dictionary.

    Raises
    ------
    ValueError, TypeError
        It is none.
    """
    outcome = record(Outcome, entry)
    if outcome.ending not in ENDINGS:
        raise ValueError(f"{outcome.ending!r} is no ending")
    return outcome
