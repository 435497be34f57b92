"""The last, dense system of the bordered equations, its solutions, and the null functions v of PD and NS."""

from contin.kernels.collocation_system import clear_right, expand
from contin.kernels.compile import kernel
from contin.kernels.dense import lu_factor_weighted, lu_solve
from contin.kernels.special_orbits.memory import BPC, PD


@kernel("Equations, Curve, Points, Factors, Borders, CurveMemory -> b")
def final_factors(e, c, w, s, f, o):
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
    return lu_factor_weighted(final, o.final_pivots, s.stages.weights, n, s.stages.row_weights) != 0


@kernel("Factors, i, i, Borders, CurveMemory, f, b, i")
def finish(s, n, m, f, o, border, reduced, row):
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


@kernel("Equations, Curve, Factors, Borders, CurveMemory, f -> b")
def null_functions(e, c, s, f, o, k):
    """The null function(s) v of PD and NS and their G, with the factors of the system for v(0); False: singular.

    NS: v_1(1) = v_2(0) and v_2(1) - 2 k v_2(0) + v_1(0) = B G. Of autonomous flows v' = T f_u v + T_v f with both v(0)
    in the section. So the trivial multiplier has no part in it, beside which a fold with k = 1 would be a solution,
    too, and its curve would cross that of the tori at R1.
    """
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
            if size > 2 * n + 2:
                for q in range(2):
                    a[q * n + r, 2 * n + 2 + q] = end[r, 2 * n]
                    a[2 * n + 2 + q, q * n + r] = o.section[r]
        x[2 * n] = 1.0
    if lu_factor_weighted(a, o.null_pivots, s.stages.weights, n if c.kind == PD else 2 * n, s.stages.row_weights) == 0:
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
        period = x[2 * n + 2 + q] if size > 2 * n + 2 else 0.0
        expand(s, n, m, period, 0.0, o.v[q])
    return True
