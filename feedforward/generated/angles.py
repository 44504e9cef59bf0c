"""Taylor series of angles in a program: see `series.rotation` for the same on numbers."""

from .builder import Builder, Polynomial, add, convolution, scaled, series_product
from .program import Value

Series = list[Value]


def sine_cosine(builder: Builder, angle: Series) -> tuple[Series, Series]:
    """Series of sine and cosine."""
    sin: Series = [builder.call("sin", angle[0])]
    cos: Series = [builder.call("cos", angle[0])]
    rate = [builder.total((float(i), angle[i])) for i in range(1, len(angle))]
    for k in range(1, len(angle)):
        # From sin' = cos angle' and cos' = -sin angle'.
        upward, downward = convolution(rate, cos, k - 1), convolution(rate, sin, k - 1)
        sin.append(builder.let(scaled(upward, 1.0 / k)))
        cos.append(builder.let(scaled(downward, -1.0 / k)))
    return sin, cos


def directors(builder: Builder, angles: list[Series]) -> list[Series]:
    """The columns of Rx(alpha) Ry(beta) Rz(gamma), component by component (Y 6.56)."""

    def times(left: Series, right: Series, sign: float = 1.0) -> Series:
        return series_product(builder, left, right, sign)

    def plus(*series: Series) -> Series:
        return [builder.total(*((1.0, v) for v in values)) for values in zip(*series, strict=True)]

    (sa, ca), (sb, cb), (sc, cc) = (sine_cosine(builder, angle) for angle in angles)
    sa_sb, ca_sb = times(sa, sb), times(ca, sb)
    first = [times(cb, cc), plus(times(ca, sc), times(sa_sb, cc))]
    first.append(plus(times(sa, sc), times(ca_sb, cc, -1.0)))
    second = [times(cb, sc, -1.0), plus(times(ca, cc), times(sa_sb, sc, -1.0))]
    second.append(plus(times(sa, cc), times(ca_sb, sc)))
    return [*first, *second, sb, times(sa, cb, -1.0), times(ca, cb)]


def arctangent(builder: Builder, y: Series, x: Series) -> Series:
    """Series of the angle of the point (x, y)."""
    angle: Series = [builder.call("atan2", y[0], x[0])]
    square = _square(builder, x, y)
    inverse = builder.call("inverse", square[0])
    for k in range(1, len(x)):
        # From (x^2 + y^2) angle' = x y' - y x'.
        right: Polynomial = {}
        for i in range(1, k + 1):
            add(right, float(i), x[k - i], y[i])
            add(right, -float(i), y[k - i], x[i])
        for i in range(1, k):
            add(right, -float(i), angle[i], square[k - i])
        angle.append(builder.product(builder.let(scaled(right, 1.0 / k)), inverse))
    return angle


def bryant(builder: Builder, columns: list[Series]) -> list[Series]:
    """Bryant angles of a platform's nine directors, two derivatives."""
    (a, _, _, d, _, _, g, h, i) = (series[:3] for series in columns)
    minus = [[builder.total((-1.0, v)) for v in series] for series in (h, d)]
    square = _square(builder, a, d)
    root: Series = [builder.call("sqrt", square[0])]
    inverse = builder.call("inverse", builder.total((2.0, root[0])))
    for k in range(1, 3):
        rest: Polynomial = {}
        add(rest, 1.0, square[k])
        for m in range(1, k):
            add(rest, -1.0, root[m], root[k - m])
        root.append(builder.product(builder.let(rest), inverse))
    return [
        arctangent(builder, minus[0], i),
        arctangent(builder, g, root),
        arctangent(builder, minus[1], a),
    ]


def _square(builder: Builder, x: Series, y: Series) -> Series:
    """Series of x^2 + y^2."""
    square: Series = []
    for k in range(len(x)):
        polynomial: Polynomial = {}
        for i in range(k + 1):
            add(polynomial, 1.0, x[i], x[k - i])
            add(polynomial, 1.0, y[i], y[k - i])
        square.append(builder.let(polynomial))
    return square
