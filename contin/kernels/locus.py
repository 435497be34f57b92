"""March along a curve in two parameters: folds, Hopf points or branch points of equilibria of a flow.

The curve solves an extended system (`contin.symbolic.loci`) with unknowns z = (u, vectors, kappa or unfolding, second
parameter, first parameter); its Jacobian's leading block is f_u, which gives eigenvalues and test functions for
nothing.

Test functions of a point (columns of `tests`); 0 and 1 are not events (dp/ds and a constant):
    folds          2 cusp <psi, B(v,v)>   3 Bogdanov-Takens <psi, v>   4 zero-Hopf: pairs of the other eigenvalues
    Hopf points    2 kappa                3 zero-Hopf: the others' product   4 Hopf-Hopf: their pairs   5 sign of l1
    branch points  3 <psi, v>             4 pairs of the other eigenvalues
"""

import math

import numpy as np

from contin.kernels.algebraic import correct, linearise
from contin.kernels.between import guess_between, is_between
from contin.kernels.compile import allocating, call5, kernel
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.eigen import eigenvalues
from contin.kernels.grading import uniform_rates
from contin.kernels.lyapunov import lyapunov_terms
from contin.kernels.null_vectors import leading_block, null_vectors
from contin.kernels.sides import is_aligned, side_of
from contin.kernels.steering import (
    BEFORE,
    BOUND,
    CORRECTOR,
    GUARD_FLOOR,
    LIMIT,
    LOOP,
    NOT_FINITE,
    RESCALE,
    RESCALE_AT,
    SHORTEST,
    leaves,
    met,
    next_step,
    passes_start,
    recall,
    record,
    set_out,
    strays,
    turn,
)
from contin.kernels.tests_of_stability import flow_tests
from contin.kernels.turning_off import turning_off

FOLD, HOPF = range(2)
TESTS = 6
CENTRES = 1e-9  # of its terms, a first Lyapunov coefficient that stays zero, as of centres: what rows are off by


@kernel("f1, f1, i, i, f1, f1 -> i")
def without(re, im, first, second, rest_re, rest_im):
    """Copy the eigenvalues except two (second = -1: except one)."""
    k = 0
    for i in range(re.size):
        if i != first and i != second:
            rest_re[k] = re[i]
            rest_im[k] = im[i]
            k += 1
    return k


@kernel("f1, f1, f -> (i, i)")
def critical_pair(re, im, kappa):
    """Indices of the two eigenvalues whose sum is nearest 0 and whose product is nearest kappa."""
    n = re.size
    largest = 0.0
    for i in range(n):
        largest = max(largest, math.hypot(re[i], im[i]))
    best = math.inf
    first = 0
    second = 1
    for i in range(n):
        for j in range(i + 1, n):
            sum_re = re[i] + re[j]
            sum_im = im[i] + im[j]
            product_re = re[i] * re[j] - im[i] * im[j]
            product_im = re[i] * im[j] + im[i] * re[j]
            gap = largest * math.hypot(sum_re, sum_im) + math.hypot(product_re - kappa, product_im)
            if gap < best:
                best = gap
                first = i
                second = j
    return first, second


@kernel("f1, f1, i, f -> f")
def rest_product(re, im, count, pair):
    """Sign of the product of the eigenvalues with the smallest one's size relative to the largest.

    pair : modulus of the critical ones, which counts: of one eigenvalue beside them only they tell how small it is.
    """
    sign = 1.0
    smallest = math.inf
    largest = pair
    for i in range(count):
        size = math.hypot(re[i], im[i])
        smallest = min(smallest, size)
        largest = max(largest, size)
        if im[i] == 0.0 and re[i] < 0.0:
            sign = -sign
    return sign * smallest / largest if largest > 0.0 and count > 0 else 1.0


@allocating("f1, f1, i, f1 -> i")
def rest_tests(re, im, count, tests):
    """`flow_tests` of the first `count` eigenvalues."""
    rates = np.empty(count)
    uniform_rates(re[:count], im[:count], rates)
    return flow_tests(re[:count], im[:count], rates, tests)


