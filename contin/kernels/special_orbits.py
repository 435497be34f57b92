"""Special orbits in two parameters: Newton on an orbit's equations with a bordered scalar, in one kernel call.

F(u, T, p, q) = 0 is the boundary-value problem of `contin.kernels.collocation`; q is a second parameter. With (s, r)
coordinates of the parameters' plane, (p, q) = s `across` + r `along`, and G(u, T, s, r) = 0 that a matrix is singular:

    LPC   [F_u F_T]                                        V, G from  [F_u F_T F_s; c] [V; G] = [0; 1]
    PD    variational equation, v(1) = -v(0)               v, G from  v(1) + v(0) = b G, c v(0) = 1
    NS    ... over two periods, v(2) - 2 k v(1) + v(0)     v, G (2)   v(2) - 2 k v(1) + v(0) = B G, C v(0) = e_1
    BPC   [F_u F_T F_s], u(1) - u(0) + b (unfolding)       V, G (2)   rows c for two null vectors

k = cos(angle) of a torus and the unfolding of branch points are unknowns too. Everything comes from one condensation of
the intervals: solutions y of F_(u, T, s) y = (-F, -F_r, 0) and V; dG y from the same factors with right-hand side
-D^2F[V, y], which needs D^2f[v, .] once at each Gauss point; Newton's step and the tangent are combinations of the y in
two or three dimensions. So no unknown is a null vector, and a step costs about twice one of the family.

Layout of z: u at the nodes, T, lengths of the intervals, [k or unfolding], q, p.
"""

import math
from collections import namedtuple

import numpy as np

from contin.kernels.collocation import LANES, evaluate, fill, residual, set_phase
from contin.kernels.collocation_dense import condense_dense
from contin.kernels.collocation_march import floquet
from contin.kernels.collocation_system import _condense, clear_right, expand, reduce_right
from contin.kernels.compile import call4, call5, kernel, part, vector_kernel
from contin.kernels.dense import lu_factor, lu_solve

LPC, PD, NS, BPC = range(4)
ITERATIONS = 8
STAGNATION = 1e-7
FAILED, NOT_FINITE = -1, -2

Curve = namedtuple("Curve", ["kind", "gradient", "second"])  # gradient: address of (u, p, v, Df[v], D^2f[v, .])

Frame = namedtuple(
    "Frame",
    [
        "across",  # (2,) raw (p, q) of a unit of s
        "along",  # (2,) ... of r
        "rows",  # (2, n + 2) rows on (u(0), T, s): one, for BPC two
        "jump",  # (n, 2) b or B
        "start",  # (n, 2) c or C of v(0)
    ],
)

Memory = namedtuple(
    "Memory",
    [
        "fq",  # (m, n, N) f by the second parameter
        "fr",  # (m, n, N) by r
        "y",  # (4, nu + 3): (u, T, s, unfolding) of the four solutions
        "v",  # (2, nu + 3): null functions
        "node",  # (5, m + 1, n, N) y and v interval by interval
        "at",  # (5, m, n, N) ... at the Gauss points
        "rate",  # (m, n, N) Df[v]
        "bend",  # (m, n, n + m_p, N) D^2f[v, .]
        "final",  # (n + 2 or n + 3, ...) LU factors of the last system
        "final_pivots",
        "null",  # (n + 1 or 2 n + 2, ...) LU factors of the system for v
        "null_pivots",
        "x",  # (2 n + 3,) a right-hand side of either
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
        "combination",  # (3,)
        "null_combination",  # (3,)
        "here",  # (n,)
        "direction",  # (n + m_p,)
        "matrix",  # (n, n + m_p)
        "slope",  # (n,)
        "period",  # (1,)
        "by_all",  # (1, n + m_p)
    ],
)


