"""Structural analysis of a rig's equations with its outputs prescribed.

Pryce's signature method (BIT 41, 2001): sigma_ij is the order of the highest derivative of
unknown j in equation i; a highest-value transversal pairs equations with unknowns; the
offsets c_i and d_j say how often equation i must be differentiated and up to which
derivative unknown j is then determined.  From them follow

- the index, max c + 1 if some d is zero,
- the derivatives that the reference needs, the largest c among the servo constraints,
- the degrees of freedom left, sum d - sum c, which is 0 if the outputs are flat.

The Jacobian of the differentiated equations has an entry where sigma_ij = d_j - c_i; its
strongly connected blocks can be solved one after the other.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from graphlib import TopologicalSorter
from typing import Literal

import numpy as np
import scipy

from ...models.errors import RigError
from .advice import what_to_change
from .distribution import open_unknowns, rules
from .equations import Equations
from .servo import Servo

NEVER = -(10**6)
"""Signature of an unknown that does not stand in an equation."""


@dataclass(frozen=True)
class Row:
    """One equation, sum of terms = 0, as its monomials in the unknowns w and the reference."""

    kind: Literal["motion", "constraint", "servo constraint", "distribution"]
    of: str
    """Name of the coordinate, constraint or output that it is the equation of."""
    constant: float = 0.0
    linear: tuple[tuple[float, int], ...] = ()
    """(a, j): a w_j"""
    first: tuple[tuple[float, int], ...] = ()
    """(a, j): a w_j'"""
    second: tuple[tuple[float, int], ...] = ()
    """(a, j): a w_j''"""
    quadratic: tuple[tuple[float, int, int], ...] = ()
    """(a, j, k): a w_j w_k"""
    output: int | None = None
    """Column of what is prescribed that is subtracted."""
    follows: int | None = None
    """Unknown that a constraint of a frame's direction says from others, with factor 1."""

    @property
    def name(self) -> str:
        """Kind and whose, such as "motion of load.x" or "constraint hoist.1"."""
        joined = " of " if self.kind in ("motion", "distribution") else " "
        return f"{self.kind}{joined}{self.of}"

    @property
    def plain(self) -> bool:
        """Whether it prescribes an unknown itself, not a sum of them."""
        return len(self.linear) == 1 and self.linear[0][0] == 1.0 and not self.quadratic

    def signature(self) -> dict[int, int]:
        """Order of the highest derivative of each unknown in this equation."""
        orders = {j: 0 for _, j in self.linear}
        orders |= {j: 0 for _, *pair in self.quadratic for j in pair}
        orders |= {j: 1 for _, j in self.first}
        return orders | {j: 2 for _, j in self.second}


@dataclass(frozen=True)
class Analysis:
    """What the structure of a rig's equations says about its inverse dynamics."""

    rig_name: str
    unknowns: tuple[str, ...]
    """Coordinates, multipliers and inputs."""
    rows: tuple[Row, ...]
    """Equations of motion, constraints and servo constraints."""
    equation_offsets: tuple[int, ...]
    """How often each equation must be differentiated, Pryce's c."""
    unknown_offsets: tuple[int, ...]
    """Up to which derivative each unknown is then determined, Pryce's d."""
    blocks: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    """(equations, unknowns) of each block, in the order in which they can be solved; the i-th
    equation is paired with the i-th unknown."""
    massless: frozenset[int] = frozenset()
    """Unknowns that are coordinates of free pulleys without mass."""

    @property
    def index(self) -> int:
        """Differentiation index of the DAE (Y 3.1), by Pryce's formula."""
        return max(self.equation_offsets) + (min(self.unknown_offsets) == 0)

    @property
    def reference_order(self) -> int:
        """Number of continuous derivatives that the reference must have."""
        offsets = zip(self.rows, self.equation_offsets, strict=True)
        return max((c for row, c in offsets if row.output is not None), default=0)

    @property
    def degrees_of_freedom(self) -> int:
        """Free initial values with the outputs prescribed; 0 for flat outputs."""
        return sum(self.unknown_offsets) - sum(self.equation_offsets)

    @property
    def flat(self) -> bool:
        """Whether the outputs determine everything."""
        return self.degrees_of_freedom == 0


def analyse_equations(equations: Equations, servo: Servo) -> Analysis:
    """Structure of the equations of a rig whose outputs are prescribed.

    Raises
    ------
    RigError
        The equations are structurally singular: some unknown is determined by no
        equation, or the outputs contradict each other.
    """
    rig = equations.rig
    rows = _rows(equations, servo)
    unknowns = (
        *equations.names,
        *(f"multiplier of {name}" for name in equations.constraint_names),
        *rig.input_names,
        *open_unknowns(equations),
    )
    signature = np.full((len(rows), len(unknowns)), NEVER)
    for i, row in enumerate(rows):
        for j, order in row.signature().items():
            signature[i, j] = order
    advice = what_to_change(rig)
    partner = _transversal(rig.name, rows, unknowns, signature, advice)
    c, d = _offsets(signature, partner)
    light = [load.name for load in rig.loads if load.mass == 0]
    return Analysis(
        rig_name=rig.name,
        unknowns=unknowns,
        rows=rows,
        equation_offsets=tuple(c.tolist()),
        unknown_offsets=tuple(d.tolist()),
        blocks=_blocks(signature == d[None, :] - c[:, None], partner),
        massless=frozenset(unknowns.index(f"{name}.{axis}") for name in light for axis in rig.axes),
    )


