"""Whether another curve of special orbits crosses between two points, as the determinant's sign says."""

import math

from contin.kernels.compile import kernel
from contin.kernels.special_orbits.memory import BPC


@kernel("CurveMemory")
def keep_form(o):
    """o.form = the quadratic form of the branching equation in the plane of the null functions y[2], y[3]."""
    for i in range(2):
        for j in range(2):
            o.form[i, j] = o.dG[i, 2 + j]


@kernel("f2, f2, i -> f")
def mixed_ratio(form, dG, first):
    """The mixed coefficient of the branching equation of `form` (2, 2) over that of the columns of dG from `first` on.

    The equation is x (k s + c x + ...) on forced branch points: the forms have the direction of s in common, in which
    they vanish, and k is what they take there with another one. Like the determinant, which is k (grad g x tangent), k
    changes its sign on the other half of a hyperbola g = 0, as well as where the curve is tangent to s.
    """
    a, b, c = form[0, 0], 0.5 * (form[0, 1] + form[1, 0]), form[1, 1]
    d, k, g = dG[0, first], 0.5 * (dG[0, first + 1] + dG[1, first]), dG[1, first + 1]
    square = b * b - a * c
    if not square > 0.0:
        return 1.0
    large = -b - math.sqrt(square) if b >= 0.0 else -b + math.sqrt(square)
    least, ratio = math.inf, 1.0
    for i in range(2):  # a u^2 + 2 b u v + c v^2 = 0
        u, v = (large, a) if i == 0 else (c, large)
        value = abs(d * u * u + 2.0 * k * u * v + g * v * v) / (u * u + v * v)
        after = (k * u + g * v) * u - (d * u + k * v) * v
        if value < least and after != 0.0:
            least = value
            ratio = ((b * u + c * v) * u - (a * u + b * v) * v) / after
    return ratio


@kernel("i, f, f, CurveMemory -> f")
def relative(kind, before, here, o):
    """The determinant `here` over that `before`, the forms' mixed coefficients left out of those of BPC.

    Negative where it has changed its sign between the two.
    """
    return here / before * mixed_ratio(o.form, o.dG, 2) if kind == BPC else here / before