def new_curve_memory(kind, n, m, intervals, p_size):
    """Memory for `correct_special` on one mesh."""
    nu = (intervals * m + 1) * n
    last = n + 3 if kind == BPC else n + 2
    null = 2 * n + 2 if kind == NS else n + 1
    small = 2 if kind in (LPC, PD) else 3
    return Memory(
        np.zeros((m, n, intervals)), np.zeros((m, n, intervals)), np.zeros((4, nu + 3)), np.zeros((2, nu + 3)),
        np.zeros((5, m + 1, n, intervals)), np.zeros((5, m, n, intervals)), np.zeros((m, n, intervals)),
        np.zeros((m, n, n + p_size, intervals)), np.zeros((last, last)), np.zeros(last, np.int64),
        np.zeros((null, null)), np.zeros(null, np.int64), np.zeros(2 * n + 3), np.zeros((2, 4, n + 2)),
        np.zeros((small, small)), np.zeros(small, np.int64), np.zeros(nu + intervals + 2),
        np.ones(nu + intervals + 2), np.zeros(nu + intervals + 2), np.zeros(n), np.zeros(2), np.zeros((2, 2)),
        np.zeros((2, 4)), np.zeros(2), np.zeros(3), np.zeros(3), np.zeros(n), np.zeros(n + p_size),
        np.zeros((n, n + p_size)), np.zeros(n), np.zeros(1), np.zeros((1, n + p_size)),
    )  # fmt: skip


@kernel
def _second_column(e, c, w, z, fq):
    """fq at the Gauss points. Needs `evaluate`."""
    n, m = e.n, e.m
    w_at, w_p, w_F, w_J = w.at, w.p, w.F, w.J
    address, forcing, gauss, column = e.jacobian, e.forcing, e.gauss, n + c.second
    intervals = fq.shape[2]
    nodes = (intervals * m + 1) * n
    here = np.empty(n)
    start = 0.0
    for i in range(intervals):
        for g in range(m):
            for k in range(n):
                here[k] = w_at[g, k, i]
            if forcing != 0:
                w_p[w_p.size - 1] = z[nodes] * (start + w.h[i] * gauss[g])
            call4(address, here, w_p, w_F, w_J)
            for k in range(n):
                fq[g, k, i] = w_J[k, column]
        start += w.h[i]


@vector_kernel
def _turn(across, along, fp, fq, fr):
    """fp, fq -> by s (in place of fp) and by r."""
    m, n, intervals = fp.shape
    for g in range(m):
        for k in range(n):
            for i in range(np.uint64(intervals)):
                a = fp[g, k, i]
                b = fq[g, k, i]
                fp[g, k, i] = across[0] * a + across[1] * b
                fr[g, k, i] = along[0] * a + along[1] * b


@kernel
def _spread(y, row, n, m, node, at, values, to):
    """Row of y to its values interval by interval and at the Gauss points (index `to`)."""
    intervals = node.shape[3]
    place = 0
    for i in range(intervals):
        for j in range(m + 1):
            for k in range(n):
                node[to, j, k, i] = y[row, place + j * n + k]
        place += m * n
    _to_gauss(values, node, at, to)


@vector_kernel
def _to_gauss(values, node, at, to):
    """at[to] (m, n, N) = values (m, m + 1) applied to node[to] (m + 1, n, N)."""
    _, nodes, n, intervals = node.shape
    lanes = np.uint64(intervals)
    for g in range(nodes - 1):
        for k in range(n):
            x = values[g, 0]
            for i in range(lanes):
                at[to, g, k, i] = x * node[to, 0, k, i]
            for j in range(1, nodes):
                x = values[g, j]
                for i in range(lanes):
                    at[to, g, k, i] += x * node[to, j, k, i]


@kernel
def _second(e, c, w, f, o, z, which, by_period, by_s):
    """rate = Df[v] and bend = D^2f[v, .] at the Gauss points, v at place `which` of o.at with its T and s parts."""
    n, m = e.n, e.m
    w_at, w_p, at, rate, bend = w.at, w.p, o.at, o.rate, o.bend
    direction, matrix, slope, here = o.direction, o.matrix, o.slope, o.here
    forcing, gauss, address = e.forcing, e.gauss, c.gradient
    intervals = rate.shape[2]
    nodes = (intervals * m + 1) * n
    columns = n + w_p.size
    for j in range(columns):
        direction[j] = 0.0
    direction[n + e.active] = by_s * f.across[0]
    direction[n + c.second] = by_s * f.across[1]
    start = 0.0
    for i in range(intervals):
        for g in range(m):
            for k in range(n):
                here[k] = w_at[g, k, i]
                direction[k] = at[which, g, k, i]
            if forcing != 0:
                t = start + w.h[i] * gauss[g]
                w_p[w_p.size - 1] = z[nodes] * t
                direction[columns - 1] = by_period * t
            call5(address, here, w_p, direction, slope, matrix)
            for k in range(n):
                rate[g, k, i] = slope[k]
                for j in range(columns):
                    bend[g, k, j, i] = matrix[k, j]
        start += w.h[i]


