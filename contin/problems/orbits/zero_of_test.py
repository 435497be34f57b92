"""The zero of a test function along a curve in two parameters, by secants and bisection in a bracket."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings

if TYPE_CHECKING:
    from contin.problems.contracts import Probing


FIRST: Final = 1e-6  # (scaled arclength) half-width of the first bracket
WIDENED: Final = 4.0  # ... which grows by this factor, so many times
WIDENINGS: Final = 12
STEPS: Final = 40
ACCURATE: Final = 1e-11  # (scaled arclength) width of the last bracket


@dataclass(frozen=True, eq=False)
class Zero:
    """The point at which a test is nearest to zero, and how far (scaled arclength) its zero may be from there."""

    sample: Sample
    value: float  # of the test
    error: float


def zero_of_test(problem: Probing, near: Sample, frame: Frame, index: int, first: float = FIRST) -> Zero | None:
    """The zero of test `index` next to a sample; None where it does not change its sign.

    first : half-width of the first bracket, where points are dear.

    Every third step halves the bracket. Cost: some ten points of the curve.
    """
    settings = Settings()

    def at(s: float) -> Sample | None:
        return problem.probe(near, s, near.z + frame.scale * s * near.tangent, frame, settings)

    bracket = _bracket(at, index, first)
    if bracket is None:
        return None
    (s_a, a), (s_b, b) = bracket
    f_a, f_b = float(a.tests[index]), float(b.tests[index])
    best = a if abs(f_a) < abs(f_b) else b
    slope = abs(f_b - f_a) / (s_b - s_a)
    for k in range(STEPS):
        if s_b - s_a < ACCURATE or f_a == f_b:
            break
        s = 0.5 * (s_a + s_b) if k % 3 == 2 else s_a - f_a * (s_b - s_a) / (f_b - f_a)
        middle = at(min(max(s, s_a + 0.01 * (s_b - s_a)), s_b - 0.01 * (s_b - s_a)))
        if middle is None:
            break
        s, f = float((middle.z - near.z) / frame.scale @ near.tangent), float(middle.tests[index])
        if abs(f) < abs(float(best.tests[index])):
            best = middle
        if f == 0.0:
            break
        if f * f_a > 0.0:
            s_a, f_a = s, f
        else:
            s_b, f_b = s, f
    value = abs(float(best.tests[index]))
    return Zero(best, value, ACCURATE + (value / slope if slope > 0.0 else s_b - s_a))


def _bracket(
    at: Callable[[float], Sample | None], index: int, width: float
) -> tuple[tuple[float, Sample], tuple[float, Sample]] | None:
    """(arclength, point) on both sides of the change of sign."""
    for _ in range(WIDENINGS):
        a, b = at(-width), at(width)
        if a is not None and b is not None and a.tests[index] * b.tests[index] <= 0.0:
            return (-width, a), (width, b)
        width *= WIDENED
    return None
