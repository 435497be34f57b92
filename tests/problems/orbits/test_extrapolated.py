"""Limits of families with growing period: what is exact for the leading term."""

from math import cos, exp, sin

import pytest

from contin.problems.orbits.ends.agreement import error_of_limit
from contin.problems.orbits.ends.extrapolated import extrapolated


@pytest.mark.parametrize("gained", [0.1, 0.9, 2.0, 7.0])
@pytest.mark.parametrize("visits", [1, 2])
def test_a_spiral_is_extrapolated_exactly(gained, visits):
    """p - p* = exp(-k t) (a cos q t + b sin q t) k = r/v for v visits of a saddle with eigenvalues r +- i w."""
    r, w, a, b = 0.25, 0.63, 3e-5, -7e-5
    k, q = r / visits, w / visits

    def p(t):
        return exp(-k * t) * (a * cos(q * t) + b * sin(q * t))

    def slope(t):
        return exp(-k * t) * ((q * b - k * a) * cos(q * t) - (q * a + k * b) * sin(q * t))

    limit = extrapolated([complex(r, w)], [visits], [slope(0.0), slope(-gained)], gained, p(0.0) - p(-gained))
    assert limit.step == pytest.approx(-a, rel=1e-10)
    assert limit.drift < 1e-10 * abs(a)
    assert limit.spiral
    off = extrapolated([complex(r, w)], [visits], [slope(0.0), slope(-gained)], gained, 1.1 * (p(0.0) - p(-gained)))
    assert off.drift == pytest.approx(0.1 * abs(p(0.0) - p(-gained)), rel=1e-6)


@pytest.mark.parametrize("gained", [0.5, 1.8, 6.0])
@pytest.mark.parametrize("phase", [None, 0.0, 0.8, 1.6, 2.9])
def test_terms_of_second_order_are_in_the_doubt_of_a_spiral(gained, phase):
    """exp(-2 k t), alone and turning at twice the angle, with the rates of AUTO's demo tfc: the slopes of two orbits
    near each other fit it, and they agree to a ten-thousandth of what they are off by."""
    k, q, turning = 0.048, 0.0743, 0.0 if phase is None else 2 * 0.0743

    def p(t):
        return 2e-4 * exp(-k * t) * cos(q * t + 1) + 1e-5 * exp(-2 * k * t) * cos(turning * t + (phase or 0))

    def slope(t):
        h = 1e-3
        return (8 * (p(t + h) - p(t - h)) - (p(t + 2 * h) - p(t - 2 * h))) / (12 * h)

    slopes, moved = [slope(0.0), slope(-gained)], p(0.0) - p(-gained)
    limit = extrapolated([complex(k, q)], [1], slopes, gained, moved)
    off = abs(p(0.0) + limit.step)
    assert 1e-8 < off < 2 * limit.doubt < 1e-2
    error = error_of_limit(limit, moved, gained, growth=0.0, width=1.0, failed=False, first=True)
    assert error is None or error > off
