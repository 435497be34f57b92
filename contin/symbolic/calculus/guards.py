"""Conditions that passes add to keep a formula computable, and that are no switching of the model.

A guard chooses between two forms of one smooth function (a Taylor polynomial near a removable singularity, the limit
of b^e log b at b = 0), so its zero is no event. It is recognised by its shape alone, abs(w) < width with a width of
`WIDTHS`: numbers that nobody types. So the mark survives pickling, substitution and a YAML file.
"""

from __future__ import annotations

import math
from typing import Final

from contin.model.expression import Expression, ExpressionLike, call, compare, number, numeric_value

VANISHING: Final = math.nextafter(1e-300, 1.0)
"""Width that means "is zero"."""

_BASES: Final = (0.25, 0.375, 0.5)
WIDTHS: Final = frozenset({VANISHING} | {math.nextafter(b**k, 1.0) for b in _BASES for k in range(1, 17)})


def guard_width(base: float, exponent: int) -> float:
    """A width of `WIDTHS`, equal to base^exponent to the last digit but one; base is 1/4, 3/8 or 1/2."""
    return math.nextafter(base**exponent, 1.0)


def near_zero(quantity: ExpressionLike, width: float = VANISHING) -> Expression:
    """The guard condition abs(quantity) < width."""
    if width not in WIDTHS:
        raise ValueError(f"not a guard width: {width!r}")
    return compare("<", call("abs", quantity), number(width))


def is_guard(condition: Expression) -> bool:
    """True for a comparison made by `near_zero`."""
    if condition.op != "<":
        return False
    left, right = condition.args
    return left.op == "abs" and right.op == "number" and float(numeric_value(right)) in WIDTHS
