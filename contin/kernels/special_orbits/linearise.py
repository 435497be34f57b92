"""The equations of special orbits at a point: solutions y, null functions v, G and its derivatives dG."""

import math

from contin.kernels.collocation import evaluate, residual
from contin.kernels.collocation_system import reduce_right
from contin.kernels.compile import call4, call5, kernel
from contin.kernels.condensation import condense
from contin.kernels.dense import lu_solve
from contin.kernels.filling import fill
from contin.kernels.special_orbits.columns import (
    right_side,
    second_column,
    second_derivatives,
    slope_right,
    spread,
    turn,
)
from contin.kernels.special_orbits.memory import BPC, FAILED, LPC, NOT_FINITE, NS, PD
from contin.kernels.special_orbits.null_vectors import final_factors, finish, null_functions
from contin.kernels.stages import weigh


@kernel("Equations, Curve, Points, Factors, Borders, CurveMemory, f1, f, f -> i")
def linearise(e, c, w, s, f, o, sizes, q, extra):
    """The solutions y, G and dG at o.z with second parameter q and the further unknown; 0, FAILED or NOT_FINITE."""
    w.p[c.second] = q
    if not evaluate(e, w, o.z, True):
        return NOT_FINITE
    second_column(e, c, w, o.z, o.fq)
    turn(f.across, f.along, w.fp, o.fq, o.fr)
    residual(e, w, o.z, s.right_local, o.jump, o.border)
    weigh(s.stages.weights, e.n, sizes)
    if fill(e, w, o.z, o.zero, o.units, s, o.corner) == 0 or condense(s, e.n, e.m) == 0:
        return FAILED
    if c.kind == NS and e.forcing == 0:
        across_flow(e, w, o, sizes)
    by_r = period_row(e, c, w, f, o)
    if not final_factors(e, c, w, s, f, o):
        return FAILED
    solutions(e, c, w, s, f, o, extra, by_r)
    if c.kind in (PD, NS):
        if not null_functions(e, c, s, f, o, extra):
            return FAILED
    elif c.kind == LPC:
        o.G[0] = o.y[2, o.y.shape[1] - 2]
    else:
        o.G[0] = o.y[2, o.y.shape[1] - 1]
        o.G[1] = o.y[3, o.y.shape[1] - 1]
    reduce_slopes(e, c, w, s, f, o)
    slopes(e, c, s, o)
    return 0


@kernel("Equations, Points, CurveMemory, f1")
def across_flow(e, w, o, sizes):
    """o.section: row that is zero across the flow at u(0), in the metric of the states. Needs `evaluate`."""
    here, section = o.here, o.section
    total = 0.0
    for k in range(e.n):
        here[k] = o.z[k]
    call4(e.jacobian, here, w.p, w.F, w.J)
    for k in range(e.n):
        section[k] = w.F[k] / sizes[k]
        total += section[k] * section[k]
    for k in range(e.n):
        section[k] /= sizes[k] * math.sqrt(total)


@kernel("Equations, Curve, Points, Borders, CurveMemory, f -> (f, f)")
def second_derivatives_of_period(e, c, w, f, o, by_s):
    """D^2 of the forcing period along s and by p, and by q; 0 without forcing."""
    if e.forcing == 0 or by_s == 0.0:
        return 0.0, 0.0
    direction, p, q = o.direction, e.n + e.active, e.n + c.second
    for j in range(direction.size):
        direction[j] = 0.0
    direction[p] = by_s * f.across[0]
    direction[q] += by_s * f.across[1]
    call5(c.forcing_gradient, w.F, w.p, direction, o.slope, o.matrix)
    return e.multiple * o.matrix[0, p], e.multiple * o.matrix[0, q]


@kernel("Equations, Curve, Points, Borders, CurveMemory -> f")
def period_row(e, c, w, f, o):
    """o.corner: coefficients of T and s in the forcing period's row (autonomous: 0); returns minus that of r."""
    corner, by_all = o.corner, o.by_all
    by_r = 0.0
    corner[0, 0] = 0.0
    corner[0, 1] = 0.0
    if e.forcing != 0:
        call4(e.forcing, w.F, w.p, o.period, by_all)
        by_p = e.multiple * by_all[0, e.n + e.active]
        by_q = e.multiple * by_all[0, e.n + c.second]
        corner[0, 0] = 1.0
        corner[0, 1] = -(f.across[0] * by_p + f.across[1] * by_q)
        by_r = f.along[0] * by_p + f.along[1] * by_q
    return by_r