def _rows(equations: Equations, servo: Servo) -> tuple[Row, ...]:
    n, m = len(equations.names), len(equations.constraint_names)
    frames = equations.with_role("frame")
    rows, damping = [], equations.damping
    for i, name in enumerate(equations.names):
        pulls = equations.constraints[:, i, :]
        if equations.pushed is not None:
            pulls = pulls * equations.pushed[:, [i]]
        rows.append(
            Row(
                kind="motion",
                of=name,
                constant=-float(equations.force[i]),
                linear=_pairs((pulls[k, n], n + k) for k in range(m))
                + _pairs((-b, n + m + a) for a, b in enumerate(equations.input_constant[i])),
                first=() if damping is None else _pairs(zip(damping[i], range(n), strict=True)),
                second=_pairs(zip(equations.mass[i], range(n), strict=True)),
                quadratic=_triples((pulls[k, j], n + k, j) for k in range(m) for j in range(n))
                + _triples(
                    (-value, n + m + a, j)
                    for a, values in enumerate(equations.input_linear[i])
                    for j, value in enumerate(values)
                ),
            )
        )
    constraints = zip(equations.constraint_names, equations.constraints, strict=True)
    for k, (name, matrix) in enumerate(constraints):
        if k in servo.implied:
            continue
        rows.append(
            Row(
                kind="constraint",
                of=name,
                constant=0.5 * float(matrix[n, n]),
                linear=_pairs(zip(matrix[n, :n], range(n), strict=True)),
                quadratic=_triples(
                    (matrix[i, j] * (0.5 if i == j else 1.0), i, j)
                    for i in range(n)
                    for j in range(i, n)
                ),
                follows=equations.roles[k].coordinate if k in frames else None,
            )
        )
    prescribed = zip(servo.names, servo.rows, servo.products, strict=True)
    for column, (name, terms, products) in enumerate(prescribed):
        rows.append(
            Row(
                kind="servo constraint",
                of=name,
                linear=terms,
                quadratic=products,
                output=column,
            )
        )
    first = n + m + len(equations.rig.drives)
    for rule in rules(equations):
        itself = () if rule.multiplier is None else ((1.0, n + rule.multiplier),)
        rows.append(
            Row(
                kind="distribution",
                of=rule.of,
                constant=-rule.wanted,
                linear=itself + tuple((-a, first + y) for a, y in rule.constant),
                quadratic=tuple((-a, first + y, j) for a, y, j in rule.linear),
            )
        )
    return tuple(rows)


def _pairs(terms: Iterable[tuple[float, int]]) -> tuple[tuple[float, int], ...]:
    return tuple((float(a), j) for a, j in terms if a != 0)


def _triples(terms: Iterable[tuple[float, int, int]]) -> tuple[tuple[float, int, int], ...]:
    return tuple((float(a), j, k) for a, j, k in terms if a != 0)


def _transversal(
    rig_name: str,
    rows: tuple[Row, ...],
    unknowns: tuple[str, ...],
    signature: np.ndarray,
    advice: str,
) -> np.ndarray:
    """The unknown paired with each equation in a highest-value transversal.

    The advice is what to do where there is none.
    """
    equations, partner = scipy.optimize.linear_sum_assignment(signature, maximize=True)
    for i, j in zip(equations, partner, strict=True):
        if signature[i, j] == NEVER:
            raise RigError(
                f"rig {rig_name} is structurally singular: nothing determines {unknowns[j]} "
                f"({rows[i].name} is one equation too many); {advice}"
            )
    return np.asarray(partner)


def _offsets(signature: np.ndarray, partner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The smallest offsets c >= 0 and d with d_j - c_i >= sigma_ij, equal on the transversal."""
    c = np.zeros(len(signature), dtype=int)
    while True:
        d = (signature + c[:, None]).max(axis=0)
        raised = d[partner] - signature[np.arange(len(c)), partner]
        if (raised == c).all():
            return c, d
        c = raised


def _blocks(
    pattern: np.ndarray, partner: np.ndarray
) -> tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]:
    """Strongly connected blocks of the Jacobian, each after those that it depends on."""
    needs = pattern[:, partner]  # needs[i, k]: equation i contains the unknown of equation k
    count, label = scipy.sparse.csgraph.connected_components(
        scipy.sparse.csr_array(needs), connection="strong"
    )
    graph: dict[int, set[int]] = {block: set() for block in range(count)}
    for i, k in zip(*np.nonzero(needs), strict=True):
        if label[i] != label[k]:
            graph[int(label[i])].add(int(label[k]))
    blocks = []
    for block in TopologicalSorter(graph).static_order():
        members = np.flatnonzero(label == block)
        blocks.append((tuple(members.tolist()), tuple(partner[members].tolist())))
    return tuple(blocks)
