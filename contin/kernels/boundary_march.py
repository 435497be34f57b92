"""Pseudo-arclength march along solutions of a boundary-value problem in one kernel call; model and conditions are
pointers.

As the march of periodic orbits (`contin.kernels.collocation_march`: chord iterations on one factorisation a step), with
n conditions g(u(0), u(1), p) = 0 in the place of periodicity, and without multipliers. Test functions:

    0  dp/ds                       zero at folds
    1  sign det M / |M^-1 r|       zero at branch points; r is a fixed jump of the conditions, M = [J; t^T]
"""

import math
from collections import namedtuple

import numpy as np

from contin.kernels.chords import (
    AFRESH,
    CONVERGED,
    EXACT,
    FAILED,
    ITERATIONS,
    STALE,
    allowed,
    follows,
    is_stale,
    kept,
)
from contin.kernels.collocation import evaluate, residual
from contin.kernels.collocation_march import MARCH
from contin.kernels.collocation_mesh import mesh_error
from contin.kernels.collocation_steps import advance, along, direct, distance, length, predict
from contin.kernels.collocation_system import clear_right, expand, reduce_right
from contin.kernels.compile import call4, kernel
from contin.kernels.condensation import condense
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.filling import fill
from contin.kernels.signature import structure
from contin.kernels.stages import weigh
from contin.kernels.steering import (
    ACCEPTED,
    AT_CORNER,
    BOUND,
    CORNER,
    CORRECTOR,
    LIMIT,
    LOOP,
    NOT_FINITE,
    RESCALE,
    STRAYED,
    crossed,
    judged,
    leaves,
    met,
    next_step,
    passes_start,
    recall,
    record,
    shortened,
)

TESTS = 2
HALF_PI = 0.5 * math.pi
WANTED = 1.5e-3  # first correction, in the metric, that the step control aims at
OUTGROWN = 1.5  # of its size, beyond which a function's size is renewed

Conditions = namedtuple(
    "Conditions",
    [
        "jacobian",  # address: (u(0) and u(1), p, g, G) with zeros below g and its derivatives
        "ends",  # (2 n,)
        "value",  # (2 n,)
        "matrix",  # (2 n, 2 n + m_p)
        "last",  # (2 n + 2, 2 n + 2) what is left of the matrix: unknowns (u(0), u(1), T, p)
        "pivots",
        "right",  # (2 n + 2,)
        "tests",  # (TESTS,)
    ],
)
structure(Conditions, "i, f1, f1, f2, f2, i1, f1, f1")


def new_conditions(jacobian, n, parameters):
    """Memory for the conditions at `jacobian`, of n functions and so many parameters."""
    size = 2 * n + 2
    return Conditions(
        jacobian, np.zeros(2 * n), np.zeros(2 * n), np.zeros((2 * n, 2 * n + parameters)), np.zeros((size, size)),
        np.zeros(size, np.int64), np.zeros(size), np.zeros(TESTS),
    )  # fmt: skip


@kernel("Conditions, Equations, Points, i, f1 -> b")
def at_ends(c, e, w, n, z):
    """g and its derivatives at z; False where they are not finite."""
    ends, value, matrix = c.ends, c.value, c.matrix
    last = z.size - 2 - w.h.size - n
    for k in range(n):
        ends[k] = z[k]
        ends[n + k] = z[last + k]
    w.p[e.active] = z[z.size - 1]
    call4(c.jacobian, ends, w.p, value, matrix)
    total = 0.0
    for k in range(n):
        total += value[k] + matrix[k, 2 * n + e.active]
        for j in range(2 * n):
            total += matrix[k, j]
    return math.isfinite(total)


@kernel("Conditions, Equations, Points, Factors, f1, f1, f1, f2 -> i")
def factorise(c, e, w, s, z, tangent, scale, border):
    """Factors of M at z, after `evaluate` and `at_ends`; the sign of its determinant, 0 where it is singular."""
    n = e.n
    a, end, matrix = c.last, s.end, c.matrix
    sign = fill(e, w, z, tangent, scale, s, border)
    if sign != 0:
        sign *= condense(s, n, e.m)
    if sign == 0:
        return 0
    for r in range(2 * n + 2):
        for k in range(2 * n + 2):
            a[r, k] = 0.0
    for r in range(n):
        for k in range(2 * n + 2):
            a[r, k] = end[r, k]
        for k in range(2 * n):
            a[n + r, k] = matrix[r, k]
        a[n + r, 2 * n + 1] = matrix[r, 2 * n + e.active]
    for r in range(2):
        for k in range(2 * n + 2):
            a[2 * n + r, k] = end[n + r, k]
        for k in range(2):
            a[2 * n + r, 2 * n + k] += border[r, k]
    sign *= lu_factor(a, c.pivots)
    for k in range(2 * n + 2):
        if a[k, k] < 0.0:
            sign = -sign
    return sign


