"""From the plan of steps of a rig to a straight-line program.

Every step of the expansion, over the Taylor coefficients of the unknowns, is a short list of
products with factors that never change.  They are written out once for each rig: sums of products
that stages share are formed once, a block's matrix, which is the same at all stages, is factored
once, and whatever depends on numbers alone is folded beforehand.
"""

from collections.abc import Collection

import numpy as np

from ...models.types import Array
from ..exact.problem import Problem
from ..exact.steps import Slope, Step
from ..exact.structure import Row
from .angles import Series, directors, sine_cosine
from .builder import Builder, Polynomial, add, convolution, scaled
from .elimination import Eliminated, Matrix, Pivot, choose
from .forms import Factored, Form, factored
from .program import Newton, Program, Regular, Root, Solve, Value, live, needs
from .results import Coefficient, Results


def generate(problem: Problem, samples: list[list[Array]]) -> Program:
    """The program of a flat rig.

    Parameters
    ----------
    problem
        Of the rig.
    samples
        Taylor coefficients of its unknowns at some samples, from which pivots are chosen.

    Raises
    ------
    Singular
        A block's matrix is singular whatever the path.
    """
    return _Generator(problem, samples).program()


class _Generator:
    def __init__(self, problem: Problem, samples: list[list[Array]]) -> None:
        self.problem, self.samples = problem, samples
        self.builder = Builder()
        self.known: dict[Coefficient, Value] = {}
        self.prescribed = self._prescribe()
        self.blocks: dict[int, str | None] = {}  # with the determinant of those that are scalar
        self.roots: dict[int, str] = {}
        self.newton: list[int] = []
        self.pivots: dict[tuple[tuple[Slope, ...], ...], tuple[tuple[Pivot, ...], Array]] = {}
        self.factors: dict[Matrix, Eliminated] = {}
        self.count = 0
        self.rows: dict[Row, Factored] = {}

    def program(self) -> Program:
        for step in self.problem.steps:
            getattr(self, f"_{step.kind}")(step)
        problem, rig = self.problem, self.problem.rig
        equations = problem.equations
        n, m = len(equations.names), len(equations.constraint_names)
        results = Results(self.builder, self.problem, self.known)
        names, kinematics, angles = results.coordinates(len(self.newton))
        values = [self.known[j, 0] for j in range(n + m)]
        tensions = results.tensions()
        inputs = results.inputs(names, kinematics[1])
        carried = tuple(
            (self.known[j, 0], self.known.get((j, 1), 0.0), self.known.get((j, 2), 0.0))
            for j in self.newton
        )
        with self.builder.apart() as further:
            spans = results.spans()
        wanted = [*(v for row in kinematics for v in row), *values[n:], *inputs, *tensions]
        wanted += [v for group in carried for v in group]
        wanted += [name for name in self.blocks.values() if name]
        extra = [v for _, vector, length in spans for v in (*vector, length)]
        tail = live(further, extra)
        kept = live(
            self.builder.operations, [*wanted, *extra, *(v for o in tail for v in needs(o))]
        )
        return Program(
            order=problem.order,
            columns=len(rig.outputs),
            operations=kept,
            extra=tail,
            blocks=tuple(self.blocks),
            determinants=tuple(name for name in self.blocks.values() if name),
            scalar=tuple(i for i, name in enumerate(self.blocks.values()) if name),
            newton=tuple(self.newton),
            carried=carried,
            names=names,
            kinematics=kinematics,
            multipliers=tuple(values[n:]),
            inputs=inputs,
            tensions=tensions,
            angles=angles,
            spans=spans,
        )

    # What is prescribed

    def _prescribe(self) -> list[Series]:
        """The series of each servo constraint's right-hand side."""
        order, servo, builder = self.problem.order, self.problem.servo, self.builder

        def column(c: int) -> Series:
            return [f"r{k}_{c}" for k in range(order + 1)]

        if not servo.implied:  # the reference's columns are the prescribed values
            return [column(c) for c in range(len(self.problem.rig.outputs))]
        prescribed: list[Series] = []
        for kind, columns in servo.sources:
            if kind == "platform":
                prescribed += directors(builder, [column(c) for c in columns])
            elif kind == "frame":
                sin, cos = sine_cosine(builder, column(columns[0]))
                prescribed += [cos, sin]
            else:
                prescribed.append(column(columns[0]))
        return prescribed

    # Equations

    def _coefficient(
        self, row: Row, order: int, unknown: Collection[Coefficient] = ()
    ) -> Polynomial:
        """The coefficient of an order of an equation, without what is not known yet."""
        known = dict.fromkeys(unknown, 0.0)

        def value(j: int, k: int) -> Value:
            return known[j, k] if (j, k) in known else self.known[j, k]

        def form(form: Form, k: int) -> Value:
            parts = [(a, value(j, k)) for a, j in form.terms]
            return self.builder.total((form.constant if k == 0 else 0.0, 1.0), *parts)

        if row not in self.rows:
            self.rows[row] = factored(row)
        constant, linear, products = self.rows[row]
        total: Polynomial = {}
        add(total, constant if order == 0 else 0.0)
        for a, j in linear:
            add(total, a, value(j, order))
        for a, j in row.first:
            add(total, a * (order + 1), value(j, order + 1))
        for a, j in row.second:
            add(total, a * (order + 1) * (order + 2), value(j, order + 2))
        for factor, left, right in products:
            first = [form(left, k) for k in range(order + 1)]
            second = first if left is right else [form(right, k) for k in range(order + 1)]
            add(total, factor, self.builder.let(convolution(first, second, order)))
        if row.output is not None:
            add(total, -1.0, self.prescribed[row.output][order])
        return total

    def _slope(self, slope: Slope) -> Value:
        return self.builder.total(
            (slope.constant, 1.0), *((a, self.known[j, 0]) for a, j in slope.terms)
        )

    # Steps

    def _given(self, step: Step) -> None:
        ((row, order),), ((j, k),) = step.rows, step.columns
        assert row.output is not None
        self.known[j, k] = self.prescribed[row.output][order]

    def _scalar(self, step: Step) -> None:
        ((row, order),), ((j, k),) = step.rows, step.columns
        builder, name = self.builder, f"w{j}_{k}"
        slope = self.roots.get(step.block) or self._slope(step.slopes[0][0])
        rest = self._coefficient(row, order, step.columns)
        if isinstance(slope, str):
            self.blocks.setdefault(step.block, slope)
            minus = builder.let(scaled(rest, -1.0))
            self.known[j, k] = builder.product(minus, builder.call("inverse", slope), name=name)
        else:
            self.known[j, k] = builder.let(scaled(rest, -1.0 / slope), name)

    def _quadratic(self, step: Step) -> None:
        ((row, order),), ((j, k),) = step.rows, step.columns
        a = sum(factor for factor, *pair in row.quadratic if pair == [j, j])
        slope = [(factor, i) for factor, i in step.slopes[0][0].terms if i != j]
        b = self.builder.total(
            (step.slopes[0][0].constant, 1.0), *((f, self.known[i, 0]) for f, i in slope)
        )
        c = self.builder.let(self._coefficient(row, order, step.columns))
        name, determinant = f"w{j}_{k}", self.builder.fresh("d")
        self.builder.operations.append(Root(name, determinant, a, b, c, step.block))
        self.known[j, k] = name
        self.roots[step.block] = determinant
        self.blocks[step.block] = determinant

    def _linear(self, step: Step) -> None:
        right = [
            self.builder.let(scaled(self._coefficient(row, order, step.columns), -1.0))
            for row, order in step.rows
        ]
        factors = self._factored(step)
        names = tuple(f"w{j}_{k}" for j, k in step.columns)
        operations, values = factors.solve(right)
        self.builder.operations.append(
            Solve(factors.number, tuple(right), names, operations, values)
        )
        self.known |= dict(zip(step.columns, names, strict=True))

    def _newton(self, step: Step) -> None:
        builder = self.builder
        names = tuple(f"w{j}_{k}" for j, k in step.columns)
        starts: list[Value] = []
        for (j, k), name in zip(step.columns, names, strict=True):
            if k == 0:
                starts.append(f"g{len(self.newton)}")
                self.newton.append(j)
            else:
                starts.append(0.0)
            self.known[j, k] = name
        with builder.loop(names) as operations:
            right = [
                builder.let(scaled(self._coefficient(row, order), -1.0)) for row, order in step.rows
            ]
            factors = self._eliminated(step)
            if step.loose:
                self._require(step, factors)
            inner, values = factors.solve(right)
            changes = tuple(builder.fresh("x") for _ in names)
            builder.operations.append(Solve(factors.number, tuple(right), changes, inner, values))
        builder.operations.append(
            Newton(names, tuple(starts), tuple(operations), changes, step.loose)
        )
        self._factored(step)

    # Matrices

    def _factored(self, step: Step) -> Eliminated:
        """The factors of a step's matrix, which are made once; at first it must be regular."""
        matrix = self._matrix(step)
        if matrix not in self.factors:
            self.factors[matrix] = self._eliminated(step)
        factors = self.factors[matrix]
        if step.block not in self.blocks and isinstance(factors.determinant, str):
            self.blocks[step.block] = None
            self._require(step, factors)
        return factors

    def _require(self, step: Step, factors: Eliminated) -> None:
        matrix = self._reduced(step)
        self.builder.operations.append(
            Regular(step.block, factors.number, factors.determinant, matrix, step.loose)
        )

    def _eliminated(self, step: Step) -> Eliminated:
        if step.slopes not in self.pivots:
            samples = step.jacobian(self.samples)
            present = np.array([[bool(s.terms or s.constant) for s in row] for row in step.slopes])
            self.pivots[step.slopes] = choose(present, samples, step.follows)
        self.count += 1
        pivots, sure = self.pivots[step.slopes], len(step.follows)
        return Eliminated(self.builder, self.count, self._matrix(step), *pivots, sure)

    def _matrix(self, step: Step) -> Matrix:
        return tuple(tuple(self._slope(slope) for slope in row) for row in step.slopes)

    def _reduced(self, step: Step) -> Matrix:
        """As `Step.reduced`, by which the determinant is measured."""
        rows = [list(row) for row in self._matrix(step)]
        for i, j in step.follows:
            own = list(rows[i])
            for row in rows:
                share = row[j]
                if row is not rows[i] and share:
                    for k, value in enumerate(own):
                        total: Polynomial = {}
                        add(total, 1.0, row[k])
                        add(total, -1.0, share, value)
                        row[k] = self.builder.let(total)
        left = {j for _, j in step.follows}
        done = {i for i, _ in step.follows}
        return tuple(
            tuple(value for j, value in enumerate(row) if j not in left)
            for i, row in enumerate(rows)
            if i not in done
        )
