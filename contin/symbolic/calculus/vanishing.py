"""Is a formula zero for all values of its symbols? Decided by its value at pseudo-random points.

A formula that is not identically zero vanishes at three independent points with probability zero; rounding is told from
cancellation by comparing a sum with its largest term. The points depend on the symbols' names only, so results repeat.
"""

from __future__ import annotations

import math
import random
from functools import lru_cache
from typing import Final

from contin.model.evaluate import node_values
from contin.model.expression import Expression, numeric_value, symbols_in

SAMPLES: Final = 3
ROUNDING: Final = 1e-12  # a sum below this part of its largest term is zero but for rounding
_KEEPS_ZERO: Final = frozenset("sin tan asin atan sinh tanh asinh atanh expm1 log1p sqrt abs".split())


@lru_cache(maxsize=4096)
def sample_value(name: str, sample: int) -> float:
    """The value of the symbol `name` at the sample point: in (0.3, 1.7), the last sample of either sign."""
    generator = random.Random(f"{name}/{sample}")
    value = generator.uniform(0.3, 1.7)
    return -value if sample == SAMPLES - 1 and generator.random() < 0.5 else value


def vanishes(expression: Expression) -> bool:
    """True where `expression` is identically zero."""
    if expression.is_number:
        number = numeric_value(expression)
        return abs(number) < ROUNDING if isinstance(number, float) else number == 0
    names = symbols_in([expression])
    finite = 0
    for sample in range(SAMPLES):
        values = node_values([expression], {name: sample_value(name, sample) for name in names})
        if not math.isfinite(values[expression]):
            continue
        finite += 1
        if not _is_zero(expression, values):
            return False
        if not names:
            return True
    return finite > 0


def _is_zero(node: Expression, values: dict[Expression, float]) -> bool:
    if values[node] == 0.0:
        return True
    if node.op == "add":
        largest = max(abs(values[a]) for a in node.args)
        return abs(values[node]) <= ROUNDING * largest or all(_is_zero(a, values) for a in node.args)
    if node.op == "mul":
        return any(_is_zero(a, values) for a in node.args)
    if node.op == "pow":
        return values[node.args[1]] > 0 and _is_zero(node.args[0], values)
    if node.op == "if":
        return _is_zero(node.args[1] if values[node.args[0]] else node.args[2], values)
    return node.op in _KEEPS_ZERO and _is_zero(node.args[0], values)