@vector_kernel
def _right_side(e, c, w, o, to, period, v_period, y_period, y_p, y_q, y_s, y_r, right):
    """right = -D^2F[v, y] = h (T D^2f[v, y] + v_T Df[y] + y_T Df[v]) at the Gauss points; y at place `to` of o.at."""
    n, m = e.n, e.m
    at, rate, bend, h = o.at, o.rate, o.bend, w.h
    fu, fs, fr, ft = w.fu, w.fp, o.fr, w.ft
    first, second = n + e.active, n + c.second
    intervals = h.size
    lanes = np.uint64(intervals)
    for g in range(m):
        for k in range(n):
            r = g * n + k
            for i in range(lanes):
                x = period * (bend[g, k, first, i] * y_p + bend[g, k, second, i] * y_q) + y_period * rate[g, k, i]
                right[r, i] = x + v_period * (fs[g, k, i] * y_s + fr[g, k, i] * y_r)
            for j in range(n):
                for i in range(lanes):
                    right[r, i] += (period * bend[g, k, j, i] + v_period * fu[g, k, j, i]) * at[to, g, j, i]
    if e.forcing != 0:
        time = bend.shape[2] - 1
        start = 0.0
        for i in range(intervals):
            for g in range(m):
                t = (start + h[i] * e.gauss[g]) * y_period
                for k in range(n):
                    right[g * n + k, i] += (period * bend[g, k, time, i] + v_period * ft[g, k, i]) * t
            start += h[i]
    for r in range(m * n):
        for i in range(lanes):
            right[r, i] *= h[i]


@kernel
def _finish(s, n, m, f, o, border, reduced, row):
    """Solve the last system for y[row]: right-hand sides in s.right_last where `reduced`, jump o.jump, phase `border`.

    o.x beyond place n holds the right-hand sides of the rows f.rows.
    """
    x, last, points, end, jump, b = o.x, s.right_last, s.points, s.end, o.jump, f.jump
    intervals = points.shape[1] - 1
    branching = o.final.shape[0] == n + 3
    if not reduced:
        clear_right(s, n, m)
    for r in range(n + 1):
        x[r] = last[r]
        for q in range(n):
            x[r] -= end[r, n + q] * jump[q]
    x[n] += border
    lu_solve(o.final, o.final_pivots, x)
    unfolding = x[n + 2] if branching else 0.0
    for k in range(n):
        points[k, 0] = x[k]
        points[k, intervals] = x[k] + jump[k] - b[k, 0] * unfolding
    expand(s, n, m, x[n], x[n + 1], o.y[row])
    o.y[row, o.y.shape[1] - 1] = unfolding


@part
def _final(e, c, w, s, f, o, autonomous):
    """LU factors of the last system; False where it is singular. Fills o.corner."""
    n = e.n
    end, final, rows, b, corner = s.end, o.final, f.rows, f.jump, o.corner
    for r in range(n + 1):
        for j in range(n):
            final[r, j] = end[r, j] + end[r, n + j]
        for j in range(2):
            final[r, n + j] = end[r, 2 * n + j]
    for j in range(2):
        final[n, n + j] += corner[0, j]
    for j in range(n + 2):
        final[n + 1, j] = rows[0, j]
    if c.kind == BPC:
        for r in range(n + 1):
            final[r, n + 2] = 0.0
            for q in range(n):
                final[r, n + 2] -= end[r, n + q] * b[q, 0]
        for j in range(n + 2):
            final[n + 2, j] = rows[1, j]
        final[n + 1, n + 2] = 0.0
        final[n + 2, n + 2] = 0.0
    return lu_factor(final, o.final_pivots) != 0


