"""A Taylor polynomial of a quotient about w = 0, and the guard within which it stands for the quotient.

How near "near" is follows from rounding: outside the guard the quotient is computed as written, and its third
derivative has the error eps/w^(v + 3) for a denominator of order w^v; so the guard is |w| < 1/4 for simple zeros and
wider for higher ones, and the polynomial gets the degree that this needs. Both are measured in a w that is scaled so
that no singularity of the functions involved is nearer than 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from contin.machine import elementary
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, as_expression, logical, mul, power, symbols_in
from contin.symbolic.calculus.centres import LOCAL
from contin.symbolic.calculus.guards import guard_width, near_zero
from contin.symbolic.calculus.polynomials import LARGEST_DEGREE, polynomial
from contin.symbolic.calculus.scales import Scale, nearest_scales
from contin.symbolic.calculus.series import expand
from contin.symbolic.calculus.series_arithmetic import Coefficient, is_zero
from contin.symbolic.calculus.vanishing import SAMPLES, sample_value

ACCURACY: Final = 1e-12  # of the third derivative at the edge of the guard
RADII: Final = (0.25, 0.375, 0.5)  # guard for denominators of order 1, 2, and more
FIRST_TRIAL: Final = 14
VERIFIED: Final = 1e-8  # largest difference between polynomial and quotient just inside the guard


def taylor_near_zero(local: Expression, w: Expression) -> tuple[Expression, Expression] | None:
    """(guard condition, polynomial in w) for a formula in the local variable, or None where it has a pole.

    Raises `NotAnalyticError` where it has no Laurent series.
    """
    series = expand(local, LOCAL, FIRST_TRIAL)
    if series.end <= 0 or not all(is_zero(series.at(k)) for k in range(series.start, 0)):
        return None
    order = -min(series.start, -1)
    lost = order if local.op == "mul" else order + 2  # in a sum, whole poles cancel
    radius = RADII[min(lost, len(RADII)) - 1]
    scales = nearest_scales(local)
    if not scales:
        return None
    while True:
        coefficients = [series.at(k) for k in range(series.end)]
        degree = _sufficient_degree(coefficients, scales, radius)
        if degree is None or degree > LARGEST_DEGREE:
            return None
        if degree < series.end:
            break
        series = expand(local, LOCAL, degree + 2 * order + 2)
    kept = coefficients[: degree + 1]
    if not _agrees(local, kept, scales, radius):
        return None
    guards = [near_zero(mul(s.factor, power(w, s.exponent)), guard_width(radius, s.exponent)) for s in scales]
    return logical("and", *guards), polynomial(kept, w, 0)


def _sampled(coefficients: Sequence[Coefficient], scales: Sequence[Scale]) -> list[tuple[float, list[float]]]:
    """At sample points of the other symbols: (unit of w in which the nearest singularity is at 1, the coefficients)."""
    formulas = [as_expression(c) for c in [*coefficients, *(s.factor for s in scales)]]
    names = symbols_in(formulas)
    samples = []
    for sample in range(SAMPLES if names else 1):
        values = evaluate_all(formulas, {name: sample_value(name, sample) for name in names})
        sizes = values[len(coefficients) :]
        largest = max(elementary.pow(abs(v), 1.0 / s.exponent) for v, s in zip(sizes, scales, strict=True))
        if largest > 0.0 and all(math.isfinite(v) for v in values):
            samples.append((1.0 / largest, values[: len(coefficients)]))
    return samples


def _sufficient_degree(coefficients: Sequence[Coefficient], scales: Sequence[Scale], radius: float) -> int | None:
    """Degree at which the remainder's third derivative is below `ACCURACY` (of the largest low derivative)."""
    degrees = []
    for unit, values in _sampled(coefficients, scales):
        scaled = [abs(c) * elementary.pow(unit, k) for k, c in enumerate(values)]
        natural = max([*scaled[:4], *(c * k**3 * elementary.pow(radius, k - 3) for k, c in enumerate(scaled) if k > 3)])
        largest = max(scaled)
        if largest == 0.0:
            continue
        growth = [elementary.pow(largest / c, 1.0 / k) for k, c in enumerate(scaled) if k >= 4 and c > 0.0]
        distance = min([*growth, 6.0]) if growth else 1.0
        if distance < 0.8 or natural == 0.0:
            return None
        k = 4
        while largest * k**3 * elementary.pow(radius, k - 3) / elementary.pow(distance, k) > ACCURACY * natural:
            k += 1
        degrees.append(k - 1)
    return max(degrees) if degrees else None


def _agrees(local: Expression, coefficients: Sequence[Coefficient], scales: Sequence[Scale], radius: float) -> bool:
    """Polynomial and quotient have the same values just inside the guard, on both sides."""
    names = [name for name in symbols_in([local]) if name != LOCAL]
    compared = 0
    for sample, (unit, values) in enumerate(_sampled(coefficients, scales)):
        env = {name: sample_value(name, sample) for name in names}
        for x in (0.9 * radius * unit, -0.9 * radius * unit):
            (exact,) = evaluate_all([local], {**env, LOCAL: x})
            if not math.isfinite(exact):
                continue
            compared += 1
            terms = [c * elementary.pow(x, k) for k, c in enumerate(values)]
            if abs(sum(terms) - exact) > VERIFIED * max(abs(t) for t in terms):
                return False
    return compared > 0