@kernel("Conditions, Factors, i, i, f1, f1, b, f1")
def solve(c, s, n, m, jump, border, has_local, out):
    """M x = (s.right_local, jump of the conditions (n,), border (2,)); out : node values, T, p.

    Where has_local is False the right-hand sides of the intervals are zero.
    """
    right, points = c.right, s.points
    if has_local:
        reduce_right(s, n, m)
    else:
        clear_right(s, n, m)
    for k in range(n):
        right[k] = s.right_last[k]
        right[n + k] = jump[k]
    for q in range(2):
        right[2 * n + q] = s.right_last[n + q] + border[q]
    lu_solve(c.last, c.pivots, right)
    last = points.shape[1] - 1
    for k in range(n):
        points[k, 0] = right[k]
        points[k, last] = right[n + k]
    expand(s, n, m, right[2 * n], right[2 * n + 1], out)


@kernel("Conditions, Equations, Points, Factors, Scratch, f1, f1, f1, f, f -> i")
def correct(c, e, w, s, x, z0, tangent, scale, reach, tolerance):
    """Newton with chord iterations on the plane <tangent, (z - z0) / scale> = reach, on x.z.

    Returns the sign of the determinant (+1, -1), 0 (no convergence) or 2 (not finite); the factors are the last ones.
    """
    n, m = e.n, e.m
    z, step, sizes, jump, right, value = x.z, x.step, x.sizes, x.jump, x.right, c.value
    nodes = z.size - 2 - x.density.size
    sign = 0
    fresh = True
    before = math.inf
    for j in range(4):
        sizes[j] = 0.0
    for iteration in range(ITERATIONS):
        sizes[1] += 1.0
        if not (evaluate(e, w, z, fresh) and at_ends(c, e, w, n, z)):
            return 2
        residual(e, w, z, s.right_local, jump, right)
        right[1] = reach - along(tangent, z, z0, scale)
        for k in range(n):
            jump[k] = -value[k]
        if fresh:
            sizes[3] += 1.0
            sizes[2] = 0.0
            sign = factorise(c, e, w, s, z, tangent, scale, x.border)
            if sign == 0:
                return 0
        solve(c, s, n, m, jump, right, True, step)
        size = advance(z, step, scale, nodes)
        following = follows(iteration, size, before, fresh, True, tolerance, sizes)
        if following == CONVERGED:
            return sign
        if following == FAILED:
            return 0
        fresh = following == AFRESH
        before = size
    return 0


@kernel("Conditions, Equations, Points, Factors, Scratch, f1, f1 -> i")
def renew(c, e, w, s, x, tangent, scale):
    """Factors at x.z itself; the sign of the determinant."""
    if not (evaluate(e, w, x.z, True) and at_ends(c, e, w, e.n, x.z)):
        return 0
    return factorise(c, e, w, s, x.z, tangent, scale, x.border)


@kernel("Conditions, Equations, f1, i, i -> f")
def condition_size(c, e, scale, nodes, k):
    """How large condition k is where all unknowns have their sizes: jumps of it do not depend on units."""
    n = e.n
    total = abs(c.matrix[k, 2 * n + e.active]) * scale[scale.size - 1]
    for j in range(n):
        total += abs(c.matrix[k, j]) * scale[j] + abs(c.matrix[k, n + j]) * scale[nodes - n + j]
    return total if total > 0.0 else 1.0


@kernel("Conditions, Equations, Factors, Scratch, f1, i, f, i, f2, f1")
def measure(c, e, s, x, scale, sign, reference, row, out_t, tests):
    """Tangent (row of out_t) and test functions at x.z, from the factors."""
    n, m = e.n, e.m
    step, jump, right = x.step, x.jump, x.right
    nodes = x.z.size - 2 - x.density.size
    for k in range(n):
        jump[k] = 0.0
    right[0] = 0.0
    right[1] = 1.0
    solve(c, s, n, m, jump, right, False, step)
    stretched = length(step, scale, nodes)
    direct(step, scale, nodes, out_t[row])
    tests[0] = out_t[row, x.z.size - 1]
    right[1] = 0.0
    squares = 0.0
    for which in range(2):  # one alone may be all but normal to the left null vector: the test has no slope
        for k in range(n):
            jump[k] = math.cos(1.0 + k - which * HALF_PI) * condition_size(c, e, scale, nodes, k)
        solve(c, s, n, m, jump, right, False, step)
        long = length(step, scale, nodes)
        squares += long * long
    exponent = math.log(stretched) - 0.5 * math.log(squares) - reference
    tests[1] = sign * math.exp(min(max(exponent, -700.0), 700.0))


@kernel("f1, i, i, f1 -> b")
def outgrown(z, n, count, sizes):
    """True where a function has become larger than its size."""
    for k in range(n):
        for i in range(count):
            if abs(z[i * n + k]) > OUTGROWN * sizes[k]:
                return True
    return False