@part
def _null(e, c, s, f, o, k):
    """The null function(s) v of PD and NS and their G, with the factors of the system for v(0); False: singular."""
    n, m = e.n, e.m
    end, a, b, start, x, points = s.end, o.null, f.jump, f.start, o.x, s.points
    intervals = points.shape[1] - 1
    size = a.shape[0]
    for r in range(size):
        x[r] = 0.0
        for j in range(size):
            a[r, j] = 0.0
    if c.kind == PD:
        for r in range(n):
            for j in range(n):
                a[r, j] = end[r, j] - end[r, n + j]
                a[r, n] += end[r, n + j] * b[j, 0]
            a[n, r] = start[r, 0]
        x[n] = 1.0
    else:
        for r in range(n):
            for j in range(n):
                a[r, j] = end[r, j]
                a[r, n + j] = end[r, n + j]
                a[n + r, j] = -end[r, n + j]
                a[n + r, n + j] = end[r, j] + 2.0 * k * end[r, n + j]
                for q in range(2):
                    a[n + r, 2 * n + q] += end[r, n + j] * b[j, q]
            for q in range(2):
                a[2 * n + q, r] = start[r, q]
        x[2 * n] = 1.0
    if lu_factor(a, o.null_pivots) == 0:
        return False
    lu_solve(a, o.null_pivots, x)
    passes = 1 if c.kind == PD else 2
    for q in range(passes):
        o.G[q] = x[passes * n + q]
    for q in range(passes):
        clear_right(s, n, m)
        for r in range(n):
            points[r, 0] = x[q * n + r]
            if c.kind == PD:
                points[r, intervals] = -x[r] + b[r, 0] * o.G[0]
            elif q == 0:
                points[r, intervals] = x[n + r]
            else:
                points[r, intervals] = 2.0 * k * x[n + r] - x[r] + b[r, 0] * o.G[0] + b[r, 1] * o.G[1]
        expand(s, n, m, 0.0, 0.0, o.v[q])
    return True


@part
def linearise(e, c, w, s, f, o, q, extra):
    """The solutions y, G and dG at o.z with second parameter q and the further unknown; 0, FAILED or NOT_FINITE."""
    n, m = e.n, e.m
    z, y, v, G, dG, jump, border, corner, x = o.z, o.y, o.v, o.G, o.dG, o.jump, o.border, o.corner, o.x
    kind = c.kind
    intervals = w.h.size
    nu = (intervals * m + 1) * n
    autonomous = e.forcing == 0
    count = 4 if kind == BPC else 3
    w.p[c.second] = q
    if not evaluate(e, w, z, True):
        return NOT_FINITE
    _second_column(e, c, w, z, o.fq)
    _turn(f.across, f.along, w.fp, o.fq, o.fr)
    residual(e, w, z, s.right_local, jump, border)
    fill(e, w, z, o.zero, o.units, s.local, corner)
    by_r = 0.0
    if autonomous:
        corner[0, 0] = 0.0
        corner[0, 1] = 0.0
    else:
        call4(e.forcing, w.F, w.p, o.period, o.by_all)
        by_p = e.multiple * o.by_all[0, n + e.active]
        by_q = e.multiple * o.by_all[0, n + c.second]
        corner[0, 0] = 1.0
        corner[0, 1] = -(f.across[0] * by_p + f.across[1] * by_q)
        by_r = f.along[0] * by_p + f.along[1] * by_q
    sign = condense_dense(s, n, m) if n > LANES else _condense(s, n, m)
    if sign == 0:
        return FAILED
    if not _final(e, c, w, s, f, o, autonomous):
        return FAILED
    # y[0]: -F
    if kind == BPC:
        for j in range(n):
            jump[j] -= extra * f.jump[j, 0]
    reduce_right(s, n, m)
    x[n + 1] = 0.0
    x[n + 2] = 0.0
    _finish(s, n, m, f, o, border[0], True, 0)
    # y[1]: -F_r
    for j in range(n):
        jump[j] = 0.0
    _slope_right(o.fr, w.h, z[nu], s.right_local)
    reduce_right(s, n, m)
    x[n + 1] = 0.0
    x[n + 2] = 0.0
    _finish(s, n, m, f, o, by_r, True, 1)
    # y[2], y[3]: kernel
    for j in range(2, count):
        x[n + 1] = 1.0 if j == 2 else 0.0
        x[n + 2] = 0.0 if j == 2 else 1.0
        _finish(s, n, m, f, o, 0.0, False, j)
    if kind in (PD, NS):
        if not _null(e, c, s, f, o, extra):
            return FAILED
    elif kind == LPC:
        G[0] = y[2, nu + 1]
    else:
        G[0] = y[2, nu + 2]
        G[1] = y[3, nu + 2]
    for j in range(count):
        _spread(y, j, n, m, o.node, o.at, e.values, j)
    passes = 1 if kind in (LPC, PD) else 2
    for a in range(passes):
        which = 2 + a
        by_period = 0.0
        by_s = 0.0
        if kind in (LPC, BPC):
            by_period = y[which, nu]
            by_s = y[which, nu + 1]
        else:
            which = 4
            _spread(v, a, n, m, o.node, o.at, e.values, 4)
        _second(e, c, w, f, o, z, which, by_period, by_s)
        for j in range(count):
            y_s = y[j, nu + 1]
            y_r = 1.0 if j == 1 else 0.0
            y_p = f.across[0] * y_s + f.along[0] * y_r
            y_q = f.across[1] * y_s + f.along[1] * y_r
            _right_side(e, c, w, o, j, z[nu], by_period, y[j, nu], y_p, y_q, y_s, y_r, s.right_local)
            reduce_right(s, n, m)
            for r in range(n + 2):
                o.reduced[a, j, r] = s.right_last[r]
    if kind == NS:
        for r in range(n):
            o.reduced[0, 3, r] = 0.0
            o.reduced[1, 3, r] = 0.0
            for j in range(n):  # v(1) is the second function at 0
                o.reduced[1, 3, r] -= 2.0 * s.end[r, n + j] * v[1, j]
    for j in range(4 if kind == NS else count):
        if kind in (LPC, BPC):
            for a in range(passes):
                for r in range(n + 1):
                    x[r] = o.reduced[a, j, r]
                x[n + 1] = 0.0
                x[n + 2] = 0.0
                lu_solve(o.final, o.final_pivots, x)
                dG[a, j] = x[n + 1] if kind == LPC else x[n + 2]
        else:
            for r in range(passes * n + passes):
                x[r] = 0.0
            for a in range(passes):
                for r in range(n):
                    x[a * n + r] = o.reduced[a, j, r]
            lu_solve(o.null, o.null_pivots, x)
            for a in range(passes):
                dG[a, j] = x[passes * n + a]
    return 0


