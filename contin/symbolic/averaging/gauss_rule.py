"""Averages without a closed form as fixed Gauss rules, written out as formulas.

The nodes are constants (or fixed fractions of an arc), so derivatives of any order are exact derivatives of the rule.
Functions without conditions use equidistant nodes, which for periodic smooth functions converge like Gauss rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.errors import InputError
from contin.machine import elementary
from contin.model.expression import (
    Expression,
    add,
    call,
    mul,
    number,
    numeric_value,
    power,
    split_coefficient,
    sub,
    substitute,
    symbol,
)
from contin.symbolic.averaging.cells import RADIUS, Arc, Cut
from contin.symbolic.averaging.switching_lines import X, Y
from contin.symbolic.calculus.sampling import sample
from contin.symbolic.calculus.sympy_bridge import from_sympy

Array = NDArray[np.float64]
ACCURACY: Final = 1e-11  # relative to the function's size on the turn: less is not the average any more
TOLERANCE: Final = 1e-13  # between one rule and the rule with twice the nodes, relative to the largest value
SIZES: Final = (6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)
"""Nodes on an arc; a full turn takes twice as many."""


def rule_size(integrands: Callable[[int], Array], size_of: float = 0.0) -> int:
    """The smallest size whose values agree with those of the next two sizes.

    `integrands(n)` gives the values of the rule with n nodes at sample amplitudes; `size_of` is the size of the
    function, which counts where its averages vanish. Raises `InputError` where the largest size is not enough.
    """
    values = {}
    for n, finer in pairwise(SIZES):
        for size in (n, finer):
            if size not in values:
                values[size] = integrands(size)
        scale = max(float(np.max(np.abs(values[finer]))), size_of, 1e-300)
        if float(np.max(np.abs(values[n] - values[finer]))) <= TOLERANCE * scale:
            return n
    raise InputError(
        f"averaging: a quadrature with {SIZES[-1]} nodes does not reach a relative accuracy of {TOLERANCE:g}; "
        "the function changes too fast over one oscillation (is there a kink that no condition shows?)"
    )


def gauss(n: int) -> tuple[Array, Array]:
    """Nodes and weights on (-1, 1)."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return nodes, weights


def next_size(n: int) -> int:
    """The size of the rule that checks the one of this size."""
    return SIZES[SIZES.index(n) + 1]


def agreement(rule: Sequence[Expression], finer: Sequence[Expression], square: Expression) -> Expression:
    """ACCURACY * size - |rule - finer|, of rules for averages of a function with this mean square.

    Relative to the size of the function, not of its averages, which vanish at some amplitudes.
    """
    gap = add(*(call("abs", sub(one, two)) for one, two in zip(rule, finer, strict=True)))
    return sub(mul(number(ACCURACY), call("sqrt", square)), gap)


def beyond_quadrature(nodes: int) -> str:
    """What to say where the agreement is negative."""
    return (
        f"the average by quadrature with {nodes} nodes is not accurate any more (to {ACCURACY:g}, against one with "
        "more nodes): average with a larger reach, the amplitude up to which quadratures are checked (average: "
        "{reach: 50}), or declare the ranges of the parameters, over which they are checked too"
    )


def turn_rule(
    function: Expression, omega: Expression, radius: Expression, n: int, odd: bool = False
) -> tuple[Expression, Expression, Expression]:
    """Averages of f sin(phi), f cos(phi) and f^2 over a turn by 2n equidistant nodes.

    f has no conditions on x and y.

    For an odd f, f(-x, -y) = -f(x, y), half of the nodes do.
    """
    # the same doubles in all quadrants, so that equal values of f are one node; n is even
    cosines = [cosine_of_node(k, n) for k in range(2 * n)]
    sines = [cosine_of_node((k - n // 2) % (2 * n), n) for k in range(2 * n)]
    count = n if odd else 2 * n
    weight = 1 / count
    with_sin, with_cos, squares = [], [], []
    for c, s in zip(cosines[:count], sines[:count], strict=True):
        value = at_state(function, mul(number(c), radius), mul(number(-s), omega, radius))
        with_sin.append(mul(number(weight * s), value))
        with_cos.append(mul(number(weight * c), value))
        squares.append(mul(number(weight), power(value, number(2))))
    return _sum(with_sin), _sum(with_cos), add(*squares)


def cosine_of_node(k: int, n: int) -> float:
    """cos((2k + 1) pi/(2n)) with all its digits, also next to a quarter turn."""
    if k >= n:
        return cosine_of_node(2 * n - 1 - k, n)
    return elementary.sin((n - 2 * k - 1) * math.pi / (2 * n))


def _sum(terms: list[Expression]) -> Expression:
    """The sum; terms that only rounding keeps from cancelling are dropped."""
    total = add(*terms)
    if total.op != "add":
        return total

    kept = [t for t in total.args if abs(float(numeric_value(number(split_coefficient(t)[0])))) > 1e-15]
    return add(*kept) if kept else number(0)


def arc_rule(
    arcs: Sequence[Arc], omega: Expression, radius: Expression, n: int, fold: int = 1
) -> tuple[Expression, Expression, Expression]:
    """Averages of f sin(phi), f cos(phi) and f^2 over a turn by n Gauss nodes on every arc; f is 0 outside the arcs.

    `fold` = 2 where the arcs are one half of the turn of an odd function.
    """
    with_sin, with_cos, squares = [], [], []
    nodes, weights = gauss(n)
    for arc in arcs:
        if arc.start.exact and arc.stop.exact:
            middle, half = 0.5 * (arc.stop.number + arc.start.number), 0.5 * (arc.stop.number - arc.start.number)
            for xi, w in zip(nodes, weights, strict=True):
                phi = middle + half * xi
                c, s = elementary.cos(phi), elementary.sin(phi)
                value = at_state(arc.formula, mul(number(c), radius), mul(number(-s), omega, radius))
                factor = float(fold * w * half / (2 * math.pi))
                with_sin.append(mul(number(factor * s), value))
                with_cos.append(mul(number(factor * c), value))
                squares.append(mul(number(factor), power(value, number(2))))
            continue
        start, stop = (angle_of(cut, radius) for cut in (arc.start, arc.stop))
        centre, spread = mul(number(0.5), add(start, stop)), mul(number(0.5), stop - start)
        for xi, w in zip(nodes, weights, strict=True):
            angle = add(centre, mul(number(float(xi)), spread))
            cos, sin = call("cos", angle), call("sin", angle)
            value = at_state(arc.formula, mul(radius, cos), mul(number(-1), omega, radius, sin))
            with_sin.append(mul(number(float(fold * w / (2 * math.pi))), spread, value, sin))
            with_cos.append(mul(number(float(fold * w / (2 * math.pi))), spread, value, cos))
            squares.append(mul(number(float(fold * w / (2 * math.pi))), spread, power(value, number(2))))
    return add(*with_sin), add(*with_cos), add(*squares)


def angle_of(cut: Cut, radius: Expression) -> Expression:
    """The angle of a cut as a formula."""
    return substitute([from_sympy(cut.phi)], {symbol(RADIUS): radius})[0]


def at_state(function: Expression, x: Expression, y: Expression) -> Expression:
    """The function of `switching_lines.X` and `.Y` at a state."""
    return substitute([function], {symbol(X): x, symbol(Y): y})[0]


def sampled_averages(formulas: tuple[Expression, Expression], radii: Array, values: Mapping[str, float]) -> Array:
    """Two formulas in r at several amplitudes, (2, k)."""
    return np.array(sample(formulas, {**values, RADIUS: radii}))
