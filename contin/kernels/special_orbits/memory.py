"""What the kernels of special orbits share: codes, the borders that the equations are written with, and memory."""

from collections import namedtuple

import numpy as np

from contin.kernels.signature import structure

LPC, PD, NS, BPC = range(4)
FAILED, NOT_FINITE = -1, -2
TEST_COUNTS = (6, 6, 10, 5)  # test functions of each kind, see `contin.kernels.special_orbits.tests`

# gradient: address of (u, p, v, Df[v], D^2f[v, .]), forcing_gradient: of the same for the forcing period, 0 without one
# second: index of q, that of p itself where no curve is followed
Curve = namedtuple("Curve", ["kind", "gradient", "forcing_gradient", "second"])
structure(Curve, "i, i, i, i")

Borders = namedtuple(
    "Borders",
    [
        "across",  # (2,) raw (p, q) of a unit of s
        "along",  # (2,) ... of r
        "rows",  # (2, n + 2) rows on (u(0), T, s): one, for BPC two
        "jump",  # (n, 2) b or B
        "start",  # (n, 2) c or C of v(0)
    ],
)
structure(Borders, "f1, f1, f2, f2, f2")

CurveMemory = namedtuple(
    "CurveMemory",
    [
        "fq",  # (m, n, N) f by the second parameter
        "fr",  # (m, n, N) by r
        "y",  # (4, nu + 3): (u, T, s, unfolding) of the four solutions
        "v",  # (2, nu + 3): null functions; of NS of autonomous flows with their T parts
        "node",  # (5, m + 1, n, N) y and v interval by interval
        "at",  # (5, m, n, N) ... at the Gauss points
        "rate",  # (m, n, N) Df[v]
        "bend",  # (m, n, n + m_p, N) D^2f[v, .]
        "final",  # (n + 2 or n + 3, ...) LU factors of the last system
        "final_pivots",
        "null",  # (n + 1, 2 n + 2 or 2 n + 4, ...) LU factors of the system for v
        "null_pivots",
        "x",  # (2 n + 4,) a right-hand side of either
        "reduced",  # (2, 4, n + 2) reduced right-hand sides
        "small",  # (2, 2) or (3, 3)
        "small_pivots",
        "z",  # like z of a family: u, T, lengths, p
        "units",  # ones, and zeros: `fill` needs no arclength row here
        "zero",
        "jump",  # (n,)
        "border",  # (2,)
        "corner",  # (2, 2)
        "dG",  # (2, 4) derivatives along y (NS: the last by k)
        "G",  # (2,)
        "z0",  # (N,) the point that the march has come to, or the base of a correction
        "t0",  # its tangent, scaled
        "before",  # the point before
        "old",  # its tangent
        "guess",  # where the next one is sought
        "zn",  # the next one
        "tn",  # its tangent
        "drift",  # (nu,) derivative of the orbit by time
        "place",  # (3,) what tells points of a curve of folds apart
        "normal",  # (2,) of that curve
        "trivial",  # (1,) multiplier
        "others_re",  # multipliers that are neither trivial nor critical
        "others_im",
        "four",  # (4,)
        "tests",  # test functions of this kind
        "changes",  # (4, N) scaled changes of z that the rows of y stand for
        "step",  # (N,) scaled
        "combination",  # (3,)
        "null_combination",  # (3,)
        "here",  # (n,)
        "direction",  # (n + m_p,)
        "matrix",  # (n, n + m_p)
        "slope",  # (n,)
        "period",  # (1,)
        "by_all",  # (1, n + m_p)
        "section",  # (n,) row of the section that v(0) of NS lie in (autonomous flows)
        "form",  # (2, 2) of the branching equation at the last point of BPC, see `contin.kernels.special_orbits.sides`
        "lengths",  # (2,) see `contin.kernels.special_orbits.turning_off`
        "below",  # (N,) scaled: the two ends of a bracket
        "above",
    ],
)
structure(
    CurveMemory,
    "f3, f3, f2, f2, f4, f4, f3, f4, f2, i1, f2, i1, f1, f3, f2, i1, f1, f1, f1, f1, f1, f2, f2, f1, f1, f1, "
    "f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f2, f1, f1, f1, f1, f1, f2, f1, f1, f2, f1, f2, f1, f1, f1",
)


def new_curve_memory(kind, n, m, free, intervals, p_size):
    """CurveMemory for `follow_special` on one mesh; `free` multipliers are not trivial."""
    nu = (intervals * m + 1) * n
    last = n + 3 if kind == BPC else n + 2
    null = n + 1
    if kind == NS:
        null = 2 * n + (4 if free < n else 2)
    small = 2 if kind in (LPC, PD) else 3
    family = nu + intervals + 2
    size = family + small - 1
    others = max(free - (2 if kind == NS else 1), 0)
    return CurveMemory(
        np.zeros((m, n, intervals)), np.zeros((m, n, intervals)), np.zeros((4, nu + 3)), np.zeros((2, nu + 3)),
        np.zeros((5, m + 1, n, intervals)), np.zeros((5, m, n, intervals)), np.zeros((m, n, intervals)),
        np.zeros((m, n, n + p_size, intervals)), np.zeros((last, last)), np.zeros(last, np.int64),
        np.zeros((null, null)), np.zeros(null, np.int64), np.zeros(2 * n + 4), np.zeros((2, 4, n + 2)),
        np.zeros((small, small)), np.zeros(small, np.int64), np.zeros(family), np.ones(family), np.zeros(family),
        np.zeros(n), np.zeros(2), np.zeros((2, 2)), np.zeros((2, 4)), np.zeros(2), np.zeros(size), np.zeros(size),
        np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(nu), np.zeros(3),
        np.zeros(2), np.zeros(1), np.zeros(others), np.zeros(others), np.zeros(4), np.zeros(TEST_COUNTS[kind]),
        np.zeros((4, size)), np.zeros(size),
        np.zeros(3), np.zeros(3), np.zeros(n), np.zeros(n + p_size), np.zeros((n, n + p_size)), np.zeros(n),
        np.zeros(1), np.zeros((1, n + p_size)), np.zeros(n), np.zeros((2, 2)), np.zeros(2), np.zeros(size),
        np.zeros(size),
    )  # fmt: skip