@vector_kernel
def _slope_right(fr, h, period, right):
    """right = h T f_r."""
    m, n, intervals = fr.shape
    for g in range(m):
        for k in range(n):
            for i in range(np.uint64(intervals)):
                right[g * n + k, i] = h[i] * period * fr[g, k, i]


@part
def along_y(c, f, o, row, j, nu, intervals):
    """Component j of the change of z that y[row] stands for (row 3 of NS: of k alone)."""
    change = 0.0
    kind = c.kind
    size = nu + 1 + intervals + 2 + (1 if kind in (NS, BPC) else 0)
    if kind == NS and row == 3:
        change = 1.0 if j == size - 3 else 0.0
    elif j <= nu:
        change = o.y[row, j]
    elif j >= size - 2:
        place = size - 1 - j  # 0: first parameter, 1: second
        change = f.across[place] * o.y[row, nu + 1] + (f.along[place] if row == 1 else 0.0)
    elif kind == BPC and j == size - 3:
        change = o.y[row, nu + 2]
    return change


@part
def tangent_of(c, f, o, nu, intervals, scale, guide, out_t):
    """Unit tangent of the curve into out_t, along `guide`; False where it is not defined."""
    g, dG, size = o.null_combination, o.dG, scale.size
    last = 3
    if c.kind in (LPC, PD):
        last = 2
        g[0] = -dG[0, 2]
        g[1] = dG[0, 1]
        g[2] = 0.0
    else:
        g[0] = dG[0, 2] * dG[1, 3] - dG[0, 3] * dG[1, 2]
        g[1] = dG[0, 3] * dG[1, 1] - dG[0, 1] * dG[1, 3]
        g[2] = dG[0, 1] * dG[1, 2] - dG[0, 2] * dG[1, 1]
    total = 0.0
    along = 0.0
    for j in range(size):
        t = 0.0
        for row in range(last):
            t += g[row] * along_y(c, f, o, row + 1, j, nu, intervals)
        t /= scale[j]
        out_t[j] = t
        total += t * t
        along += t * guide[j]
    if not 0.0 < total < math.inf:
        return False
    norm = math.sqrt(total) if along >= 0.0 else -math.sqrt(total)
    for j in range(size):
        out_t[j] /= norm
    return True


