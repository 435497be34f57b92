"""Limits of families with growing period: what is exact for the leading term."""

from math import cos, exp, sin

import pytest

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