@allocating("i, i, i, f1, i, f1, f2, f1, i1, f1, f1, f1, f1, f1 -> i")
def observe(kind, form2, form3, z, n, scale, matrix, original, slots, tests, re, im, near_re, near_im):
    """Test functions, eigenvalues of f_u = `matrix` (n, n, scaled); returns the number of unstable ones, the critical
    ones not counted. `original` (m,) receives all parameters of the model, of which `slots` are (first, second)."""
    size = z.size
    original[slots[0]] = z[size - 1]
    original[slots[1]] = z[size - 2]
    eigenvalues(matrix.copy(), re, im, near_re, near_im)
    rest_re = np.empty(n)
    rest_im = np.empty(n)
    for i in range(1, TESTS):
        tests[i] = 1.0
    pairs = np.empty(4)
    u = z[:n]
    if kind == HOPF:
        kappa = z[size - 3]
        first, second = critical_pair(re, im, kappa)
        count = without(re, im, first, second, rest_re, rest_im)
        unstable = rest_tests(rest_re, rest_im, count, pairs)
        tests[2] = kappa / scale[size - 3]
        pair = max(math.hypot(re[first], im[first]), math.hypot(re[second], im[second]))
        tests[3] = rest_product(rest_re, rest_im, count, pair)
        if count > 1:
            tests[4] = pairs[2]
        tests[5] = 0.0
        if kappa > 0.0:
            v = np.empty(n)
            w = np.empty(n)
            for i in range(n):
                v[i] = z[n + i] / scale[i]
                w[i] = z[2 * n + i] / scale[i]
            lyapunov_terms(form2, form3, u, original, scale, matrix, math.sqrt(kappa), v, w, pairs)
            if pairs[1] > 0.0:
                tests[5] = pairs[0] / pairs[1]
            if tests[3] < 0.0:
                tests[5] = -tests[5]
        return unstable
    right = np.empty(n)
    left = np.empty(n)
    null_vectors(matrix.copy(), right, left)
    smallest = math.inf
    critical = 0
    for i in range(n):
        if math.hypot(re[i], im[i]) < smallest:
            smallest = math.hypot(re[i], im[i])
            critical = i
    count = without(re, im, critical, -1, rest_re, rest_im)
    unstable = rest_tests(rest_re, rest_im, count, pairs)
    if count > 1:
        tests[4] = pairs[2]
    along = 0.0
    for i in range(n):
        along += left[i] * right[i]
    tests[3] = along
    if kind == FOLD:
        # psi goes with the curve's own v, which is continuous: then so is <psi, B(v,v)>
        wide = np.zeros(n + original.size)
        quadratic = np.empty(n)
        agreement = 0.0
        norm = 0.0
        for i in range(n):
            wide[i] = z[n + i]
            norm += (z[n + i] / scale[i]) ** 2
            agreement += z[n + i] / scale[i] * right[i]
        call5(form2, u, original, wide, wide, quadratic)
        curvature = 0.0
        rate = 0.0
        for i in range(n):
            curvature += left[i] * quadratic[i] / scale[i]
            for j in range(n):
                rate += matrix[i, j] * matrix[i, j]
        if n == 1:
            rate = 1.0  # the one entry of f_u is rounding at a fold, no measure of rates
        if rate > 0.0 and norm > 0.0:
            tests[2] = math.copysign(curvature, curvature * agreement) / (math.sqrt(rate) * norm)
    return unstable


@kernel("f2, i1, f1")
def tangent_of(matrix, pivots, out):
    """Unit tangent from the factors of [F_z; t_old]."""
    n = out.size - 1
    for j in range(n):
        out[j] = 0.0
    out[n] = 1.0
    lu_solve(matrix, pivots, out)
    norm = 0.0
    for j in range(n + 1):
        norm += out[j] * out[j]
    norm = math.sqrt(norm)
    for j in range(n + 1):
        out[j] /= norm


@allocating("i, i, i, i, i, f1, i1, f1, f1, f, f1, f1, i, f1, f, f, f1, f1, f1, f1, f1 -> i")
def probe(
    address, kind, form2, form3, n, original, slots, z0, tangent, h, guess, p, active, scale, tolerance, trust, z,
    tangent_out, tests, re, im,
):  # fmt: skip
    """Solve on the plane tangent . (z - z0) / D = h from `guess` and measure there; unstable count, or -1."""
    size = z0.size - 1
    y = np.empty(size + 1)
    f = np.empty(size)
    jacobian = np.empty((size, size + p.size))
    matrix = np.empty((size + 1, size + 1))
    block = np.empty((size, size))
    pivots = np.empty(size + 1, np.int64)
    step = np.empty(size + 1)
    for j in range(size + 1):
        z[j] = guess[j]
        y[j] = (guess[j] - z0[j]) / scale[j]
    sign = correct(
        address, False, z0, tangent, h, y, z, p, active, scale, tolerance, trust, f, jacobian, matrix, block, pivots,
        step, np.zeros(2),
    )  # fmt: skip
    if sign == 0 or sign == 2:
        return -1
    tangent_of(matrix, pivots, tangent_out)
    tests[0] = tangent_out[size]
    re[:] = math.nan
    states = np.empty((n, n))
    leading_block(block, states)
    return observe(kind, form2, form3, z, n, scale, states, original, slots, tests, re, im, re, im)