@kernel
def correct_special(e, c, w, s, x, f, o, z0, tangent, scale, sizes, length, guess, tolerance, exact, out_z, out_t,
                    out_re, out_im, info):  # fmt: skip
    """Newton on the plane <tangent, (z - z0) / scale> = length from `guess`, into out_z, with tangent and multipliers.

    `exact`: everything is measured at the solution itself, else with the matrices of the last iteration; tolerance
    inf: nothing is solved, only measured. info: [size of the first correction, iterations, s part of y[1], size of the
    second correction beside the square of the first]; on entry info[3] is the last known of these, inf where one
    iteration is never enough.
    Returns the number of iterations, FAILED or NOT_FINITE.
    """
    n, m = e.n, e.m
    size = scale.size
    intervals = w.h.size
    nu = (intervals * m + 1) * n
    z = o.z
    last = z.size - 1
    for j in range(size):
        out_z[j] = guess[j]
    set_phase(e, w, guess, sizes)
    before = math.inf
    curvature = info[3]
    done = not tolerance < math.inf
    final = done
    info[0] = 0.0
    iteration = 0
    unknowns = o.small.shape[0]
    while True:
        for j in range(nu + 1 + intervals):
            z[j] = out_z[j]
        z[last] = out_z[size - 1]
        status = linearise(e, c, w, s, f, o, out_z[size - 2], out_z[size - 3])
        if status != 0:
            return status
        if final:
            break
        for row in range(unknowns):
            g = o.combination
            if row < unknowns - 1:
                for col in range(unknowns):
                    o.small[row, col] = o.dG[row, col + 1]
                g[row] = -(o.G[row] + o.dG[row, 0])
            else:
                for col in range(unknowns):
                    total = 0.0
                    for j in range(size):
                        total += tangent[j] * along_y(c, f, o, col + 1, j, nu, intervals) / scale[j]
                    o.small[row, col] = total
                rest = length
                for j in range(size):
                    rest -= tangent[j] * (out_z[j] - z0[j] + along_y(c, f, o, 0, j, nu, intervals)) / scale[j]
                g[row] = rest
        if lu_factor(o.small, o.small_pivots) == 0:
            return FAILED
        lu_solve(o.small, o.small_pivots, o.combination)
        total = 0.0
        for j in range(size):
            change = along_y(c, f, o, 0, j, nu, intervals)
            for row in range(unknowns):
                change += o.combination[row] * along_y(c, f, o, row + 1, j, nu, intervals)
            out_z[j] += change
            change /= scale[j]
            total += change * change
        moved = math.sqrt(total)
        iteration += 1
        if iteration == 1:
            info[0] = moved
        if not moved < 1e2 or not out_z[nu] > 0.0:
            return FAILED
        ratio = moved / before
        if iteration == 1:
            done = moved <= tolerance or curvature * moved * moved < 0.03 * tolerance
        elif moved <= tolerance or (moved < 1e-4 and moved * ratio * ratio < 0.1 * tolerance):
            done = True
        elif ratio > 0.5:
            if moved < STAGNATION:
                done = True
            else:
                return FAILED
        elif iteration >= ITERATIONS:
            return FAILED
        if iteration == 2:
            info[3] = moved / (before * before)
        before = moved
        if done:
            if not exact:
                break
            final = True
    if not tangent_of(c, f, o, nu, intervals, scale, tangent, out_t):
        return FAILED
    info[1] = iteration
    info[2] = o.y[1, nu + 1]
    for k in range(x.re.size):
        x.re[k] = math.nan
    for j in range(x.z.size):
        x.z[j] = z[j]
    trivial = floquet(e, w, s, x)
    out_re[0] = trivial
    out_im[0] = 0.0
    for k in range(x.re.size):
        out_re[k + n - x.re.size] = x.re[k]
        out_im[k + n - x.re.size] = x.im[k]
    return iteration
