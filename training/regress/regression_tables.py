"""Tables of `flatrig regress`: one line for each model and integrator, at one time step."""

import math
from collections.abc import Container, Sequence

import numpy as np
from rich.table import Table

from ...models import HAND_CATALOGUE
from ...models.mjcf.rig_model import INTEGRATORS
from ..console import warning
from ..simulate.drift import DURATION
from ..tables import table
from . import crane_rows, hand_rows
from .row import Row

SUMMARY_STEP = 1e-3
"""Time step whose numbers are shown; the coarsest if a run has it not [s]."""
ROUNDED = 1e-9
"""Error below which rounding decides and a slope shows no order [m]."""

CRANES = {
    "error": "error [m]", "arrival": "arrival [m]", "tension": "tension [N]",
    "tension rms": "rms [N]", "energy": "energy [J]", "momentum": "momentum",
}  # fmt: skip
HANDS = {
    "slip": "slip", "away": "away [m]", "turned": "turned [rad]", "force": "force [N]",
    "force rms": "rms [N]", "friction": "friction", "creep": "creep [m]",
}  # fmt: skip
"""Quantities shown and their headings."""


def tables(rows: Sequence[Row], departed: Container[tuple[str, ...]]) -> list[Table]:
    """One of cranes and one of hands; `departed` have a number out of its band."""
    hands = [row for row in rows if row.model in HAND_CATALOGUE]
    cranes = [row for row in rows if row.model not in HAND_CATALOGUE]
    at = f"at {1e3 * SUMMARY_STEP:g} ms"
    found = []
    if cranes:
        title = (
            f"Exact feedforward, and {DURATION:g} s of free motion, in MuJoCo {at} "
            "(order: of the error over all steps, at most 2 with held inputs)"
        )
        found.append(_table(title, cranes, CRANES, departed))
    if hands:
        title = f"Rolling for {hand_rows.ROLL:g} s and holding for {hand_rows.HOLD:g} s {at}"
        found.append(_table(title, hands, HANDS, departed))
    return found


def _table(
    title: str, rows: Sequence[Row], columns: dict[str, str], departed: Container[tuple[str, ...]]
) -> Table:
    cranes = columns is CRANES
    order = ("order",) if cranes else ()
    lines = table(title, "model", "integrator", *columns.values(), *order, "[ms/s]", "")
    for model in dict.fromkeys(row.model for row in rows):
        for kind in INTEGRATORS:
            ladder = [row for row in rows if (row.model, row.integrator) == (model, kind)]
            row = next((row for row in ladder if row.step == SUMMARY_STEP), ladder[0])
            lines.add_row(
                model, kind, *(_cell(row[name], ".1e") for name in columns),
                *((_order(ladder),) if cranes else ()),
                _cell(row.cost, ".2g"),
                warning("out of band") if (model, kind) in departed else "",
            )  # fmt: skip
    return lines


def _cell(value: float, form: str) -> str:
    """A number; nothing where there is none."""
    return "" if math.isnan(value) else f"{value:{form}}"


def _order(ladder: Sequence[Row]) -> str:
    """By how many powers of the step the error falls, median over the ladder."""
    pairs = [(row.step, row["error"]) for row in ladder if ROUNDED < row["error"] < crane_rows.LOST]
    if len(pairs) < 2:
        return ""
    steps, errors = np.log(np.array(pairs)).T
    return f"{np.median(np.diff(errors) / np.diff(steps)):.1f}"
