"""Numbers, sums and names as text that Python and C read alike."""

from ...models.friction import REST
from .program import Function, Sum, Value


def number(value: float) -> str:
    """A number with all its digits."""
    return repr(float(value))


def rest_of(function: Function) -> str:
    """Magnitude up to which a sign is zero."""
    return number(REST if function == "direction" else 0.0)


def text_of(value: Value | Sum) -> str:
    """A value, or a sum with the terms of one factor taken together."""
    if isinstance(value, str):
        return value
    if not isinstance(value, Sum):
        return number(value)
    groups: dict[float, list[tuple[bool, str]]] = {}
    for factor, names in value.terms:
        groups.setdefault(abs(factor), []).append((factor < 0.0, "*".join(names)))
    parts: list[tuple[bool, str]] = []
    for factor, terms in groups.items():
        if factor == 1.0:
            parts += terms
        elif len(terms) == 1:
            ((negative, text),) = terms
            parts.append((negative, f"{number(factor)}*{text}"))
        else:
            flipped = all(negative for negative, _ in terms)
            inner = _joined([(negative != flipped, text) for negative, text in terms])
            parts.append((flipped, f"{number(factor)}*({inner})"))
    if value.constant:
        parts.append((value.constant < 0.0, number(abs(value.constant))))
    return _joined(parts)


def _joined(parts: list[tuple[bool, str]]) -> str:
    """Signed texts as a sum, one that is added first."""
    parts = sorted(parts, key=lambda part: part[0])
    (negative, first), *others = parts
    return (
        ("-" if negative else "")
        + first
        + "".join(f" {'-' if negative else '+'} {text}" for negative, text in others)
    )