@allocating("i, i, i, i, i, f1, i1, f1, f1, f1, f1, f1, f1, f1, f1, f1, i, f1, f, f, f2, f2, f2, f2, f2, i1")
def points_between(
    address, kind, form2, form3, n, original, slots, z0, tangent, a, tangent_a, b, tangent_b, fractions, lengths, p,
    active, scale, tolerance, trust, z, tangents, tests, re, im, unstable,
):  # fmt: skip
    """`probe` at fractions of the way from a to b, lengths[0] and lengths[1] from z0, into rows; counts, or -1."""
    s_a, s_b = lengths[0], lengths[1]
    for k in range(fractions.size):
        guess_between(tangent, a, tangent_a, b, tangent_b, scale, s_b - s_a, fractions[k], z, k)
        unstable[k] = probe(
            address, kind, form2, form3, n, original, slots, z0, tangent, s_a + fractions[k] * (s_b - s_a), z[k], p,
            active, scale, tolerance, trust, z[k], tangents[k], tests[k], re[k], im[k],
        )  # fmt: skip
        if unstable[k] >= 0 and not is_between(z, k, a, b, scale):
            unstable[k] = -1


@allocating(
    "i, i, i, i, i, f1, i1, f1, i, f1, f2, f1, i, f1, f1, f1, f1, f1, f1, f1, f2, f2, f2, i1, f2, f2, f1, f1 -> i"
)
def march(
    address, kind, form2, form3, n, original, slots, p, active, scale, walls, controls, limit, previous_tangent,
    previous_tests, loop_z, loop_tangent, seen, periods, growing, out_z, out_t, out_tests, out_unstable, out_re, out_im,
    out_h, info,
):  # fmt: skip
    """Follow the curve from row 0 of out_z for up to `limit` accepted points; as `contin.kernels.algebraic.march`.

    n : states of the model.  p, active : parameters of the extended system, the first parameter's place in them.
    walls (k, 3) : unknown, lowest, highest value.  seen (N,) : 1 for unknowns that identify a point (closing ignores
    the auxiliary vectors).  growing (N,) : 1 for unknowns whose scale may be outgrown.  info[5] : the last row before
    which another curve crosses this one, as the sign of the determinant of [F_z; tangent] says; 0 for none.
    """
    size = scale.size - 1
    h, h_min, h_max, cos_max, tolerance = controls[0], controls[1], controls[2], controls[3], controls[4]
    h_previous, target_angle, trust = controls[5], controls[6], controls[7]
    y = np.empty(size + 1)
    z = np.empty(size + 1)
    tangent = np.empty(size + 1)
    old = np.empty(size + 1)
    f = np.empty(size)
    jacobian = np.empty((size, size + p.size))
    matrix = np.empty((size + 1, size + 1))
    block = np.empty((size, size))
    states = np.empty((n, n))
    pivots = np.empty(size + 1, np.int64)
    step = np.empty(size + 1)
    sizes, lengths = np.zeros(2), np.zeros(3)
    tests = np.empty(TESTS)
    info[:] = 0.0
    info[1] = h
    info[2] = 1.0
    for j in range(size + 1):
        z[j] = out_z[0, j]
    if not linearise(address, False, z, p, active, scale, out_t[0], f, jacobian, matrix, block):
        return NOT_FINITE
    sign = lu_factor(matrix, pivots)
    if sign == 0:
        return CORRECTOR
    v, right = np.zeros(n), np.zeros(n)
    side_before, log_before = side_of(kind, n, sign, matrix, jacobian, block, z, p, active, scale, v, right)
    for j in range(n):
        v[j] = right[j]
    tangent_of(matrix, pivots, tangent)
    out_re[0] = math.nan
    leading_block(block, states)
    tests[0] = tangent[size]
    out_unstable[0] = observe(
        kind, form2, form3, z, n, scale, states, original, slots, tests, out_re[0], out_im[0], out_re[0], out_im[0]
    )
    record(tangent, tests, out_t, out_tests, 0)
    guarded = 0
    below, above = np.empty(size + 1), np.empty(size + 1)
    for k in range(limit):
        row = k + 1
        for j in range(size + 1):
            tangent[j] = out_t[k, j]
        recall(out_t, previous_tangent, k, old)
        if k > 0:
            h_previous = out_h[k]
        looked, crosses, apart = False, False, 0.0
        while True:
            set_out(out_z[k], tangent, old, scale, h, h_previous, y, z)
            sign = correct(
                address, False, out_z[k], tangent, h, y, z, p, active, scale, tolerance, trust, f, jacobian, matrix,
                block, pivots, step, sizes,
            )  # fmt: skip
            info[2] += sizes[1]
            length = 0.0
            for j in range(size + 1):
                length += y[j] * y[j]
            if leaves(math.sqrt(length), h, cos_max, tolerance):
                sign = 0
            if sign == 0 or sign == 2:
                if h <= h_min:
                    info[1] = h
                    return NOT_FINITE if sign == 2 else CORRECTOR
                h = max(0.5 * h, h_min)
                continue
            tangent_of(matrix, pivots, out_t[row])
            cosine = 0.0
            for j in range(size + 1):
                cosine += tangent[j] * out_t[row, j]
            if not cosine >= cos_max and h > max(h_min, SHORTEST):
                h = max(0.5 * h, h_min, SHORTEST)
                continue
            side, log_side = side_of(kind, n, sign, matrix, jacobian, block, z, p, active, scale, v, right)
            if side != side_before and not looked:
                lengths[1] = h
                lengths[2] = max(log_before, log_side)
                evaluations, apart = turning_off(
                    address, kind, n, out_z[k], tangent, old, h_previous, cos_max, side_before, z, p, active, scale,
                    tolerance, trust, f, jacobian, matrix, block, pivots, step, y, below, above, lengths, v,
                )  # fmt: skip
                info[2] += evaluations
                looked = apart == 0.0 or lengths[0] <= h_min
                crosses = looked and lengths[2] < 0.0
                h = h if looked else max(lengths[0] - BEFORE * apart, 0.5 * lengths[0], h_min)
                continue
            leading_block(block, states)
            tests[0] = out_t[row, size]
            unstable = observe(
                kind, form2, form3, z, n, scale, states, original, slots, tests, out_re[row], out_im[row], out_re[k],
                out_im[k],
            )  # fmt: skip
            if kind == HOPF and abs(tests[5]) < CENTRES and abs(out_tests[k, 5]) < CENTRES:  # not one row on a zero
                tests[5] = 0.0
            guarding = h > GUARD_FLOOR and h_previous > 0.0 and guarded < 8
            if guarding and strays(tests, out_tests, k, previous_tests, 2, True, h, h_previous):
                guarded += 1
                h = max(0.5 * h, 0.5 * GUARD_FLOOR)
                continue
            break
        guarded = 0
        if crosses:
            info[5] = row
        side_before, log_before = side, log_side
        for j in range(n):
            v[j] = right[j]
        out_h[row] = h
        out_unstable[row] = unstable
        record(z, tests, out_z, out_tests, row)
        info[0] = row
        angle = turn(cosine, target_angle)
        h_used = h
        h = next_step(h, angle, target_angle, sizes[0], 0.02, 3.0, sizes[1], 3.0, h_min, h_max)
        if apart > 0.0 and not looked:
            h = max(min(h, BEFORE * apart), h_min)
        info[1] = h
        for i in range(walls.shape[0]):
            value = z[int(walls[i, 0])]
            if value < walls[i, 1] or value > walls[i, 2]:
                return BOUND
        changed = False
        for i in range(2, TESTS):
            changed |= tests[i] * out_tests[k, i] < 0.0
        what = met(tests, out_tests, k, previous_tests, 2, changed, h_previous, h_used, info)
        if what != LIMIT:
            return what
        if loop_z.size > 0 and passes_start(z, out_z[k], loop_z, loop_tangent, seen, periods, scale, h_used):
            return LOOP
        if kind == HOPF and z[size - 2] < 0.0 and is_aligned(z, n, scale):
            return LIMIT  # the next chunk begins with another v
        for j in range(size):
            if growing[j] > 0.0 and abs(z[j]) > RESCALE_AT * scale[j]:
                return RESCALE
    return LIMIT
