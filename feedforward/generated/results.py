"""What a program hands out: coordinates of the rig's parts, tensions, and the ropes' spans."""

from ...models.types import Array
from ..exact.losses import losses_of
from ..exact.problem import Problem
from .angles import Series, bryant
from .builder import Builder, Polynomial, add
from .program import Nearest, Value

Coefficient = tuple[int, int]
"""An unknown and the order of its Taylor coefficient."""


class Results:
    """Results from the coefficients that a program has found, as further operations."""

    def __init__(self, builder: Builder, problem: Problem, known: dict[Coefficient, Value]) -> None:
        self.builder, self.problem, self.known = builder, problem, known

    def coordinates(
        self, newton: int
    ) -> tuple[tuple[str, ...], tuple[tuple[Value, ...], ...], tuple[int, ...]]:
        """Names of the coordinates of the rig's parts, these with two derivatives, and which turn.

        Guesses of angles stand after those of Newton's unknowns.  `exact.naming.named_motion` does
        the same with numbers.
        """
        builder, rig, equations = self.builder, self.problem.rig, self.problem.equations
        columns: dict[str, tuple[Value, Value, Value]] = {}
        for i, name in enumerate(equations.names):
            columns[name] = self._derivatives([self.known[i, k] for k in range(3)])
        for t, (name, cos, sin) in enumerate(equations.turning):
            c, s = ([self.known[i, k] for k in range(3)] for i in (cos, sin))
            principal = builder.call("atan2", s[0], c[0])
            nearest = builder.fresh("q")
            builder.operations.append(Nearest(nearest, str(principal), f"g{newton + t}"))
            columns[name] = nearest, self._cross(c, s, 1, 1.0), self._cross(c, s, 2, 2.0)
        for orientation in equations.orientations:
            series: list[Series]
            if orientation.angles[0] in rig.outputs:  # exactly as prescribed
                places = [rig.outputs.index(name) for name in orientation.angles]
                series = [[f"r{k}_{place}" for k in range(3)] for place in places]
            else:
                series = bryant(
                    builder, [[self.known[i, k] for k in range(3)] for i in orientation.directors]
                )
            for name, angle in zip(orientation.angles, series, strict=True):
                columns[name] = self._derivatives(angle)
        home = rig.home_coordinates
        columns |= {name: (home[name], 0.0, 0.0) for name in rig.held}
        auxiliary = [name for i, name in enumerate(equations.names) if i not in equations.hidden]
        names = tuple(dict.fromkeys((*rig.coordinate_names, *auxiliary)))
        kinematics = tuple(tuple(columns[name][k] for name in names) for k in range(3))
        return names, kinematics, tuple(names.index(name) for name, _, _ in equations.turning)

    def _derivatives(self, series: Series) -> tuple[Value, Value, Value]:
        return series[0], series[1], self.builder.total((2.0, series[2]))

    def _cross(self, cos: Series, sin: Series, order: int, factor: float) -> Value:
        """Cos times a derivative of sin less sin times that of cos."""
        total: Polynomial = {}
        add(total, factor, cos[0], sin[order])
        add(total, -factor, sin[0], cos[order])
        return self.builder.let(total)

    def _affine(self, row: Array, divisor: float = 1.0) -> Value:
        """The value of an affine row of (q, 1)."""
        terms = [(float(a) / divisor, self.known[i, 0]) for i, a in enumerate(row[:-1])]
        return self.builder.total((float(row[-1]) / divisor, 1.0), *terms)

    def inputs(self, names: tuple[str, ...], rates: tuple[Value, ...]) -> tuple[Value, ...]:
        """Inputs with friction and the gears' losses, see `exact.losses`.

        Parameters
        ----------
        names, rates
            Of the coordinates.
        """
        problem, builder = self.problem, self.builder
        losses, rig = losses_of(problem.rig), problem.rig
        first = len(problem.equations.names) + len(problem.equations.constraint_names)
        needed = [self.known[first + a, 0] for a in range(len(rig.drives))]
        if losses is None:
            return tuple(needed)
        inputs: list[Value] = []
        for a, (value, coordinate) in enumerate(zip(needed, rig.driven_coordinates, strict=True)):
            speed = rates[names.index(coordinate)]
            way = builder.direction(speed)
            arm, lost = float(losses.arms[a]), float(losses.efficiency[a])
            dry, viscous = arm * float(losses.coulomb[a]), arm * float(losses.viscous[a])
            total = builder.total((1.0, value), (dry, way), (viscous, speed))
            if lost != 1.0:
                # efficiency^-s of s = -1, 0 or 1 as a parabola.
                s = builder.product(builder.sign(total), way)
                odd, even = 0.5 * (1.0 / lost - lost), 0.5 * (1.0 / lost + lost) - 1.0
                share = builder.total((1.0, 1.0), (odd, s), (even, builder.product(s, s)))
                total = builder.product(total, share)
            inputs.append(total)
        return tuple(inputs)

    def tensions(self) -> tuple[Value, ...]:
        """See `Equations.tensions`."""
        equations, n = self.problem.equations, len(self.problem.equations.names)
        ropes = zip(equations.rig.ropes, equations.spans, equations.span_lengths, strict=True)
        of_ropes = tuple(
            self.builder.product(
                self.known[n + spans[0], 0],
                self._affine(rows[0], rope.falls if len(spans) == 1 else 1),
            )
            for rope, spans, rows in ropes
        )
        links = zip(equations.rig.links, equations.links, strict=True)
        return of_ropes + tuple(
            self.builder.product(self.known[n + k, 0], equations.rig.link_length(link))
            for link, k in links
        )

    def spans(self) -> tuple[tuple[str, tuple[Value, ...], Value], ...]:
        """For each span its rope, its vector and its length."""
        equations = self.problem.equations
        spans = []
        for rope, lengths in zip(equations.rig.ropes, equations.span_lengths, strict=True):
            for k, (before, after) in enumerate(zip(rope.path, rope.path[1:], strict=False)):
                rows = equations.points[after] - equations.points[before]
                vector = tuple(self._affine(row) for row in rows if row.any())
                spans.append((rope.name, vector, self._affine(lengths[k])))
        return tuple(spans)