@kernel(
    "i, Conditions, Equations, Points, Factors, Scratch, f1, f1, f1, f1, i, f1, f, f1, f1, f1, f1, f1, f2, f2, f2, f1, "
    "f1 -> i"
)
def follow(
    mode, c, e, w, s, x, scale, sizes, bounds, controls, limit, top, error_constant, previous_z, previous_tangent,
    previous_tests, loop_z, loop_tangent, out_z, out_t, out_tests, out_h, info,
):  # fmt: skip
    """MARCH and PROBE as `contin.kernels.collocation_march.follow` does them; RESCALE also where the mesh no longer
    resolves the solution or a function has outgrown its size. PROBE returns 0, -1 or -2 (not finite).

    controls : [h, h_min, h_max, cos_max_angle, tolerance, h_previous, target_angle, error_limit, worthwhile]
    info : [rows beyond row 0, next h, evaluations, log reference of test 1, test that dipped, h that failed]
    """
    n, m = e.n, e.m
    size = scale.size
    last = size - 1
    z, old, tests, sizes_of, density = x.z, x.old, c.tests, x.sizes, x.density
    intervals = density.size
    count = intervals * m + 1
    h, h_min, h_max, cos_max, tolerance = controls[0], controls[1], controls[2], controls[3], controls[4]
    h_previous, target_angle, error_limit, worthwhile = controls[5], controls[6], controls[7], controls[8]
    reference = 0.0 if mode == MARCH else info[3]
    start = 0 if mode == MARCH else 1
    weigh(s.stages.weights, n, sizes)
    for j in range(size):
        z[j] = out_z[start, j]
    sign = correct(c, e, w, s, x, out_z[0], out_t[0], scale, h if start == 1 else 0.0, tolerance)
    evaluations = sizes_of[1]
    if mode == MARCH:
        moved = distance(z, out_z[0], scale)
        if kept(z, out_z, sign, moved, tolerance) or sizes_of[2] > STALE:
            sign = 0
    elif sign == 0 or sign == 2:
        return -1 if sign == 0 else -2
    if sign == 0 or (mode != MARCH and sizes_of[2] > EXACT):
        sign = renew(c, e, w, s, x, out_t[0], scale)
        evaluations += 1.0
    for i in range(6):
        info[i] = info[3] if i == 3 and mode != MARCH else 0.0
    info[1] = h
    info[2] = evaluations
    if sign == 0:
        return CORRECTOR if mode == MARCH else -1
    measure(c, e, s, x, scale, sign, reference, start, out_t, tests)
    if mode != MARCH:
        record(z, tests, out_z, out_tests, 1)
        return 0
    if tests[1] != 0.0:
        reference = math.log(abs(tests[1]))
    tests[1] = float(sign)
    info[3] = reference
    record(z, tests, out_z, out_tests, 0)
    strayed = 0
    for k in range(limit):
        row = k + 1
        tangent = out_t[k]
        recall(out_t, previous_tangent, k, old)
        recall(out_z, previous_z, k, x.before)
        if k > 0:
            h_previous = out_h[k]
        cosine = 1.0
        while True:
            predict(out_z[k], tangent, x.before, old, scale, h, h_previous, z)
            sign = correct(c, e, w, s, x, out_z[k], tangent, scale, h, tolerance)
            info[2] += sizes_of[1]
            if is_stale(sign, sizes_of[2], 1.0):
                sign = renew(c, e, w, s, x, tangent, scale)
                info[2] += 1.0
            if sign != 0 and sign != 2 and leaves(distance(z, out_z[k], scale), h, cos_max, tolerance):
                sign = 0
            if sign == 0 or sign == 2:
                if h <= h_min:
                    info[5] = h
                    info[1] = h
                    return NOT_FINITE if sign == 2 else CORRECTOR
                h = max(0.4 * h, h_min)
                continue
            measure(c, e, s, x, scale, sign, reference, row, out_t, tests)
            cosine = 0.0
            for j in range(size):
                cosine += tangent[j] * out_t[row, j]
            verdict = judged(
                tests, out_tests, k, previous_tests, 1, False, cosine, cos_max, h, h_min, h_previous, strayed < 3
            )
            if verdict in (ACCEPTED, AT_CORNER):
                break
            strayed += verdict == STRAYED
            h = shortened(verdict, h, h_min)
        strayed = 0
        out_h[row] = h
        record(z, tests, out_z, out_tests, row)
        info[0] = row
        angle = math.acos(min(cosine, 1.0)) if verdict != AT_CORNER else target_angle
        h_used = h
        h = next_step(h, angle, target_angle, sizes_of[0], WANTED, 4.0, sizes_of[1], 5.0, h_min, h_max)
        info[1] = h
        if verdict == AT_CORNER:
            return CORNER
        if z[last] < bounds[0] or z[last] > bounds[1]:
            return BOUND
        changed = crossed(tests, out_tests, k)
        what = met(tests, out_tests, k, previous_tests, 0, changed, h_previous, h_used, info)
        if what != LIMIT:
            return what
        if loop_z.size == size and passes_start(z, out_z[k], loop_z, loop_tangent, x.every, x.none, scale, h_used):
            return LOOP
        if outgrown(z, n, count, sizes):
            return RESCALE
        error = mesh_error(z, n, m, intervals, False, top, error_constant, sizes, density)
        error_limit = allowed(z, n, m, error_constant, density, error, error_limit, worthwhile)
        if error_limit == 0.0:
            return RESCALE
    return LIMIT