@kernel("Equations, Curve, Points, Factors, Borders, CurveMemory, f, f")
def solutions(e, c, w, s, f, o, extra, by_r):
    """o.y: F_(u, T, s) y = (-F, -F_r, 0, 0), the border rows 0 but 1 for the null vectors."""
    n, m, x, jump = e.n, e.m, o.x, o.jump
    if c.kind == BPC:
        for k in range(n):
            jump[k] -= extra * f.jump[k, 0]
    for j in range(4 if c.kind == BPC else 3):
        border = o.border[0]
        if j > 0:
            border = by_r if j == 1 else 0.0
            for k in range(n):
                jump[k] = 0.0
        if j == 1:
            slope_right(o.fr, w.h, o.z[o.y.shape[1] - 3], s.right_local)
        if j < 2:
            reduce_right(s, n, m)
        x[n + 1] = 1.0 if j == 2 else 0.0
        x[n + 2] = 1.0 if j == 3 else 0.0
        finish(s, n, m, f, o, border, j < 2, j)


@kernel("Equations, Curve, Points, Factors, Borders, CurveMemory")
def reduce_slopes(e, c, w, s, f, o):
    """o.reduced: -D^2F[v, y] for all v and y, condensed. NS: the last column belongs to k."""
    n, m, y, v = e.n, e.m, o.y, o.v
    nu = y.shape[1] - 3
    count = 4 if c.kind == BPC else 3
    for j in range(count):
        spread(y, j, n, m, o.node, o.at, e.values, j)
    for a in range(1 if c.kind in (LPC, PD) else 2):
        which = 2 + a
        by_period = 0.0
        by_s = 0.0
        if c.kind in (LPC, BPC):
            by_period = y[which, nu]
            by_s = y[which, nu + 1]
        else:
            which = o.at.shape[0] - 1
            spread(v, a, n, m, o.node, o.at, e.values, which)
            by_period = v[a, nu] if c.kind == NS and e.forcing == 0 else 0.0
        second_derivatives(e, c, w, f, o, which, by_period, by_s)
        period_by_p, period_by_q = second_derivatives_of_period(e, c, w, f, o, by_s)
        for j in range(count):
            y_s = y[j, nu + 1]
            y_r = 1.0 if j == 1 else 0.0
            y_p = f.across[0] * y_s + f.along[0] * y_r
            y_q = f.across[1] * y_s + f.along[1] * y_r
            right_side(e, c, w, o, j, o.z[nu], by_period, y[j, nu], y_p, y_q, y_s, y_r, s.right_local)
            reduce_right(s, n, m)
            for r in range(n + 2):
                o.reduced[a, j, r] = s.right_last[r]
            o.reduced[a, j, n] += period_by_p * y_p + period_by_q * y_q
    if c.kind == NS:
        for r in range(n):
            o.reduced[0, 3, r] = 0.0
            o.reduced[1, 3, r] = 0.0
            for j in range(n):  # v(1) is the second function at 0
                o.reduced[1, 3, r] -= 2.0 * s.end[r, n + j] * v[1, j]


@kernel("Equations, Curve, Factors, CurveMemory")
def slopes(e, c, s, o):
    """o.dG from o.reduced."""
    n, x, dG = e.n, o.x, o.dG
    passes = 1 if c.kind in (LPC, PD) else 2
    for j in range(3 if c.kind in (LPC, PD) else 4):
        if c.kind in (LPC, BPC):
            for a in range(passes):
                for r in range(n + 1):
                    x[r] = o.reduced[a, j, r]
                x[n + 1] = 0.0
                x[n + 2] = 0.0
                lu_solve(o.final, o.final_pivots, x)
                dG[a, j] = x[n + 1] if c.kind == LPC else x[n + 2]
        else:
            for r in range(o.null.shape[0]):
                x[r] = 0.0
            for a in range(passes):
                for r in range(n):
                    x[a * n + r] = o.reduced[a, j, r]
            lu_solve(o.null, o.null_pivots, x)
            for a in range(passes):
                dG[a, j] = x[passes * n + a]
